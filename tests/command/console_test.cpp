// A scene's budget on the consoles: its bits, its sums, its pictures, and advice that holds.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <sstream>

#include "bench/console_advice.hpp"
#include "bench/console_budget.hpp"
#include "bench/console_report.hpp"
#include "bench/console_timeline.hpp"
#include "bench/report_page.hpp"
#include "bench/run_report.hpp"
#include "bench/timeline.hpp"
#include "tests/traces/trace_checker.hpp"
#include "traces/chrome_trace.hpp"

namespace pelt {
namespace {

using namespace testing;

constexpr uint32_t kFrames = 40;

struct Modelled {
  Scenario scenario = LoadScenario("tiny");
  ConsoleRun run;
  ConsoleBudget budget;

  explicit Modelled(const ConsoleRequest& request) : run(scenario, request), budget(run.Run()) {}
  const FurScene& scene() const { return run.scene(); }
  const Plan& plan() const { return run.scene().plan(); }
};

// Of kFrames; made once.
Modelled& On(Console console) {
  static std::map<Console, std::unique_ptr<Modelled>> made;
  std::unique_ptr<Modelled>& on = made[console];
  if (!on) on = std::make_unique<Modelled>(ConsoleRequest{.console = console, .frames = kFrames});
  return *on;
}

double SumOf(const auto& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

template <class Add>
nlohmann::json Json(Add add) {
  JsonText json;
  add(json);
  return nlohmann::json::parse(json.text(), nullptr, false);
}

nlohmann::json AsJson(const ConsoleBudget& budget, const FurScene& scene) {
  return Json([&](JsonText& text) {
    text.BeginObject();
    AddConsole(text, budget, scene);
    text.EndObject();
  });
}

class ConsoleOf : public ::testing::TestWithParam<Console> {
 protected:
  Modelled& on() { return On(GetParam()); }
};
INSTANTIATE_TEST_SUITE_P(Consoles, ConsoleOf, ::testing::ValuesIn(kAllConsoles),
                         [](const auto& info) { return std::string(ConsoleName(info.param)); });

// ---- Bits
// ------------------------------------------------------------------------------------------

TEST_P(ConsoleOf, GivesTheBitsOfAnOrdinaryRun) {
  const ConsoleBudget& b = on().budget;
  EXPECT_EQ(b.digests_compared, 5u);  // every tenth, and the last
  EXPECT_FALSE(b.differs_at);
  EXPECT_EQ(b.faults, std::vector<std::string>{});
  RunOptions options;
  options.scene.isa = Isa::kReference;
  RunningScenario running(on().scenario, options.scene);
  options.executor = ExecutorKind::kSerial;
  options.frames = kFrames;
  RunFrames(on().scenario, running, options);
  EXPECT_EQ(b.digest, running.scene().DigestFrame());
  EXPECT_NE(DescribeConsole(b, on().scene()).find("digests equal the host's in 5 of 5"),
            std::string::npos);
}

// One bit of one strand, changed on the console only, before frame 5.
TEST_P(ConsoleOf, SaysWhenItsBitsAreNotTheHosts) {
  Scenario tiny = LoadScenario("tiny");
  ConsoleRun* run = nullptr;
  ConsoleRequest request{.console = GetParam(), .frames = kFrames};
  request.progress = [&](uint32_t frame, uint32_t) {
    if (frame != 5) return;
    const SceneShape& shape = run->scene().shape();
    uint32_t chunk = 0;
    while (!(shape.layer_kind[shape.chunk_layer[chunk]] & kLayerFivePoints)) ++chunk;
    const StreamDesc& points = DescribeStream(Stream::kStrandPoints5);
    std::byte* block = run->scene().memory().Block(Stream::kStrandPoints5, chunk);
    block[points.rows[0].offset_bytes + 2] ^= std::byte{1};
  };
  ConsoleRun console(tiny, request);
  run = &console;
  const ConsoleBudget b = console.Run();
  ASSERT_TRUE(b.differs_at);
  EXPECT_EQ(*b.differs_at, 10u);  // the next that is compared
  EXPECT_NE(DescribeConsole(b, console.scene()).find("DIGEST: frame 10 is not the host's"),
            std::string::npos);
  const auto json = AsJson(b, console.scene());
  EXPECT_EQ(json["digests_equal"], false);
}

// ---- Sums
// ------------------------------------------------------------------------------------------

TEST_P(ConsoleOf, PassesAddUpToTheFrameAndWorkToThePass) {
  const FrameSummary& s = on().budget.summary;
  double passes_ms = 0.0;
  for (const FrameSummary::Pass& pass : s.passes) {
    passes_ms += pass.ms;
    EXPECT_NEAR(SumOf(pass.unit_ms), pass.ms, 1e-9);
    EXPECT_NEAR(SumOf(pass.critical_ms), pass.ms, 1e-9);
  }
  EXPECT_GT(passes_ms, 0.0);
  EXPECT_LE(passes_ms, s.worst_ms);
  EXPECT_NEAR(SumOf(s.critical_ms), passes_ms, 1e-9);
  EXPECT_NEAR(SumOf(s.unit_ms), passes_ms, 1e-9);
  Cycles path = 0;
  for (const ModelledPass& pass : s.worst_passes)
    path = std::accumulate(pass.last_unit_cycles.begin(), pass.last_unit_cycles.end(), path);
  EXPECT_EQ(path, on().budget.slowest.cycles);
  EXPECT_EQ(on().budget.machine.Milliseconds(double(path)), s.worst_ms);
}

// The table as it is read: every row adds up, and the rows to the last one, to what is printed.
TEST_P(ConsoleOf, ThePrintedPassTableAddsUp) {
  constexpr size_t kNameColumns = 40;
  std::istringstream text(DescribeConsole(on().budget, on().scene()));
  std::vector<double> sums(2 + kUnitWorkCount, 0.0);
  uint32_t rows = 0;
  bool has_total = false;
  for (std::string line; std::getline(text, line);) {
    const bool is_total = line.starts_with("all: the critical path");
    if (!is_total && !line.starts_with("pass ")) continue;
    if (has_total) continue;  // those of the local stores
    std::istringstream cells(line.substr(kNameColumns));
    std::vector<double> values(2 + kUnitWorkCount);
    for (double& value : values) ASSERT_TRUE(cells >> value) << line;
    const double parts = std::accumulate(values.begin() + 2, values.end(), 0.0);
    EXPECT_NEAR(parts, values[1], 0.0005 * (kUnitWorkCount + 1)) << line;
    if (is_total) {
      has_total = true;
      for (size_t i = 1; i < values.size(); ++i)
        EXPECT_NEAR(sums[i], values[i], 0.0005 * (rows + 1)) << i;
      EXPECT_NEAR(sums[0], values[0], 0.05 * (rows + 1));
      continue;
    }
    ++rows;
    for (size_t i = 0; i < values.size(); ++i) sums[i] += values[i];
  }
  EXPECT_EQ(rows, on().plan().passes.size());
  EXPECT_TRUE(has_total);
}

TEST_P(ConsoleOf, JsonHasTheFiguresOfTheSummary) {
  const ConsoleBudget& b = on().budget;
  const FrameSummary& s = b.summary;
  const auto json = AsJson(b, on().scene());
  ASSERT_TRUE(json.is_object());
  EXPECT_EQ(json["machine"], b.machine.name);
  EXPECT_EQ(json["units"], b.machine.units);
  EXPECT_EQ(json["frame_ms"]["median"], s.median_ms);
  EXPECT_EQ(json["frame_ms"]["p95"], s.p95_ms);
  EXPECT_EQ(json["frame_ms"]["worst"], s.worst_ms);
  EXPECT_EQ(json["digest"], fmt::format("{:016x}", b.digest));
  EXPECT_EQ(json["digests_equal"], true);
  ASSERT_EQ(json["passes"].size(), s.passes.size());
  double path_ms = 0.0;
  for (size_t p = 0; p < s.passes.size(); ++p) {
    const auto& pass = json["passes"][p];
    EXPECT_EQ(pass["ms"], s.passes[p].ms);
    EXPECT_EQ(pass["name"], PassName(on().plan(), uint32_t(p)));
    EXPECT_EQ(pass["bound_by"], PassLimitName(s.passes[p].binds));
    for (const auto& ms : pass["critical_ms"]) path_ms += double(ms);
    EXPECT_EQ(pass.contains("local_store_bytes"), b.machine.local_store_bytes > 0);
  }
  double critical_ms = 0.0;
  for (const auto& ms : json["critical_path_ms"]) critical_ms += double(ms);
  EXPECT_NEAR(critical_ms, path_ms, 1e-9);
  double share = 0.0, core_ms = 0.0;
  for (const auto& stage : json["stages"]) {
    share += double(stage["share"]);
    core_ms += double(stage["core_ms"]);
  }
  EXPECT_NEAR(share, 1.0, 1e-9);
  EXPECT_NEAR(core_ms, double(json["unit_ms"]["compute"]) * b.machine.units, 1e-3 * core_ms);
  double in = 0.0, out = 0.0;
  for (const auto& stream : json["main_memory_bytes"]) {
    in += double(stream["in"]);
    out += double(stream["out"]);
  }
  EXPECT_NEAR(in, SumOf(s.stream_get_bytes), 1e-3);
  EXPECT_NEAR(out, SumOf(s.stream_put_bytes), 1e-3);
}

// ---- Pictures
// --------------------------------------------------------------------------------------

// As the page reads it: no gaps in what a unit does, transfers inside the frame, sums as modelled.
TEST_P(ConsoleOf, ThePagesFrameHasNoGaps) {
  const ConsoleBudget& b = on().budget;
  const auto json = Json([&](JsonText& text) { AddConsoleFrame(text, b, on().scene()); });
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

// What timeline.hpp asks for; empty when a track keeps to it.
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
  uint32_t passes = 0;
  std::map<std::string, double> frame_us;
  std::map<int, double> busy_us;
  for (const TraceSlice& slice : trace.slices) {
    const std::string& thread = threads[slice.tid];
    if (slice.name == "frame") frame_us[thread] = slice.end_us;
    passes += thread.ends_with("frame") && slice.parents == std::vector<std::string>{"frame"};
    busy_us[slice.tid] += slice.end_us - slice.begin_us;
  }
  for (const Console console : kAllConsoles) {
    const ConsoleBudget& b = On(console).budget;
    EXPECT_NEAR(frame_us[b.machine.name + " frame"], b.summary.worst_ms * 1e3, 1e-2);
    passes -= uint32_t(On(console).plan().passes.size());
  }
  EXPECT_EQ(passes, 0u);
  // A unit's own track has no gap: it is as long as its frame. Rounding leaves a few ns.
  for (const auto& [tid, name] : threads)
    if (!name.ends_with(" in") && !name.ends_with(" out") && !name.ends_with("frame")) {
      EXPECT_NEAR(busy_us[tid], frame_us[name.substr(0, name[0] == 'P' ? 4 : 9) + "frame"], 1.0)
          << name;
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

// ---- Advice, and what the options change
// -----------------------------------------------------------

std::string Joined(const std::vector<std::string>& lines) {
  return fmt::format("{}", fmt::join(lines, "\n"));
}

TEST_P(ConsoleOf, NoAdviceForWhatFits) { EXPECT_TRUE(Advise(on().run, on().budget, 8.0).empty()); }

// The budget that the advice names is set, and the scene fits.
TEST_P(ConsoleOf, AStrandBudgetThatIsAdvisedFits) {
  Modelled& on = this->on();
  const double least_ms = on.run.TryLod({.strand_budget = 16}, ConsoleRun::Trial::kAllFrames).ms;
  const double most_ms = on.run.TryLod({}, ConsoleRun::Trial::kAllFrames).ms;
  ASSERT_LT(least_ms, most_ms);
  const double target_ms = (least_ms + most_ms) / 2;
  ASSERT_FALSE(on.budget.Fits(target_ms));
  const std::string advice = Joined(Advise(on.run, on.budget, target_ms));
  const std::string mark = "--strand-budget ";
  ASSERT_NE(advice.find(mark), advice.npos) << advice;
  const auto strands = uint32_t(std::stoul(advice.substr(advice.find(mark) + mark.size())));
  EXPECT_GT(strands, 0u);
  EXPECT_LT(strands, on.budget.strands);
  ConsoleRequest request{.console = GetParam(), .frames = kFrames};
  request.skip.lod = true;
  request.lod.strand_budget = strands;
  const Modelled again(request);
  EXPECT_TRUE(again.budget.Fits(target_ms))
      << strands << " strands: " << again.budget.summary.p95_ms << " ms, not " << target_ms << "\n"
      << advice;
  EXPECT_NE(advice.find("what binds: "), advice.npos) << advice;
}

TEST_P(ConsoleOf, SaysWhenFewerStrandsDoNotHelp) {
  const std::string advice = Joined(Advise(on().run, on().budget, 0.001));
  EXPECT_EQ(advice.find("--strand-budget"), advice.npos) << advice;
  EXPECT_NE(advice.find("does not depend on strands"), advice.npos) << advice;
}

TEST_P(ConsoleOf, FewerStrandsTakeLess) {
  const auto all = on().run.TryLod({.strand_budget = 1000}, ConsoleRun::Trial::kFewFrames);
  const auto less = on().run.TryLod({.strand_budget = 200}, ConsoleRun::Trial::kFewFrames);
  EXPECT_LT(less.live_strands, all.live_strands);
  EXPECT_LT(less.ms, all.ms);
}

double MedianMs(Scenario& scenario, const ConsoleRequest& request) {
  return ConsoleRun(scenario, request).Run().summary.median_ms;
}

// Not on tiny: four SPUs bring less code than six, and there that is most of the bytes.
TEST(ConsoleBudget, FewerSpusAndABusyGpuTakeLonger) {
  Scenario eyepet = LoadScenario("eyepet");
  ConsoleRequest ps3{.console = Console::kPs3, .frames = 3};
  const double six_ms = MedianMs(eyepet, ps3);
  ps3.numbers.cell.spu_count = 4;
  EXPECT_GT(MedianMs(eyepet, ps3), six_ms);
  ConsoleRequest xbox{.console = Console::kXbox360, .frames = 3};
  const double idle_ms = MedianMs(eyepet, xbox);
  xbox.numbers.xenon.gpu_permille = 900;
  EXPECT_GT(MedianMs(eyepet, xbox), idle_ms);
}

}  // namespace
}  // namespace pelt
