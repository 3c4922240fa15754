// The ways to run a scene as an SVG file: error against the time of the whole frame and of the
// simulation alone, a panel each; a named point a way.
//
// Filled points share the reference's material; hollow ones (PBD, Verlet) do not. A line joins the
// points that nothing as cheap is more exact than.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "bench/accuracy/report/accuracy_scene.hpp"
#include "bench/accuracy/report/log_plot.hpp"

namespace pelt {

using namespace accuracy;

namespace {

constexpr double kPanelWidth = 560, kGap = 16, kLeft = 62, kTop = 62, kRight = 24, kBottom = 52;
constexpr double kWidth = kLeft + 2 * kPanelWidth + kGap + kRight, kHeight = 640;
constexpr double kLetter = 6.0, kLine = 12.0;  // of labels, px

struct Box {
  double x, y, width, height;
  bool Meets(const Box& o) const {
    return x < o.x + o.width && o.x < x + width && y < o.y + o.height && o.y < y + height;
  }
};

std::string_view ColourOf(const SceneWay& way) {
  if (!way.simulate) return "#666666";
  if (way.strand_share < 1.0) return "#33994a";
  if (way.sleep) return "#3f66cf";
  if (way.solver == Solver::kPbd) return "#e8604a";
  if (way.solver == Solver::kVerlet) return "#c08000";
  return "#7a1fd0";
}

class SceneDiagram {
 public:
  explicit SceneDiagram(const ScenePrecision& table) : table_(table) {}

  std::string Text() {
    const ScenePrecisionOptions& o = table_.options;
    text_ = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" "
        "viewBox=\"0 0 {0:.0f} {1:.0f}\" font-family=\"sans-serif\" font-size=\"11\">\n"
        "<title>Every way to run scene {2}, from cheapest to most exact</title>\n"
        "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n"
        "<text x=\"{3}\" y=\"24\" font-size=\"15\" font-weight=\"600\">Every way to run scene "
        "{2}, from cheapest to most exact{4}{5}</text>\n"
        "<text x=\"{3}\" y=\"44\" fill=\"#555\">Line: nothing as cheap is more exact. Hollow: "
        "another material, as far off as it is different. Sleeping goes with every way. Dashed: "
        "what the reference is good to.</text>\n",
        kWidth, kHeight, o.scene, kLeft, o.contact ? "" : ", without contacts",
        o.quick ? " (quick: few frames, one round)" : "");
    AddPanel(kLeft, "whole frame", &ScenePrecisionRow::frame_ns);
    AddPanel(kLeft + kPanelWidth + kGap, "simulation", &ScenePrecisionRow::simulate_ns);
    text_ += fmt::format(
        "<text x=\"{:.0f}\" y=\"{:.0f}\" text-anchor=\"middle\" font-size=\"13\">ns per strand and "
        "frame, one core, {} (logarithmic)</text>\n"
        "<text transform=\"translate(14 {:.0f}) rotate(-90)\" text-anchor=\"middle\" "
        "font-size=\"13\">wrong part of the secondary motion, % (logarithmic)</text>\n</svg>\n",
        kWidth / 2, kHeight - 10, IsaName(o.isa), kHeight / 2);
    return std::move(text_);
  }

 private:
  // Both panels have the same errors; each has its times.
  LogPlot PlotOf(double left, SceneTime time) const {
    double least_ns = 1e9, most_ns = 1.0, least = 1.0, most = 1.0;
    const auto widen = [&](double error) {
      if (error > 0.0) least = std::min(least, error);
      if (std::isfinite(error)) most = std::max(most, error);
    };
    for (const ScenePrecisionRow& row : table_.rows) {
      least_ns = std::min(least_ns, row.*time);
      most_ns = std::max(most_ns, row.*time);
      widen(row.error);
    }
    widen(table_.self_error);
    return {left,           kTop,          kPanelWidth,  kHeight - kTop - kBottom,
            0.8 * least_ns, 1.3 * most_ns, 70.0 * least, 150.0 * most};
  }

