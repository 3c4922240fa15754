// Scheduling: right on random programs, never slower than program order, never faster than the
// units, and near them where nothing else holds.
#include "platform_sim/schedule/schedule.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/platform_sim/straight_programs.hpp"

namespace pelt::testing {
namespace {

void ExpectGood(const StraightCode& code, const CoreUnderTest& on, const std::string& what) {
  const FinishedCode plain = InOrder(code, on.core), fast = Scheduled(code, on.core);
  EXPECT_TRUE(IsRight(code, plain, on.core)) << what;
  EXPECT_TRUE(IsRight(code, fast, on.core)) << what;
  const int64_t cycles = CyclesOf(fast, on.core);
  EXPECT_LE(cycles, CyclesOf(plain, on.core)) << what;
  EXPECT_GE(cycles, ResourceBoundCycles(code.program, on.core)) << what;
  // The issue model counts live registers on its own.
  const IssueChart chart = on.core.time(fast.program).OrThrow();
  EXPECT_LE(chart.live.back().most, on.core.Of(ValueFile::kVector).count) << what;
  EXPECT_EQ(chart.live.back().most, fast.most_live_vectors) << what;
}

TEST(Scheduling, RandomProgramsAreRightAndWithinTheirBounds) {
  const RandomShape shapes[] = {{},
                                {.reach = 4},
                                {.instructions = 600, .reach = 300},
                                {.words = 4},
                                {.words = 4096},
                                {.one_chain = true},
                                {.instructions = 40, .entry_values = 150},
                                {.instructions = 1}};
  for (const CoreUnderTest& on : CoresUnderTest())
    for (size_t s = 0; s < std::size(shapes); ++s)
      for (uint32_t seed = 0; seed < 12; ++seed)
        ExpectGood(RandomProgram(on, seed, shapes[s]), on,
                   fmt::format("{}, shape {}, seed {}", on.name, s, seed));
}

TEST(Scheduling, NothingIsNothing) {
  const CoreUnderTest on = SpuUnderTest();
  EXPECT_TRUE(Scheduled({}, on.core).program.empty());
  EXPECT_TRUE(InOrder({}, on.core).program.empty());
}

TEST(Scheduling, TheSameCodeGivesTheSameInstructions) {
  const CoreUnderTest on = SpuUnderTest();
  const StraightCode code = RandomProgram(on, 3, {.instructions = 600, .reach = 300});
  const FinishedCode a = Scheduled(code, on.core), b = Scheduled(code, on.core);
  EXPECT_EQ(a.origin, b.origin);
}

// Cycles are the issue model's; but what the scheduler thinks of them is the same, where spills and
// registers allow any order: were it not, it would optimise something else.
TEST(Scheduling, TheSchedulersOwnCountIsTheIssueModels) {
  for (const CoreUnderTest& on : CoresUnderTest())
    for (uint32_t groups : {1, 2, 8}) {
      const StraightCode code = ChainSweep(on, groups, 4, 3);
      const FittedCode fitted = FitRegisters(code, on.core).OrThrow();
      const IssueOrder order = ScheduleWithin(512, ScheduleInput(fitted.code, on.core));
      const FinishedCode finished = Finish(fitted, order, on.core).OrThrow();
      EXPECT_EQ(order.cycles(), CyclesOf(finished, on.core)) << on.name << ", " << groups;
    }
}

TEST(Scheduling, LaneGroupsComeNearTheResourceBound) {
  // Registers are what a PPE lacks: one group has nearly all of its 32, and its chain is exposed.
  struct Case {
    CoreUnderTest on;
    double most_over_bound;
  };
  for (const Case& c : {Case{SpuUnderTest(), 1.10}, Case{PpeUnderTest(128), 1.20}}) {
    const StraightCode few = ChainSweep(c.on, 8, 4, 4), many = ChainSweep(c.on, 24, 4, 4);
    const int64_t few_cycles = CyclesOf(Scheduled(few, c.on.core), c.on.core);
    const int64_t many_cycles = CyclesOf(Scheduled(many, c.on.core), c.on.core);
    const double bound = double(ResourceBoundCycles(many.program, c.on.core));
    const double bound_between = bound - double(ResourceBoundCycles(few.program, c.on.core));
    fmt::print(
        "{}: 24 lane groups in {} cycles, {} in order, {:.1f} % over the units' bound; "
        "a group more, {:.1f} %\n",
        c.on.name, many_cycles, CyclesOf(InOrder(many, c.on.core), c.on.core),
        100.0 * (double(many_cycles) / bound - 1.0),
        100.0 * (double(many_cycles - few_cycles) / bound_between - 1.0));
    EXPECT_LT(double(many_cycles), c.most_over_bound * bound) << c.on.name;
    EXPECT_LT(double(many_cycles - few_cycles), 1.05 * bound_between) << c.on.name;
  }
}

TEST(Scheduling, RandomProgramsTakenForIterationsAreRight) {
  for (const CoreUnderTest& on : CoresUnderTest())
    for (uint32_t seed = 0; seed < 12; ++seed) {
      const StraightCode code =
          RandomProgram(on, seed, {.instructions = 600, .reach = 100, .entry_values = 40});
      const FinishedCode finished = ScheduleIterations(code, 2 + seed % 4, on.core).OrThrow();
      EXPECT_TRUE(IsRight(code, finished, on.core)) << on.name << ", seed " << seed;
    }
}

TEST(Scheduling, OnlyPairsArePadded) {
  const CoreUnderTest on = SpuUnderTest();
  // One chain: nothing ever pairs, so nothing is padded.
  StraightBuilder b;
  uint32_t value = b.Value();
  for (int i = 0; i < 50; ++i) value = b.Compute(i % 2 ? on.real : on.permute, {value});
  b.Store(on.store, 0, value);
  EXPECT_EQ(Scheduled(b.Finish(), on.core).padding, 0u);
  // Without padding the same code is slower.
  const StraightCode sweep = ChainSweep(on, 8, 4, 4);
  const FinishedCode padded = Scheduled(sweep, on.core);
  FinishedCode bare;
  for (size_t i = 0; i < padded.program.size(); ++i)
    if (padded.origin[i] != kPadding) {
      bare.program.push_back(padded.program[i]);
      bare.program.back().location_bytes = 4 * (bare.program.size() - 1);
    }
  EXPECT_GT(padded.padding, 0u);
  EXPECT_GT(CyclesOf(bare, on.core), CyclesOf(padded, on.core));
}

// Row C13's work: C -= A B on tiles of 64 x 64 in a local store, eight rows by four quadwords of C
// in registers at a time. Values and addresses only; the hand-made schedule beside which it stands
// is the one of the measured rows.
StraightCode MatrixMultiplyBlocks(const CoreUnderTest& on, uint32_t blocks) {
  constexpr int32_t kA = 0, kB = 16384, kC = 32768, kRowBytes = 256;
  StraightBuilder b;
  std::array<uint32_t, 4> spread{};
  for (uint32_t& pattern : spread) pattern = b.Value();
  for (uint32_t block = 0; block < blocks; ++block) {
    const int32_t row = int32_t(block / 4 * 8), column = int32_t(block % 4 * 64);
    const auto of_c = [&](int32_t i) {
      return kC + (row + i / 4) * kRowBytes + column + i % 4 * 16;
    };
    std::array<uint32_t, 32> sum{};
    for (int32_t i = 0; i < 32; ++i) sum[size_t(i)] = b.Load(on.load, of_c(i));
    std::array<uint32_t, 8> of_a{};
    for (int32_t k = 0; k < 64; ++k) {
      for (int32_t r = 0; r < 8 && k % 4 == 0; ++r)
        of_a[size_t(r)] = b.Load(on.load, kA + (row + r) * kRowBytes + k * 4);
      std::array<uint32_t, 4> of_b{};
      for (int32_t c = 0; c < 4; ++c)
        of_b[size_t(c)] = b.Load(on.load, kB + k * kRowBytes + column + c * 16);
      uint32_t factor = 0;
      for (size_t i = 0; i < 32; ++i) {
        if (i % 4 == 0)
          factor = b.Compute(on.permute, {of_a[i / 4], of_a[i / 4], spread[size_t(k % 4)]});
        sum[i] = b.Compute(on.real, {factor, of_b[i % 4], sum[i]});
      }
    }
    for (int32_t i = 0; i < 32; ++i) b.Store(on.store, of_c(i), sum[size_t(i)]);
  }
  return b.Finish();
}

TEST(Scheduling, AMatrixMultiplyComesNearTheMeasuredRow) {
  const CoreUnderTest on = SpuUnderTest();
  constexpr uint32_t kBlocks = 8;
  const StraightCode code = MatrixMultiplyBlocks(on, kBlocks);
  const FinishedCode fast = Scheduled(code, on.core);
  EXPECT_TRUE(IsRight(code, fast, on.core));
  const double of_peak = kBlocks * 2048 / double(CyclesOf(fast, on.core));
  fmt::print(
      "C13: {:.2f} % of peak by the scheduler, filling and draining included; 99.8 % "
      "measured for a schedule by hand; in order {:.1f} %\n",
      100.0 * of_peak, kBlocks * 2048 * 100.0 / double(CyclesOf(InOrder(code, on.core), on.core)));
  EXPECT_GT(of_peak, 0.995);
  EXPECT_EQ(fast.spill_stores + fast.spill_loads, 0u);
}

}  // namespace
}  // namespace pelt::testing
