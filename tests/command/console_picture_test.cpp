// A modelled frame as the page draws it and as a trace shows it: no gaps, no overlaps, the model's
// own sums.
#include <gtest/gtest.h>

#include <map>
#include <numeric>
#include <set>

#include "bench/consoles/console_report.hpp"
#include "bench/report/embedded_page.hpp"
#include "bench/report/timeline.hpp"
#include "tests/command/modelled_console.hpp"
#include "tests/traces/trace_checker.hpp"
#include "traces/chrome_trace.hpp"

namespace pelt::testing {
namespace {

// As the page reads it: no gaps in what a unit does, transfers inside the frame, sums as modelled.
TEST_P(ConsoleOf, ThePagesFrameHasNoGaps) {
  const ConsoleBudget& b = on().budget;
  const auto json = JsonOf([&](JsonText& text) { AddConsoleFrame(text, b, on().scene()); });
  ASSERT_TRUE(json.is_object());
  EXPECT_EQ(json["frame"], b.summary.worst_frame);
  EXPECT_NEAR(double(json["ns"]) * 1e-6, b.summary.worst_ms, 1e-6);
  ASSERT_EQ(json["units"].size(), b.machine.units);
  ASSERT_EQ(json["plan"].size() * 2, json["passes"].size());
  const std::string_view script = EmbeddedReport().script;
  for (const auto& work : json["works"]) {  // each has a colour: `get: 'x'` or `'get stall': 'x'`
    const std::string name = work;
    const bool quoted = name.find(' ') != name.npos;
    EXPECT_NE(script.find(quoted ? "'" + name + "': '" : " " + name + ": '"), script.npos) << name;
  }
  double compute_ns = 0.0;
  uint32_t transfers = 0;
  for (const auto& unit : json["units"]) {
    const auto& slices = unit["slices"];
    ASSERT_EQ(slices.size() % 5, 0u);
    int64_t at = 0;
    for (size_t i = 0; i < slices.size(); i += 5) {
      ASSERT_LT(size_t(slices[i]), json["works"].size());
      ASSERT_LT(int64_t(slices[i + 1]), int64_t(json["plan"].size()));
      EXPECT_EQ(slices[i + 3], at) << unit["name"] << " " << i / 5;
      at = slices[i + 4];
      if (size_t(slices[i]) == size_t(UnitWork::kCompute))
        compute_ns += double(at) - double(slices[i + 3]);
    }
    EXPECT_EQ(at, json["ns"]);
    const auto& moved = unit["transfers"];
    ASSERT_EQ(moved.size() % 5, 0u);
    for (size_t i = 0; i < moved.size(); i += 5, ++transfers) {
      EXPECT_GE(int64_t(moved[i + 3]), 0);
      EXPECT_LE(int64_t(moved[i + 3]), int64_t(moved[i + 4]));
      EXPECT_LE(int64_t(moved[i + 4]), int64_t(json["ns"]));
    }
  }
  EXPECT_GT(transfers, 10u);
  const double cycles = double(
      std::accumulate(b.slowest.stage_cycles.begin(), b.slowest.stage_cycles.end(), Cycles{0}));
  EXPECT_NEAR(compute_ns * 1e-6, b.machine.Milliseconds(cycles), 1e-3);
}

// What Timeline asks for; empty when a track keeps to it.
std::string FaultOf(const Timeline& timeline, const Timeline::Track& track) {
  std::vector<Timeline::Slice> open;       // the parents of the slice before, and it
  std::map<uint32_t, uint64_t> depth_end;  // of the last on each depth
  for (const Timeline::Slice& slice : track.slices) {
    const std::string& name = timeline.names.at(slice.name);
    if (slice.begin_ns > slice.end_ns) return name + " runs backwards";
    if (slice.depth > open.size()) return name + " has no parent";
    open.resize(slice.depth);
    if (!open.empty() &&
        (slice.begin_ns < open.back().begin_ns || slice.end_ns > open.back().end_ns))
      return name + " leaks out of " + timeline.names.at(open.back().name);
    if (slice.begin_ns < depth_end[slice.depth]) return name + " overlaps the one before";
    depth_end[slice.depth] = slice.end_ns;
    open.push_back(slice);
  }
  return {};
}

TEST(ConsoleTimeline, BothStandSideBySideInOneTrace) {
  Timeline timeline;
  for (const Console console : kAllConsoles)
    AddConsoleTracks(On(console).scene(), On(console).budget.machine, On(console).budget.slowest,
                     timeline);
  std::map<int, std::string> threads;
  for (const Console console : kAllConsoles) {
    const ConsoleMachine& machine = On(console).budget.machine;
    std::vector<std::string> names = {"frame"};
    for (uint32_t u = 0; u < machine.units; ++u)
      for (const char* what : {"", " in", " out"}) names.push_back(UnitName(machine, u) + what);
    for (const std::string& name : names) {
      const int tid = int(threads.size()) + 1;
      threads[tid] = machine.name + " " + name;
    }
  }
  ASSERT_EQ(timeline.tracks.size(), threads.size());
  for (const Timeline::Track& track : timeline.tracks)
    EXPECT_EQ(FaultOf(timeline, track), "") << track.name;
  const CheckedTrace trace = TraceChecker::Check(ChromeTrace(timeline));
  EXPECT_EQ(trace.faults, std::vector<std::string>{});
  EXPECT_EQ(trace.threads, threads);
  std::map<std::string, double> frame_us;
  std::map<int, double> busy_us, passes_us;
  std::set<std::string> passes;  // that a unit is at
  for (const TraceSlice& slice : trace.slices) {
    const std::string& thread = threads[slice.tid];
    if (slice.name == "frame") frame_us[thread] = slice.end_us;
    (slice.parents.empty() ? passes_us : busy_us)[slice.tid] += slice.end_us - slice.begin_us;
    if (slice.parents.empty()) passes.insert(slice.name);
  }
  for (const Console console : kAllConsoles) {
    const ConsoleBudget& b = On(console).budget;
    EXPECT_NEAR(frame_us[b.machine.name + " frame"], b.summary.worst_ms * 1e3, 1e-2);
    const Plan& plan = On(console).plan();
    for (uint32_t p = 0; p < plan.passes.size(); ++p)
      EXPECT_TRUE(passes.contains(PassName(plan, p))) << PassName(plan, p);
  }
  // A unit's own track has no gap: it is as long as its frame. Rounding leaves a few ns.
  for (const auto& [tid, name] : threads)
    if (!name.ends_with(" in") && !name.ends_with(" out") && !name.ends_with("frame")) {
      const double frame = frame_us[name.substr(0, name[0] == 'P' ? 4 : 9) + "frame"];
      EXPECT_NEAR(passes_us[tid], frame, 1.0) << name;
      EXPECT_NEAR(busy_us[tid], frame, 1.0) << name;
    }
}

// Two transfers of a unit that are on their way together are shown one after the other; a unit
// that did two things at once would be a fault of the model, and is seen.
TEST(ConsoleTimeline, OverlapsAreCutForTransfersAndShownForUnits) {
  const ConsoleBudget& b = On(Console::kPs3).budget;
  ModelledFrame frame;
  frame.cycles = 10000;
  frame.passes.resize(1);
  frame.passes[0].end = 10000;
  frame.units.resize(1);
  frame.units[0].transfers = {
      {false, 0, kNoBlock, 300, 900, 1}, {false, 0, 0, 500, 800, 1}, {false, 0, 0, 600, 2000, 1}};
  const auto build = [&] {
    Timeline timeline;
    AddConsoleTracks(On(Console::kPs3).scene(), b.machine, frame, timeline);
    return timeline;
  };
  Timeline timeline = build();
  EXPECT_EQ(timeline.tracks.at(2).slices.size(), 2u);
  EXPECT_EQ(FaultOf(timeline, timeline.tracks[2]), "");
  EXPECT_TRUE(TraceChecker::Check(ChromeTrace(timeline)).faults.empty());
  frame.units[0].slices = {{UnitWork::kCompute, 0, 0, 0, 6000},
                           {UnitWork::kCompute, 0, 0, 4000, 10000}};
  timeline = build();
  EXPECT_NE(FaultOf(timeline, timeline.tracks.at(1)), "");
}

}  // namespace
}  // namespace pelt::testing
