// The work-precision diagram as an SVG file: small multiples on common axes, so that presets, links
// and rates can be compared by eye.
//
// Methods are told apart by colour and by the shape of their points; a ring is drawn around the
// points that nothing as cheap is more exact than.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bench/accuracy/report/accuracy_report.hpp"
#include "bench/accuracy/report/log_plot.hpp"

namespace pelt {

using namespace accuracy;

namespace {

constexpr double kPanelWidth = 290, kPanelHeight = 240, kLeft = 62, kTop = 92, kGap = 16,
                 kBottom = 52;
constexpr double kLegendWidth = 1000;
// Per cent; points outside stand on the edge.
constexpr double kMostError = 300.0, kLeastError = 0.02;

constexpr std::string_view kColours[kFamilies] = {"#96684a", "#c08000", "#e8604a", "#f07aab",
                                                  "#4f9fb5", "#33994a", "#3f66cf", "#7a1fd0"};
// Around (0, 0), about 8 wide.
constexpr std::string_view kMarks[kFamilies] = {
    "M-4-4H4V4H-4Z",      "M0-5L5 4H-5Z",
    "M0 5L5-4H-5Z",       "M0-5L5 0L0 5L-5 0Z",
    "M-4-1.5H4V1.5H-4Z",  "M-1.5-4H1.5V4H-1.5Z",
    "M-4-4L4 4M4-4L-4 4", "M-4 0A4 4 0 1 0 4 0A4 4 0 1 0-4 0Z"};

class Diagram {
 public:
  explicit Diagram(const WorkPrecision& table) : table_(table) {
    double least = 1e9, most = 1.0;
    for (const WorkPrecisionPanel& panel : table.panels)
      for (const WorkPrecisionRow& row : panel.rows) {
        if (row.ns <= 0.0) continue;
        least = std::min(least, row.ns);
        most = std::max(most, row.ns);
      }
    plot_ = {0.0,         0.0,         kPanelWidth, kPanelHeight, 0.8 * std::min(least, most),
             1.25 * most, kLeastError, kMostError};
  }

  std::string Text() {
    const auto& o = table_.options;
    const size_t rows = o.links.size() * o.rates.size();
    const double width =
        std::max(kLegendWidth, kLeft + double(o.presets.size()) * (kPanelWidth + kGap));
    const double height = kTop + double(rows) * (kPanelHeight + kGap) + kBottom;
    text_ = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" "
        "viewBox=\"0 0 {0:.0f} {1:.0f}\" font-family=\"sans-serif\" font-size=\"11\">\n"
        "<title>Error of the secondary motion against time a strand</title>\n"
        "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n",
        width, height);
    AddLegend();
    for (const WorkPrecisionPanel& panel : table_.panels) {
      const size_t links =
          size_t(std::find(o.links.begin(), o.links.end(), panel.links) - o.links.begin());
      for (size_t r = 0; r < o.rates.size(); ++r) {
        plot_.x0 = kLeft + double(panel.preset) * (kPanelWidth + kGap);
        plot_.y0 = kTop + double(links * o.rates.size() + r) * (kPanelHeight + kGap);
        AddPanel(panel, r);
      }
    }
    text_ += fmt::format(
        "<text x=\"{:.0f}\" y=\"{:.0f}\" text-anchor=\"middle\" font-size=\"13\">ns a strand a "
        "frame, one core, {} (logarithmic)</text>\n"
        "<text transform=\"translate(14 {:.0f}) rotate(-90)\" text-anchor=\"middle\" "
        "font-size=\"13\">wrong part of the secondary motion, % (logarithmic)</text>\n</svg>\n",
        width / 2, height - 10, IsaName(o.isa), height / 2);
    return std::move(text_);
  }

 private:
  void AddLegend() {
    double x = kLeft, y = 24;
    text_ += fmt::format(
        "<text x=\"{}\" y=\"{}\" font-size=\"15\" font-weight=\"600\">Error "
        "against run time{}{}</text>\n",
        kLeft, y,
        table_.options.coefficients == Coefficients::kCalibrated ? ", calibrated strands" : "",
        table_.options.quick ? " (quick: few cases and rounds)" : "");
    y = 50;
    for (size_t f = 0; f < kFamilies; ++f) {
      text_ += fmt::format(
          "<path transform=\"translate({} {})\" d=\"{}\" fill=\"{}\" stroke=\"{}\"/>"
          "<text x=\"{}\" y=\"{}\">{}</text>\n",
          x + 5, y, kMarks[f], kColours[f], kColours[f], x + 15, y + 4, FamilyName(Family(f)));
      x += 40 + 6.2 * double(FamilyName(Family(f)).size());
    }
    text_ += fmt::format(
        "<text x=\"{}\" y=\"{}\" fill=\"#555\">A point a number of substeps or iterations, or a "
        "quality. Ringed: nothing as cheap is more exact. Dashed: exact solver, root known at "
        "frame "
        "times only.</text>\n",
        kLeft, 74);
  }

  void AddPanel(const WorkPrecisionPanel& panel, size_t rate) {
    plot_.AddTicks(plot_.x0 <= kLeft, text_);
    plot_.AddFrame(text_);
    text_ += fmt::format(
        "<text x=\"{:.1f}\" y=\"{:.1f}\" font-weight=\"600\">{}, {} links, {} Hz</text>\n",
        plot_.x0 + 6, plot_.y0 + 14, table_.options.presets[panel.preset].name, panel.links,
        table_.options.rates[rate]);
    text_ +=
        fmt::format("<path d=\"M{:.1f} {:.1f}h{}\" stroke=\"#222\" stroke-dasharray=\"4 3\"/>\n",
                    plot_.x0, plot_.Y(panel.input_errors[rate]), kPanelWidth);
    for (size_t f = 0; f < kFamilies; ++f) AddCurve(panel, rate, Family(f));
  }

  void AddCurve(const WorkPrecisionPanel& panel, size_t rate, Family family) {
    std::string line, marks;
    for (const WorkPrecisionRow& row : panel.rows) {
      if (row.solver.family != family || row.ns <= 0.0 || !row.Finite(rate)) continue;
      const double x = plot_.X(row.ns), y = plot_.Y(row.scores[rate].error);
      line += fmt::format("{}{:.1f} {:.1f}", line.empty() ? 'M' : 'L', x, y);
      marks += fmt::format(
          "<path transform=\"translate({:.1f} {:.1f})\" d=\"{}\"><title>{}: {:.1f} "
          "ns, {:.3g} %</title></path>",
          x, y, kMarks[size_t(family)], row.solver.label, row.ns, 100.0 * row.scores[rate].error);
      if (panel.OnFront(row, rate))
        marks += fmt::format(
            "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"7\" fill=\"none\" "
            "stroke-opacity=\"0.6\"/>",
            x, y);
    }
    if (line.empty()) return;
    const std::string_view colour = kColours[size_t(family)];
    text_ += fmt::format(
        "<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\"/>"
        "<g fill=\"{}\" stroke=\"{}\">{}</g>\n",
        line, colour, family == Family::kModal ? 2.5 : 1.2, colour, colour, marks);
  }

  const WorkPrecision& table_;
  LogPlot plot_;
  std::string text_;
};

}  // namespace

std::string WorkPrecisionSvg(const WorkPrecision& table) { return Diagram(table).Text(); }

}  // namespace pelt
