// The measured rows, all of them, against the models; and what else is known of their work.
#include "platform_sim/measured_rows.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "platform_sim/rows/row_work.hpp"
#include "tests/platform/timing_rows.hpp"

namespace pelt {
namespace {

using namespace testing;

TEST(MeasuredRows, EachIsPredictedWithinWhatItAllows) {
  for (const RowResult& row : PredictRows()) {
    fmt::print(
        "{:<5} {:>9.4g} raw {:+6.2f} %, {:>9.4g} available {:+6.2f} %, measured {} to {} {}\n",
        row.id, row.predicted_raw, row.ErrorPercent(row.predicted_raw),
        row.predicted_with_availability, row.ErrorPercent(row.predicted_with_availability),
        row.measured_least, row.measured_most, row.unit);
    EXPECT_EQ(row.failure, "") << row.id;
    EXPECT_TRUE(row.passes) << row.id << ": " << row.Predicted();
  }
}

TEST(MeasuredRows, AreAllThatTheReferenceLists) {
  std::set<std::string_view> ids;
  for (const RowDefinition& row : MeasuredRows()) {
    EXPECT_TRUE(ids.insert(row.id).second) << row.id;
    EXPECT_FALSE(row.work.empty() || row.unit.empty() || row.allowed_from.empty()) << row.id;
  }
  for (const char* id : {"C1", "C2", "C5", "C7", "C9", "C13", "C23", "D1", "D3",  "D4",  "D5",
                         "D6", "D7", "D8", "D9", "E1", "E8",  "S1",  "S2", "J1a", "J1b", "J1c",
                         "J4", "P1", "P3", "P5", "P7", "X1",  "X2",  "X3", "X4",  "X5",  "X6"})
    EXPECT_EQ(ids.count(id), 1u) << id;
}

// Both figures that are given for the clock; cycles do not know it.
TEST(MeasuredRows, HoldAtTheRoundClockToo) {
  PlatformParameters p;
  p.cell.clock_hz = 3'200'000'000;
  for (const char* id : {"C1", "C2", "C5", "C7", "D1", "D3", "E8", "S1", "P5", "P7"})
    EXPECT_TRUE(PredictRow(*FindRow(id), p).passes) << id;
  const RowDefinition& pairs = *FindRow("E1");
  CellMemoryParameters one = p.cell;  // the 28 consoles of E1 stretch by the clock like this one
  std::string error;
  const auto run = RunLocalStoreReads(one, {1, 0, 3, 2, 5, 4}, 8, error);
  ASSERT_TRUE(run) << error;
  const double round = run->GigabytesPerSecond(one);
  one.clock_hz = CellSystem{}.clock_hz;
  EXPECT_NEAR(run->GigabytesPerSecond(one) / round, 0.9975, 1e-9);
  EXPECT_EQ(pairs.kind, RowKind::kRate);
}

// What makes it one constant: without it every rate of the SPUs is too fast by the same.
TEST(MeasuredRows, RatesOfTheSpusAreAllOffByTheAvailability) {
  for (const char* id : {"C1", "C2", "C5", "C7"}) {
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

TEST(MeasuredRows, TurnsOfTheRateRowsInCycles) {
  EXPECT_EQ(CyclesPerTurn(TimeOnSpu(SinglePrecisionFma())), 64 * 6 + 21);
  EXPECT_EQ(CyclesPerTurn(TimeOnSpu(IntegerMultiplyAdd())), 32 * 7 + 21);
  EXPECT_EQ(CyclesPerTurn(TimeOnSpu(NewtonSteps())), 8 * 80 + 21);
  EXPECT_EQ(CyclesPerTurn(TimeOnSpu(DoublePrecisionFma())), 16 * 13 * 8 + 21);
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
    const auto shared = TimePpeListing(text, {.smt = true}, core, error);
    EXPECT_TRUE(alone && shared) << error;
    return 2.0 * CyclesPerTurn(*alone) / CyclesPerTurn(*shared) - 1.0;
  };
  std::string twelve_chains = "loop:\n";
  for (int i = 1; i <= 12; ++i) twelve_chains += fmt::format(" vmaddfp v{0}, v{0}, v20, v21\n", i);
  EXPECT_NEAR(gain(twelve_chains + " bdnz loop\n"), 0.0, 0.01);
  EXPECT_NEAR(gain(VectorFmaChains()), 1.0, 0.01);
}

// The rows of one P: the chase by the core alone and by core and caches are one number.
TEST(MeasuredRows, TheL1ChaseIsTheCoresOwnTurn) {
  std::string error;
  const auto chart = TimePpeListing(PointerChase(), {.smt = true}, CellParameters{}.ppe, error);
  ASSERT_TRUE(chart) << error;
  EXPECT_EQ(PredictRow(*FindRow("P1"), {}).predicted_raw, CyclesPerTurn(*chart));
}

}  // namespace
}  // namespace pelt
