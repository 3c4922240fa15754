// What advice says of a change is what a run with that change takes, and what doing it takes.
#include "platform_sim/frame/what_if.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "bench/consoles/console_advice.hpp"
#include "bench/consoles/console_report.hpp"
#include "core/character/pose.hpp"
#include "core/groom/bake.hpp"
#include "core/groom/groom_file.hpp"
#include "tests/command/modelled_console.hpp"

namespace pelt {
namespace {

using namespace testing;

double SumOf(const auto& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

std::string AdviceOf(ConsoleRun& run, const ConsoleBudget& budget) {
  return fmt::format("{}", fmt::join(Advise(run, budget, 0.001), "\n"));
}

bool Holds(const std::string& text, const std::string& part) {
  return text.find(part) != text.npos;
}

// The advice's line on a change, as far as the time that it gives.
std::string LineOn(WhatIf what_if, double ms, double instead_of_ms) {
  return fmt::format("memory: {}: {:.2f} ms instead of {:.2f} (--what-if {})",
                     DescribeWhatIf(what_if), ms, instead_of_ms, WhatIfName(what_if));
}

TEST_P(ConsoleOf, AdviceOnAChangeIsWhatARunWithItTakes) {
  const std::string advice = AdviceOf(on().run, on().budget);
  for (const WhatIf what_if : kAllWhatIfs) {
    SCOPED_TRACE(WhatIfName(what_if));
    const Modelled changed({.console = GetParam(), .frames = kModelledFrames, .what_if = what_if});
    const FrameSummary &was = on().budget.summary, &is = changed.budget.summary;
    const double now_ms = on().budget.VerdictMs(), ms = changed.budget.VerdictMs();
    EXPECT_FALSE(changed.budget.differs_at);
    EXPECT_EQ(changed.budget.digest == on().budget.digest, what_if != WhatIf::kFewerPoints);
    EXPECT_EQ(on().run.TryWhatIf(what_if), ms);
    EXPECT_EQ(ParseWhatIf(WhatIfName(what_if)), what_if);
    const std::string text = ProseOf(changed.budget, changed.scene());
    EXPECT_TRUE(Holds(text, fmt::format("what if: {}", DescribeWhatIf(what_if)))) << text;
    if (what_if != WhatIf::kFewerPoints) {
      const std::string why = on().run.WhyNoChange(what_if);
      EXPECT_FALSE(why.empty());
      EXPECT_TRUE(Holds(advice, fmt::format("{} ({})", WhatIfName(what_if), why))) << advice;
      EXPECT_TRUE(Holds(text, "CHANGES NOTHING: " + why)) << text;
      EXPECT_EQ(SumOf(is.stream_get_bytes), SumOf(was.stream_get_bytes));
      EXPECT_EQ(ms, now_ms);
      continue;
    }
    EXPECT_EQ(changed.budget.why_no_change, "");
    EXPECT_FALSE(Holds(text, "CHANGES NOTHING"));
    // Of layers with fewer points less is written; how much is fetched again hangs on what a core does next, too.
    const auto moved = [](const FrameSummary& frame) {
      return SumOf(frame.stream_get_bytes) + SumOf(frame.stream_put_bytes) + frame.code_bytes;
    };
    EXPECT_LT(SumOf(is.stream_put_bytes), SumOf(was.stream_put_bytes));
    EXPECT_LT(moved(is), moved(was));
    if (ms <= 0.99 * now_ms) {
      EXPECT_TRUE(Holds(advice, LineOn(what_if, ms, now_ms))) << advice;
    } else {
      EXPECT_TRUE(Holds(advice, fmt::format("{} ({:.2f} ms)", WhatIfName(what_if), ms))) << advice;
    }
  }
}

// Where layers are sorted in pieces: three rounds instead of four.
TEST(WhatIf, WiderDigitsLeaveARoundOfTheSortOut) {
  Scenario monster = LoadScenario("monster");
  ConsoleRequest request{.console = Console::kPs3, .frames = 3};
  ConsoleRun run(monster, request);
  const ConsoleBudget was = run.Run();
  request.what_if = WhatIf::kWiderDigits;
  ConsoleRun changed(monster, request);
  const ConsoleBudget is = changed.Run();
  EXPECT_FALSE(is.differs_at);
  EXPECT_EQ(is.digest, was.digest);
  EXPECT_EQ(run.TryWhatIf(WhatIf::kWiderDigits), is.VerdictMs());
  uint32_t left_out = 0;
  for (uint32_t p = 0; p < is.summary.passes.size(); ++p)
    left_out += was.summary.passes[p].items > 0.0 && is.summary.passes[p].items == 0.0;
  EXPECT_EQ(left_out, 3u);  // count, offsets, scatter
  EXPECT_GT(is.summary.stream_get_bytes[size_t(StreamOf<&Streams::digits>)],
            3.0 * was.summary.stream_get_bytes[size_t(StreamOf<&Streams::digits>)]);
}

// The scenario as if its setup said `points = 4`.
Scenario BakedWithFourPoints(const Scenario& scenario, const std::string& setup_name) {
  Scenario out = scenario;
  FurSetup setup = LoadSetup(setup_name);
  for (LayerSetup& layer : setup.layers) layer.params.points = 4;
  const float unit_scale = scenario.actors[0].unit_scale;
  out.grooms[0] =
      BakeGroom(scenario.characters[0], ComputeRestGeometry(scenario.characters[0], unit_scale),
                setup, unit_scale);
  return out;
}

// The change, done: what was printed as its gain is what a bake with fewer points gains. Not to the
// last digit: a strand bent in three places is not quite where one bent in four was.
TEST(WhatIf, FewerPointsGainWhatABakeWithThemGains) {
  for (const Console console : kAllConsoles) {
    SCOPED_TRACE(ConsoleName(console));
    Scenario eyepet = LoadScenario("eyepet");
    const ConsoleRequest request{.console = console, .frames = 3, .warm_up = 10};
    ConsoleRun run(eyepet, request);
    const ConsoleBudget was = run.Run();
    const double tried_ms = run.TryWhatIf(WhatIf::kFewerPoints);
    EXPECT_TRUE(Holds(AdviceOf(run, was), LineOn(WhatIf::kFewerPoints, tried_ms, was.VerdictMs())));

    Scenario baked = BakedWithFourPoints(eyepet, "eyepet");
    ConsoleRun done(baked, request);
    const ConsoleBudget is = done.Run();
    EXPECT_LT(is.VerdictMs(), 0.95 * was.VerdictMs());
    // Which strands press on something is another matter with other points, and costs.
    EXPECT_NEAR(tried_ms, is.VerdictMs(), 0.1 * is.VerdictMs());
    EXPECT_EQ(is.strands, was.strands);
    // Done, there is nothing left to gain, and that is said.
    const std::string advice = AdviceOf(done, is);
    EXPECT_TRUE(Holds(advice, "fewer-points (no strand has more than 4 points)")) << advice;
    EXPECT_EQ(done.TryWhatIf(WhatIf::kFewerPoints), is.VerdictMs());
  }
}

// Where there is no setup: what a groom file holds is resampled as it is.
TEST(WhatIf, FewerPointsOfAGroomFile) {
  const std::string path = ::testing::TempDir() + "what_if_fewer_points.groom";
  WriteGroomFile(LoadScenario(ScenarioRequest{.setup = "tiny"}).grooms[0], path).OrThrow();
  Scenario from_setup = LoadScenario(ScenarioRequest{.setup = "tiny"});
  Scenario from_groom = LoadScenario(ScenarioRequest{.groom = path});
  std::remove(path.c_str());
  const ConsoleRequest request{
      .console = Console::kPs3, .frames = 3, .what_if = WhatIf::kFewerPoints};
  ConsoleRun a(from_setup, request), b(from_groom, request);
  const ConsoleBudget of_setup = a.Run(), of_groom = b.Run();
  EXPECT_EQ(of_setup.digest, of_groom.digest);
  EXPECT_EQ(of_setup.VerdictMs(), of_groom.VerdictMs());
  EXPECT_EQ(of_groom.why_no_change, "");
}

// A change on top of fewer points is tried on the scene as it was given.
TEST(WhatIf, OtherChangesAreTriedWithoutFewerPoints) {
  Scenario tiny = LoadScenario("tiny");
  ConsoleRequest request{.console = Console::kXbox360, .frames = 3};
  ConsoleRun plain(tiny, request);
  request.what_if = WhatIf::kFewerPoints;
  ConsoleRun fewer(tiny, request);
  EXPECT_EQ(fewer.TryWhatIf(WhatIf::kWiderDigits), plain.TryWhatIf(WhatIf::kWiderDigits));
  EXPECT_EQ(fewer.TryWhatIf(WhatIf::kNothing), plain.TryWhatIf(WhatIf::kNothing));
  EXPECT_NE(fewer.TryWhatIf(WhatIf::kFewerPoints), plain.TryWhatIf(WhatIf::kNothing));
}

}  // namespace
}  // namespace pelt
