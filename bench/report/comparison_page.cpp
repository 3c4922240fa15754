#include "bench/report/comparison_page.hpp"

#include <nlohmann/json.hpp>

#include "bench/report/embedded_page.hpp"

namespace pelt {
std::string ComparisonPage(const ComparedSide& a, const ComparedSide& b, const ReportTree& found) {
  nlohmann::ordered_json data;
  data["comparison"] = nlohmann::ordered_json::parse(found.Json());
  for (const auto& [key, side] : {std::pair("a", &a), std::pair("b", &b)}) {
    auto& frames = data["frame_ms"][key] = nlohmann::ordered_json::array();
    for (const MeasuredRun& run : side->rounds)
      for (const double ms : run.frame_ms) frames.push_back(ms);
  }
  return FillPage(EmbeddedPair(), data.dump());
}

}  // namespace pelt
