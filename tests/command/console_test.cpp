// A scene's budget on the consoles: its bits, its sums, and advice that holds.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <numeric>
#include <sstream>

#include "bench/consoles/console_budget.hpp"
#include "bench/consoles/console_report.hpp"
#include "bench/report/run_report.hpp"
#include "tests/command/modelled_console.hpp"

namespace pelt::testing {
namespace {

double SumOf(const auto& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

nlohmann::json AsJson(const ConsoleBudget& budget, const FurScene& scene) {
  ReportTree tree;
  AddConsole(budget, scene, tree);
  return nlohmann::json::parse(tree.Json());
}

INSTANTIATE_TEST_SUITE_P(Consoles, ConsoleOf, ::testing::ValuesIn(kAllConsoles),
                         [](const auto& info) { return std::string(ConsoleName(info.param)); });

// ---- Bits ---------------------------------------------------------------------------------------

TEST_P(ConsoleOf, GivesTheBitsOfAnOrdinaryRun) {
  const ConsoleBudget& b = on().budget;
  EXPECT_EQ(b.digests_compared, 5u);  // every tenth, and the last
  EXPECT_FALSE(b.differs_at);
  EXPECT_EQ(b.faults, std::vector<std::string>{});
  RunOptions options;
  options.scene.isa = Isa::kReference;
  RunningScenario running(on().scenario, options.scene);
  options.executor = "serial";
  options.frames = kModelledFrames;
  RunFrames(on().scenario, running, options);
  EXPECT_EQ(b.digest, running.scene().DigestFrame());
  EXPECT_NE(ProseOf(b, on().scene()).find("digests equal the host's in 5 of 5"), std::string::npos);
}

// One bit of one strand, changed on the console only, before frame 5.
TEST_P(ConsoleOf, SaysWhenItsBitsAreNotTheHosts) {
  Scenario tiny = LoadScenario("tiny");
  ConsoleRun* run = nullptr;
  ConsoleRequest request{.console = GetParam(), .frames = kModelledFrames};
  request.progress = [&](uint32_t frame, uint32_t) {
    if (frame != 5) return;
    const SceneShape& shape = run->scene().shape();
    uint32_t chunk = 0;
    while (!(shape.layer_kind[shape.chunk_layer[chunk]] & kLayerFivePoints)) ++chunk;
    const StreamDesc& points = DescribeStream(StreamOf<&Streams::strand_points5>);
    std::byte* block = run->scene().memory().Block(StreamOf<&Streams::strand_points5>, chunk);
    block[points.rows[0].offset_bytes + 2] ^= std::byte{1};
  };
  ConsoleRun console(tiny, request);
  run = &console;
  const ConsoleBudget b = console.Run();
  ASSERT_TRUE(b.differs_at);
  EXPECT_EQ(*b.differs_at, 10u);  // the next that is compared
  EXPECT_NE(ProseOf(b, console.scene()).find("DIGEST: frame 10 is not the host's"),
            std::string::npos);
  const auto json = AsJson(b, console.scene());
  EXPECT_EQ(json["digests_equal"], false);
}

// ---- Sums ---------------------------------------------------------------------------------------

TEST_P(ConsoleOf, PassesAddUpToTheFrameAndSoDoesTheCriticalPath) {
  const FrameSummary& s = on().budget.summary;
  double passes_ms = 0.0;
  for (const FrameSummary::Pass& pass : s.passes) {
    passes_ms += pass.ms;
    EXPECT_NEAR(SumOf(pass.unit_ms), pass.ms, 1e-9);
  }
  EXPECT_GT(passes_ms, 0.0);
  EXPECT_LE(passes_ms, s.worst_ms);
  EXPECT_NEAR(SumOf(s.critical_ms), passes_ms, 1e-9);
  EXPECT_NEAR(SumOf(s.unit_ms), passes_ms, 1e-9);
  Cycles path = 0;
  for (const ModelledPass& pass : on().budget.slowest.passes)
    path = std::accumulate(pass.critical_cycles.begin(), pass.critical_cycles.end(), path);
  EXPECT_EQ(path, on().budget.slowest.cycles);
  EXPECT_EQ(on().budget.machine.Milliseconds(double(path)), s.worst_ms);
}

// The table as it is read: every row adds up, and the rows to the last one, to what is printed.
TEST_P(ConsoleOf, ThePrintedPassTableAddsUp) {
  constexpr size_t kNameColumns = 4;
  std::istringstream text(TextOf(on().budget, on().scene()));
  std::vector<double> sums(2 + kUnitWorkCount, 0.0);
  uint32_t rows = 0;
  bool has_total = false;
  std::string line;
  while (!line.starts_with("pass  items")) ASSERT_TRUE(std::getline(text, line));
  std::getline(text, line);  // units
  while (!has_total && std::getline(text, line)) {
    const bool is_total = line.starts_with("all ");
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
  const auto& with = json["frame_ms_with_availability"];
  EXPECT_EQ(json["availability"], 0.92) << "on both consoles";
  EXPECT_DOUBLE_EQ(double(with["median"]) * 0.92, s.median_ms);
  EXPECT_DOUBLE_EQ(double(with["p95"]) * 0.92, s.p95_ms);
  EXPECT_DOUBLE_EQ(double(with["worst"]) * 0.92, s.worst_ms);
  EXPECT_EQ(json["verdict_takes"], "frame_ms_with_availability.p95");
  EXPECT_EQ(std::string(json["availability_from"]).find("none was measured") != std::string::npos,
            GetParam() == Console::kXbox360);
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

// ---- Advice, and what the options change --------------------------------------------------------

std::string Joined(const std::vector<std::string>& lines) {
  return fmt::format("{}", fmt::join(lines, "\n"));
}

// Between the two times only the one with the availability decides.
TEST_P(ConsoleOf, TheVerdictTakesTheTimeWithTheAvailability) {
  const ConsoleBudget& b = on().budget;
  EXPECT_DOUBLE_EQ(b.VerdictMs(), b.summary.p95_ms / 0.92);
  EXPECT_FALSE(b.Fits((b.summary.p95_ms + b.VerdictMs()) / 2));
  EXPECT_TRUE(b.Fits(b.VerdictMs()));
  const std::string text = ProseOf(b, on().scene());
  EXPECT_NE(text.find("availability of 0.92"), text.npos) << text;
  EXPECT_NE(text.find("which the verdict takes"), text.npos) << text;
  EXPECT_NE(text.find(fmt::format("p95 {:.2f}", b.VerdictMs())), text.npos) << text;
}

TEST_P(ConsoleOf, NoAdviceForWhatFits) { EXPECT_TRUE(Advise(on().run, on().budget, 8.0).empty()); }

// The budget that the advice names is set, and the scene fits.
TEST_P(ConsoleOf, AStrandBudgetThatIsAdvisedFits) {
  Modelled& on = this->on();
  const double least_ms =
      on.run.TryLod({.strand_budget = 16, .costs = {}}, ConsoleRun::Trial::kAllFrames).ms;
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
  ConsoleRequest request{.console = GetParam(), .frames = kModelledFrames};
  request.skip.lod = true;
  request.lod.strand_budget = strands;
  const Modelled again(request);
  EXPECT_TRUE(again.budget.Fits(target_ms))
      << strands << " strands: " << again.budget.VerdictMs() << " ms, not " << target_ms << "\n"
      << advice;
  EXPECT_NE(advice.find("what binds: "), advice.npos) << advice;
}

TEST_P(ConsoleOf, SaysWhenFewerStrandsDoNotHelp) {
  const std::string advice = Joined(Advise(on().run, on().budget, 0.001));
  EXPECT_EQ(advice.find("--strand-budget"), advice.npos) << advice;
  EXPECT_NE(advice.find("does not depend on strands"), advice.npos) << advice;
}

TEST_P(ConsoleOf, FewerStrandsTakeLess) {
  const auto all =
      on().run.TryLod({.strand_budget = 1000, .costs = {}}, ConsoleRun::Trial::kFewFrames);
  const auto less =
      on().run.TryLod({.strand_budget = 200, .costs = {}}, ConsoleRun::Trial::kFewFrames);
  EXPECT_LT(less.live_strands, all.live_strands);
  EXPECT_LT(less.ms, all.ms);
}

// ---- Ranges, warming up -------------------------------------------------------------------------

TEST_P(ConsoleOf, AFrameLiesInTheRangeOfItsCode) {
  const ConsoleBudget& b = on().budget;
  EXPECT_GT(b.machine.code_order, 0.0);
  EXPECT_LT(b.machine.code_order, 1.0);
  EXPECT_LT(b.scheduled_ms.median, b.summary.median_ms);
  EXPECT_LT(b.summary.median_ms, b.as_written_ms.median);
  EXPECT_LE(b.scheduled_ms.p95, b.summary.p95_ms);
  EXPECT_LE(b.summary.p95_ms, b.as_written_ms.p95);
  const double least = b.machine.Available(b.scheduled_ms.p95),
               most = b.machine.Available(b.as_written_ms.p95);
  EXPECT_TRUE(b.FitsOnlyAtOneEnd((least + most) / 2));
  EXPECT_FALSE(b.FitsOnlyAtOneEnd(most));
  EXPECT_FALSE(b.FitsOnlyAtOneEnd(least * 0.99));
  const std::string text = ProseOf(b, on().scene());
  EXPECT_NE(text.find(DescribeRange(b)), text.npos) << text;
  const auto json = AsJson(b, on().scene());
  EXPECT_EQ(json["range"]["scheduled_ms"]["p95"], b.scheduled_ms.p95);
  EXPECT_EQ(json["range"]["as_written_ms"]["median"], b.as_written_ms.median);
  EXPECT_EQ(json["range"]["code_order"], b.machine.code_order);
  const auto page =
      JsonOf([&](JsonText& page_text) { AddConsoleFrame(page_text, b, on().scene()); });
  EXPECT_NE(std::string(page["verdict"]).find(DescribeRange(b)), std::string::npos);
}

// A layer in `fine` that is small on screen takes `fast` there too, unless the request wants it seen.
TEST_P(ConsoleOf, PricesTheQualityThatFramesHave) {
  Scenario tiny = LoadScenario("tiny");
  ConsoleRequest request{.console = GetParam(), .frames = 2};
  request.lod.fast_quality_px = 0.0f;
  const ConsoleBudget exact = ConsoleRun(tiny, request).Run();
  const auto cycles = [](const ConsoleBudget& budget) {
    const auto stage =
        std::ranges::find(budget.costs.stages, "simulate_modal_4", &StageCosts::Stage::name);
    return SumOf(stage->scheduled.cycles_per_iteration);
  };
  EXPECT_GT(cycles(exact), 1.5 * cycles(on().budget));
}

// LOD takes its strands away over the first frames: a few frames from the start are not what it
// settles at, the same few behind a warm-up are.
TEST(ConsoleBudget, WarmingUpLeavesTheRampOfLodOut) {
  Scenario tiny = LoadScenario("tiny");
  ConsoleRequest request{.console = Console::kXbox360, .frames = 4};
  request.skip.lod = true;
  request.lod.strand_budget = 200;
  const double cold_ms = ConsoleRun(tiny, request).Run().summary.p95_ms;
  request.warm_up = 30;
  const ConsoleBudget warm = ConsoleRun(tiny, request).Run();
  EXPECT_LT(warm.summary.p95_ms, 0.9 * cold_ms);
  EXPECT_EQ(warm.warm_up, 30u);
  EXPECT_FALSE(warm.differs_at);
  EXPECT_EQ(warm.summary.frames, 4u);
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
}  // namespace pelt::testing
