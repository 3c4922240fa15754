// The measured rows, all of them, against the models; and what else is known of their work.
#include "platform_sim/measured_rows.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "platform_sim/memory/xenon_memory.hpp"
#include "platform_sim/rows/row_work.hpp"
#include "tests/platform_sim/timing_rows.hpp"

namespace pelt::testing {
namespace {

TEST(MeasuredRows, EachIsPredictedWithinWhatItAllows) {
  for (const RowResult& row : PredictRows()) {
    fmt::print(
        "{:<5} {:>9.4g} raw {:+6.2f} %, {:>9.4g} available {:+6.2f} %, measured {} to {} {}\n",
        row.id, row.predicted_raw, row.ErrorPercent(row.predicted_raw),
        row.predicted_with_availability, row.ErrorPercent(row.predicted_with_availability),
        row.measured_least, row.measured_most, row.unit);
    EXPECT_EQ(row.failure, "") << row.id;
    EXPECT_EQ(row.passes, row.missed_because.empty()) << row.id << ": " << row.Predicted();
    EXPECT_EQ(row.Surprises(), false) << row.id;
  }
}

// A miss is stated with its reason, and only there.
TEST(MeasuredRows, ThoseThatAreKnownToBeMissed) {
  std::set<std::string_view> missed;
  for (const RowDefinition& row : MeasuredRows())
    if (!row.missed_because.empty()) missed.insert(row.id);
  EXPECT_EQ(missed, (std::set<std::string_view>{"C10", "E1", "P5"}));
}

TEST(MeasuredRows, AreAllThatTheReferenceLists) {
  std::set<std::string_view> ids;
  for (const RowDefinition& row : MeasuredRows()) {
    EXPECT_TRUE(ids.insert(row.id).second) << row.id;
    EXPECT_FALSE(row.work.empty() || row.unit.empty() || row.allowed_from.empty()) << row.id;
  }
  for (const char* id :
       {"C1", "C2",  "C3",  "C4",  "C5",  "C6", "C7", "C9", "C10", "C13", "C23", "D1",
        "D2", "D3",  "D4",  "D5",  "D6",  "D7", "D8", "D9", "E1",  "E2",  "E8",  "S1",
        "S2", "J1a", "J1b", "J1c", "J4",  "P1", "P2", "P3", "P4",  "P5",  "P6",  "P7",
        "P8", "P9",  "P10", "P11", "P12", "X1", "X2", "X3", "X4",  "X5",  "X6"})
    EXPECT_EQ(ids.count(id), 1u) << id;
}

// What repeats another row, restates its own measurement, is a loop of our choosing or is the
// models' own number is no evidence: it is listed, with the reason, and not counted.
TEST(MeasuredRows, OnlyIndependentOnesCount) {
  const std::map<RowClass, std::set<std::string_view>> expected = {
      {RowClass::kDerived, {"C23t", "D4", "D5", "D6", "D7", "D8", "D9", "J1a", "J1b", "J1c"}},
      {RowClass::kPlausibility, {"C13", "S1", "X6"}},
      {RowClass::kParameter, {"S2", "J4", "P1", "P3", "X1", "X2", "X3", "X4", "X5"}}};
  std::map<RowClass, std::set<std::string_view>> found;
  for (const RowDefinition& row : MeasuredRows()) {
    EXPECT_EQ(row.class_because.empty(), row.row_class == RowClass::kIndependent) << row.id;
    if (row.row_class != RowClass::kIndependent) found[row.row_class].insert(row.id);
  }
  EXPECT_EQ(found, expected);
}

TEST(MeasuredRows, AreCountedByClass) {
  std::vector<RowResult> rows(4);
  rows[0].row_class = rows[1].row_class = RowClass::kIndependent;
  rows[2].row_class = rows[3].row_class = RowClass::kDerived;
  rows[0].passes = rows[2].passes = rows[3].passes = true;
  EXPECT_EQ(CountRows(rows, RowClass::kIndependent).rows, 2u);
  EXPECT_EQ(CountRows(rows, RowClass::kIndependent).missed, 1u);
  EXPECT_EQ(CountRows(rows, RowClass::kDerived).missed, 0u);
  EXPECT_EQ(CountRows(rows, RowClass::kParameter).rows, 0u);
}

// Both figures that are given for the clock; cycles do not know it.
TEST(MeasuredRows, HoldAtTheRoundClockToo) {
  PlatformParameters p;
  p.cell.clock_hz = 3'200'000'000;
  for (const char* id :
       {"C1", "C2", "C5", "C7", "D1", "D2", "D3", "E2", "E8", "S1", "P6", "P7", "P8", "P9", "P11"})
    EXPECT_TRUE(PredictRow(*FindRow(id), p).passes) << id;
}

// What makes it one constant: without it every rate of the SPUs is too fast by the same.
TEST(MeasuredRows, RatesOfTheSpusAreAllOffByTheAvailability) {
  for (const char* id : {"C1", "C2", "C3", "C4", "C5", "C6", "C7"}) {
    const RowResult row = PredictRow(*FindRow(id), {});
    EXPECT_NEAR(row.predicted_raw / row.measured_least, 1.0 / CellSystem{}.Availability(), 0.02)
        << id;
  }
}

TEST(MeasuredRows, ARowThatCannotBeRunSaysWhyAndIsMissed) {
  PlatformParameters p;
  p.cell.spu_count = 0;
  for (const char* id : {"C1", "D1", "E1"}) {
    const RowResult row = PredictRow(*FindRow(id), p);
    EXPECT_FALSE(row.passes) << id;
    EXPECT_NE(row.failure.find("no SPU"), std::string::npos) << id << ": " << row.failure;
  }
}

TEST(MeasuredRows, IterationsOfTheRateRowsInCycles) {
  EXPECT_EQ(CyclesPerIteration(TimeOnSpu(SinglePrecisionFma())), 64 * 6 + 21);
  EXPECT_EQ(CyclesPerIteration(TimeOnSpu(IntegerMultiplyAdd())), 32 * 7 + 21);
  EXPECT_EQ(CyclesPerIteration(TimeOnSpu(NewtonSteps())), 8 * 80 + 21);
  EXPECT_EQ(CyclesPerIteration(TimeOnSpu(DoublePrecisionFma())), 16 * 13 * 8 + 21);
}

TEST(MeasuredRows, TheMatrixMultiplyFitsTheRegistersAndIsBoundByTheEvenPipe) {
  const IssueChart chart = TimeOnSpu(MatrixMultiply());
  EXPECT_LE(chart.live[0].most, 128u);
  EXPECT_EQ(BindingResource(chart, chart.loops[0].period), "even pipe");
}

TEST(MeasuredRows, ThePublishedListingPairsAsPrinted) {
  const IssueTotals totals =
      TimeOnSpu(PublishedListing(), {}, {.pair_by_order = true}).first_pass_totals;
  EXPECT_EQ(totals.dual_issues, 4u);
  ExpectAllCyclesAccountedFor(totals);
}

// What a second hardware thread gains is what the first one waits: X6's range is between these.
TEST(MeasuredRows, ASecondThreadGainsWhatTheFirstWaits) {
  const auto gain = [](const std::string& text) {
    std::string error;
    const PpeParameters core = XenonMemory().core;
    const auto alone = TimePpeListing(text, {}, core, error);
    const auto both = TimePpePair(text, text, core, error);
    EXPECT_TRUE(alone && both) << error;
    return 2.0 * CyclesPerIteration(*alone) / both->CyclesPerIteration(0) - 1.0;
  };
  std::string twelve_chains = "loop:\n";
  for (int i = 1; i <= 12; ++i) twelve_chains += fmt::format(" vmaddfp v{0}, v{0}, v20, v21\n", i);
  EXPECT_NEAR(gain(twelve_chains + " bdnz loop\n"), 0.0, 0.01);
  EXPECT_NEAR(gain(VectorFmaChains()), 1.0, 0.01);
}

// A chase that stays in L1 is the core's own iteration: the caches add nothing.
TEST(MeasuredRows, TheL1ChaseIsTheCoresOwnIteration) {
  std::string error;
  const auto chart = TimePpeListing(PointerChase(), {}, CellParameters{}.ppe, error);
  ASSERT_TRUE(chart) << error;
  EXPECT_EQ(PredictRow(*FindRow("P1"), {}).predicted_raw,
            CyclesPerIteration(*chart) / kChasesPerIteration);
}

// The console counts 390,000 L1 misses of 524,288 loads in row P3's chase: three quarters.
TEST(MeasuredRows, AQuarterOfTheL2ChaseHitsL1) {
  const PpeWalk walk = WalkAtRandom(128 * 1024 / 4, 128 / 4);
  std::vector<MemoryAccess> trace;
  for (int round = 0; round < 2; ++round)
    for (const uint32_t line : walk.loads)
      trace.push_back({AccessKind::kLoad, 4, uint64_t{line} * 128, int64_t(trace.size()) * 100, 0});
  CacheMemoryRun run;
  std::string error;
  ASSERT_TRUE(RunCacheMemory(PpeMemory(), {{trace}}, run, error)) << error;
  EXPECT_NEAR(double(run.threads[0].l1_misses) / double(trace.size()), 390.0 / 524.288, 0.02);
}

// The measured pair's rates are of unequal work: the scalar thread has its core for itself once the
// other is done. Beside each other they have half of the cycles each.
TEST(MeasuredRows, ThePairsThreadsHaveHalfOfTheCyclesEach) {
  std::string error;
  const auto both = TimePpePair(ScalarFmaChains(), IntegerAddChains(), CellParameters{}.ppe, error);
  ASSERT_TRUE(both) << error;
  EXPECT_NEAR(both->CyclesPerIteration(0), 2 * kEightChains, 1.0);
  EXPECT_NEAR(both->CyclesPerIteration(1), 2 * kEightChains, 1.0);
}

}  // namespace
}  // namespace pelt::testing
