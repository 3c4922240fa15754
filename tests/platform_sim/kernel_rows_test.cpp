// Measured kernels through the whole back end: hardware lies between the order their source has
// and the best schedule, and errors that are planted on the way are noticed.
#include "platform_sim/kernel_rows.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "platform_sim/pricing/record_kernel.hpp"
#include "platform_sim/rows/measured_kernels.hpp"

namespace pelt {
namespace {

const std::vector<KernelRow>& PricedRows() {
  static const std::vector<KernelRow> rows = PriceKernelRows();
  return rows;
}

const KernelRow& Row(std::string_view id) {
  for (const KernelRow& row : PricedRows())
    if (row.row->id == id) return row;
  ADD_FAILURE() << "no row " << id;
  return PricedRows()[0];
}

TEST(KernelRows, EveryMeasurementLiesInTheRangeOfItsPrice) {
  for (const KernelRow& row : PricedRows()) {
    SCOPED_TRACE(row.row->id);
    EXPECT_TRUE(row.failure.empty()) << row.failure;
    EXPECT_TRUE(row.passes) << row.scheduled_cycles << " " << row.measured_cycles << " "
                            << row.as_written_cycles;
    EXPECT_LT(row.scheduled_cycles, row.as_written_cycles);
    EXPECT_GT(row.scheduled, row.as_written);  // rates, the other way round
    EXPECT_NEAR(row.scheduled * row.scheduled_cycles, row.row->measured * row.measured_cycles,
                1e-6 * row.scheduled * row.scheduled_cycles);
  }
}

// One iteration of N-body: 4 loads, 3 differences, 3 multiply-adds, estimate and interpolation, 3
// products, 3 multiply-adds, counter, hint, branch. 13 of the even pipe and the counter bound it;
// written one after the other, each of ten dependent steps waits for the one before.
TEST(KernelRows, NBodyIsBoundByItsEvenPipeAndByItsChain) {
  const KernelRow& row = Row("K1");
  EXPECT_EQ(row.iterations, kBodies / 4.0);
  EXPECT_GE(row.scheduled_cycles / row.iterations, 13.0);
  EXPECT_LE(row.scheduled_cycles / row.iterations, 16.0);
  EXPECT_NEAR(row.measured_cycles / row.iterations, 35.0 * 0.92, 0.5);
  EXPECT_GE(row.as_written_cycles / row.iterations, 65.0);
  EXPECT_LE(row.as_written_cycles / row.iterations, 80.0);
}

// 4,096 multiply-adds of 16 iterations, the even pipe; and nothing can be faster.
TEST(KernelRows, TheMatrixProductNearlyReachesThePeak) {
  const KernelRow& row = Row("C13");
  EXPECT_EQ(row.iterations, 1024.0);
  EXPECT_GE(row.scheduled_cycles / row.iterations, 64.0);
  EXPECT_LE(row.scheduled_cycles / row.iterations, 68.0);
}

// The ends follow the numbers of the core, the measurement does not.
TEST(KernelRows, PlantedLatenciesMoveTheEnds) {
  PlatformParameters slow;
  slow.cell.spu.Of(SpuClass::kFp6).latency_cycles = 12;
  for (const KernelRowDefinition& row : KernelRows()) {
    const KernelRow usual = Row(row.id), late = PriceKernelRow(row, slow);
    // A block of sixteen sums hides it.
    EXPECT_GE(late.as_written_cycles, (row.id == "C13" ? 1.0 : 1.1) * usual.as_written_cycles)
        << row.id;
    EXPECT_EQ(late.measured_cycles, usual.measured_cycles) << row.id;
  }
}

TEST(KernelRows, ThePlaceIsTheMeanOfWhatACompilerMadeAndSaysHowFarItSpreads) {
  const MeasuredPlace place = PlaceOf(PricedRows());
  EXPECT_EQ(place.rows, 2u);
  EXPECT_NEAR(place.mean, 0.5 * (Row("K1").place + Row("K2").place), 1e-12);
  EXPECT_LT(place.least, place.mean);
  EXPECT_LT(place.mean, place.most);
  EXPECT_GT(place.mean, 0.0);
  EXPECT_LT(place.mean, 1.0);
  EXPECT_EQ(MeasuredCodePlace().mean, place.mean);
  KernelRow failed;
  failed.failure = "why";
  EXPECT_EQ(PlaceOf({&failed, 1}).rows, 0u);
}

// The kernels are the algorithms they are named after: what they compute is right.
TEST(MeasuredKernels, TheFftOfAnImpulseIsFlatAndOfAConstantAnImpulse) {
  using V = ArrayVec<4>;
  const auto tables = std::make_unique<FftTables>();
  for (uint32_t i = 0; i < kFftPoints; ++i)
    for (uint32_t bit = 1; bit < kFftPoints; bit *= 2)
      if (i & bit) tables->reversed[i] |= kFftPoints / 2 / bit;
  for (uint32_t i = 0; i < kFftPoints / 2; ++i) {
    tables->cosine[i] = float(std::cos(-2.0 * M_PI * i / kFftPoints));
    tables->sine[i] = float(std::sin(-2.0 * M_PI * i / kFftPoints));
  }
  const auto data = std::make_unique<FftData>();
  for (int l = 0; l < 4; ++l) {
    data->re[0][l] = float(l + 1);
    data->re[1][l] = 1.0f;
  }
  FftReversal<V>(*tables, *data);
  FftButterflies<V>(*tables, *data);
  for (uint32_t k = 0; k < kFftPoints; ++k)
    for (int l = 0; l < 4; ++l) {
      const double angle = -2.0 * M_PI * k / kFftPoints;
      EXPECT_NEAR(data->re[k][l], l + 1 + std::cos(angle), 1e-5);
      EXPECT_NEAR(data->im[k][l], std::sin(angle), 1e-5);
    }
}

TEST(MeasuredKernels, TheMatrixProductIsSubtracted) {
  using V = ArrayVec<4>;
  const auto m = std::make_unique<Matrix[]>(3);
  for (uint32_t i = 0; i < kMatrixSide; ++i)
    for (uint32_t j = 0; j < kMatrixSide; ++j) {
      m[0].row[i][j] = float((i * 7 + j) % 5);
      m[1].row[i][j] = float((i + 3 * j) % 7);
      m[2].row[i][j] = float(i + j);
    }
  SubtractProduct<V>(m[0], m[1], m[2]);
  for (uint32_t i = 0; i < kMatrixSide; i += 9)
    for (uint32_t j = 0; j < kMatrixSide; j += 5) {
      float expected = float(i + j);
      for (uint32_t k = 0; k < kMatrixSide; ++k) expected -= m[0].row[i][k] * m[1].row[k][j];
      EXPECT_EQ(m[2].row[i][j], expected);
    }
}

TEST(MeasuredKernels, NewtonStepsAndThePullComeOutRight) {
  using V = ArrayVec<4>;
  V x[kNewtonChains];
  for (V& chain : x) chain = V(2.0f);
  NewtonIterations(x, 1);
  float expected = 2.0f;
  for (uint32_t n = 0; n < kNewtonSteps; ++n) {
    const double root = 1.0 / std::sqrt(double(expected));
    expected = float(1.0 / expected + 0.5 * root * (1.0 - 0.5 * root * root));
  }
  for (const V& chain : x) EXPECT_NEAR(chain[3], expected, 1e-3);

  const auto bodies = std::make_unique<Bodies>();
  bodies->x[17] = 2.0f;
  bodies->mass[17] = 8.0f;
  Pulls pull;
  PullOnBody<V>(*bodies, 0, pull);
  EXPECT_NEAR(pull.lanes[0][17 % 4], 8.0 * 2.0 / 8.0, 1e-3);
  EXPECT_EQ(pull.lanes[1][17 % 4], 0.0f);
}

// Any kernel on the vector type, with what only a console has, on every core.
TEST(RecordKernel, PricesAKernelOfOnesOwn) {
  struct alignas(128) {
    float in[64], out[64], factor[4];
  } rows = {};
  const auto run = [&] {
    using V = RecordingVec;
    for (int i = 0; i < 64; i += 4) {
      const V f = LoadSplat<V>(rows.factor, 1u);
      const V x = V::Load(rows.in + i);
      (ReciprocalEstimate(x) * f + ReciprocalRootEstimate(x)).Store(rows.out + i);
    }
  };
  const Trace trace = RecordKernel({{&rows, sizeof rows}}, run).OrThrow();
  for (const CoreKind kind : {CoreKind::kSpu, CoreKind::kPpe, CoreKind::kXenon}) {
    const KernelCost cost = PriceTrace(trace, 16, MakePricedCore(kind, {}), {}).OrThrow();
    EXPECT_GT(cost.scheduled.cycles_per_iteration, 1.0);
    EXPECT_GT(cost.as_written.cycles_per_iteration, cost.scheduled.cycles_per_iteration);
  }
  const KernelBlock too_much = {&rows, uint64_t{3} << 30};
  EXPECT_NE(RecordKernel({too_much}, [] {}).error().find("2 GiB"), std::string::npos);
}

}  // namespace
}  // namespace pelt