  void AddPanel(double left, std::string_view title, SceneTime time) {
    plot_ = PlotOf(left, time);
    taken_ = {{left, kTop, kPanelWidth, 20.0}};
    plot_.AddTicks(left <= kLeft, text_);
    plot_.AddFrame(text_);
    text_ += fmt::format(
        "<text x=\"{:.1f}\" y=\"{:.1f}\" font-weight=\"600\">{}</text>\n"
        "<path d=\"M{:.1f} {:.1f}h{:.1f}\" stroke=\"#222\" stroke-dasharray=\"4 3\"/>\n",
        left + 6, kTop + 14, title, plot_.x0, plot_.Y(table_.self_error), plot_.width);
    AddFront(time);
    AddPoints(time);
  }

  // A staircase from the cheapest to the most exact.
  void AddFront(SceneTime time) {
    std::vector<const ScenePrecisionRow*> front;
    for (const ScenePrecisionRow& row : table_.rows)
      if (table_.IsParetoOptimal(row, time)) front.push_back(&row);
    std::sort(front.begin(), front.end(),
              [&](const auto* a, const auto* b) { return a->*time < b->*time; });
    std::string line;
    for (const ScenePrecisionRow* row : front)
      line += line.empty()
                  ? fmt::format("M{:.1f} {:.1f}", plot_.X(row->*time), plot_.Y(row->error))
                  : fmt::format("H{:.1f}V{:.1f}", plot_.X(row->*time), plot_.Y(row->error));
    text_ += fmt::format(
        "<path d=\"{}\" fill=\"none\" stroke=\"#222\" stroke-opacity=\"0.35\" "
        "stroke-width=\"2\"/>\n",
        line);
  }

  void AddPoints(SceneTime time) {
    for (const ScenePrecisionRow& row : table_.rows)
      taken_.push_back({plot_.X(row.*time) - 5, plot_.Y(row.error) - 5, 10, 10});
    for (const ScenePrecisionRow& row : table_.rows) {
      const double x = plot_.X(row.*time), y = plot_.Y(row.error);
      const std::string_view colour = ColourOf(row.way);
      text_ += fmt::format(
          "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4.5\" fill=\"{}\" stroke=\"{}\" "
          "stroke-width=\"1.5\"><title>{}: {:.1f} ns, {:.3g} %</title></circle>\n",
          x, y, row.way.OnReferenceMaterial() ? colour : "#fff", colour, row.way.label, row.*time,
          100.0 * row.error);
      AddLabel(row.way.label, table_.IsParetoOptimal(row, time), x, y);
    }
  }

  // Where there is room: beside the point, else further away with a line to it.
  void AddLabel(const std::string& label, bool pareto_optimal, double x, double y) {
    const double width = (pareto_optimal ? 1.1 : 1.0) * kLetter * double(label.size());
    Box best{};
    bool found = false;
    for (const double away : {0.0, 13.0, 26.0, 39.0, 52.0, 65.0})
      for (const double side : {1.0, -1.0})
        for (const double up : {-1.0, 1.0}) {
          const Box box{side > 0 ? x + 8 : x - 8 - width, y - kLine / 2 + up * away, width, kLine};
          const bool inside = box.x >= plot_.x0 && box.x + width <= plot_.x0 + plot_.width &&
                              box.y >= plot_.y0 && box.y + kLine <= plot_.y0 + plot_.height;
          const bool free = std::none_of(taken_.begin(), taken_.end(),
                                         [&](const Box& other) { return other.Meets(box); });
          if (found || !inside || !free) continue;
          best = box;
          found = true;
        }
    if (!found) return;  // its title still names it
    taken_.push_back(best);
    const double text_y = best.y + kLine - 3;
    if (std::abs(best.y + kLine / 2 - y) > 1.0)
      text_ += fmt::format(
          "<path d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\" stroke=\"#9aa5b3\" stroke-width=\"0.8\"/>\n", x,
          y, best.x > x ? best.x : best.x + width, best.y + kLine / 2);
    text_ += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\"{}{}>{}</text>\n",
                         best.x > x ? best.x : best.x + width, text_y,
                         best.x > x ? "" : " text-anchor=\"end\"",
                         pareto_optimal ? " font-weight=\"600\"" : "", label);
  }

  const ScenePrecision& table_;
  LogPlot plot_{};
  std::vector<Box> taken_;  // by points and labels
  std::string text_;
};

}  // namespace

std::string SceneSvg(const ScenePrecision& table) { return SceneDiagram(table).Text(); }

}  // namespace pelt
