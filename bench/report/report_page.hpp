// A run as one HTML page that needs nothing else: no network, no server, opened from its file.
//
// The page lies in bench/report (HTML, CSS, JavaScript) and is built into the program; here its
// data is gathered and put in as one block of JSON. Every frame is recorded, so frame times hold
// what recording costs (bench/benchmarks/trace_benchmark.cpp measures it).
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "bench/report/budget.hpp"
#include "bench/report/json_text.hpp"
#include "bench/report/run_comparison.hpp"
#include "bench/report/run_report.hpp"
#include "bench/report/timeline.hpp"

namespace pelt {

// Two runs side by side as one HTML page: their frames to one scale, and what `pelt compare` finds.

// `found`: CompareRuns() of the two.
std::string ComparisonPage(const ComparedSide& a, const ComparedSide& b, const ReportTree& found);

// Gathers what the page shows of each frame.
class ReportRecorder {
 public:
  explicit ReportRecorder(const FurScene& scene);

  void Add(const FinishedFrame& frame);
  // `add_consoles` adds an element for each console that the scene was modelled on: see
  // AddConsoleFrame (bench/consoles/console_report.hpp); `add_accuracy` one of AddAccuracySection,
  // if any.
  std::string Page(const RunReport& report, double ns_per_tick,
                   const std::function<void(JsonText&)>& add_consoles = {},
                   const std::function<void(JsonText&)>& add_accuracy = {}) const;

 private:
  // Sums of a frame, [stage] or [pass].
  struct Row {
    uint64_t frame_ticks, caller_ticks;
    std::vector<uint64_t> stage_ticks, pass_ticks;
    std::vector<uint32_t> ran;
    CoreWait wait;
  };
  // Whole frames cost too much memory to keep them all: these are spread evenly over the run.
  static constexpr size_t kKeptFrames = 64;

  const FurScene& scene_;
  std::vector<Row> rows_;
  LayerCosts costs_;
  std::vector<FrameRecord> kept_;  // every stride_-th frame
  uint32_t stride_ = 1;
  std::optional<FrameRecord> worst_;

  friend class PageData;
};

}  // namespace pelt
