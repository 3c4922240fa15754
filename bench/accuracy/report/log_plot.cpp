#include "bench/accuracy/report/log_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace pelt {
namespace {

constexpr double kPercents[] = {0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0};

}  // namespace

double LogPlot::X(double ns) const {
  const double share = std::log(ns / least_ns) / std::log(most_ns / least_ns);
  return x0 + width * std::clamp(share, 0.0, 1.0);
}

double LogPlot::Y(double error) const {
  const double share =
      std::log(100.0 * error / least_percent) / std::log(most_percent / least_percent);
  return y0 + height * (1.0 - std::clamp(share, 0.0, 1.0));
}

void LogPlot::AddTicks(bool error_texts, std::string& text) const {
  for (double ns = 1.0; ns <= most_ns; ns *= 10.0)
    for (const double factor : {1.0, 2.0, 5.0}) {
      const double at = ns * factor;
      if (at < least_ns || at > most_ns) continue;
      text += fmt::format(
          "<path d=\"M{0:.1f} {1:.1f}v{2}\" stroke=\"#e4e7eb\"/><text x=\"{0:.1f}\" "
          "y=\"{3:.1f}\" text-anchor=\"middle\" fill=\"#555\">{4}</text>\n",
          X(at), y0, height, y0 + height + 11, at);
    }
  for (const double percent : kPercents) {
    if (percent < least_percent || percent > most_percent) continue;
    text += fmt::format("<path d=\"M{:.1f} {:.1f}h{}\" stroke=\"{}\"/>\n", x0, Y(percent / 100.0),
                        width, percent == 1.0 || percent == 100.0 ? "#b8c0ca" : "#e4e7eb");
    if (error_texts)
      text += fmt::format(
          "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\" fill=\"#555\">{}</text>\n", x0 - 4,
          Y(percent / 100.0) + 4, percent);
  }
}

void LogPlot::AddFrame(std::string& text) const {
  text += fmt::format(
      "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{}\" height=\"{}\" fill=\"none\" "
      "stroke=\"#9aa5b3\"/>",
      x0, y0, width, height);
}

}  // namespace pelt
