// A panel with two logarithmic axes in an SVG picture: where values stand, ticks, frame. Per cent
// upwards, nanoseconds to the right.
#pragma once

#include <string>

namespace pelt {

struct LogPlot {
  double x0, y0, width, height;  // px
  double least_ns, most_ns;
  double least_percent, most_percent;  // values outside stand on the edge

  double X(double ns) const;
  double Y(double error) const;  // 0.01: 1 %
  // Ticks with their texts; those of the error at the left only if asked for.
  void AddTicks(bool error_texts, std::string& text) const;
  void AddFrame(std::string& text) const;
};

}  // namespace pelt
