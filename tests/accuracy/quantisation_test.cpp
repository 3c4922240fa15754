// 16 bits where Pelt has floats: the formats themselves, and what they cost.
#include "bench/accuracy/quantisation.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "bench/accuracy/packing.hpp"
#include "core/kernels/frame_table.hpp"
#include "core/random.hpp"

namespace pelt::accuracy {
namespace {

TEST(Packing, HalfFloatsAreTheNearestOnes) {
  EXPECT_EQ(RoundHalf(0.0f), 0.0f);
  EXPECT_EQ(RoundHalf(1.0f + 0x1p-11f), 1.0f);  // ties to even
  EXPECT_EQ(RoundHalf(1.0f + 0x3p-11f), 1.0f + 0x1p-9f);
  EXPECT_EQ(RoundHalf(0x1.ffep-1f + 0x1p-12f), 1.0f);  // carries into the exponent
  EXPECT_EQ(RoundHalf(1.0f / 3.0f), 0x1.554p-2f);
  EXPECT_EQ(RoundHalf(-65519.0f), -65504.0f);
  EXPECT_EQ(RoundHalf(1e9f), 65504.0f);
  EXPECT_EQ(RoundHalf(0x1p-24f), 0x1p-24f);  // the least
  EXPECT_EQ(RoundHalf(0x1p-25f), 0.0f);
  EXPECT_EQ(RoundHalf(-0x1.8p-24f), -0x1p-23f);
  Random random(1);
  for (int i = 0; i < 10000; ++i) {
    const float a = float(random.Uniform(-1.0, 1.0) * std::exp2(random.Uniform(-14.0, 15.0)));
    const float half = RoundHalf(a);
    EXPECT_LE(std::abs(half - a), std::max(std::abs(a), 0x1p-14f) * 0x1p-11f) << a;
    EXPECT_EQ(RoundHalf(half), half);
  }
}

TEST(Packing, SixteenBitsOfARange) {
  for (const float a : {-1.0f, 0.0f, 1.0f}) EXPECT_EQ(RoundSigned16(a), a);
  EXPECT_EQ(RoundSigned16(2.0f), 1.0f);
  EXPECT_NEAR(RoundSigned16(0.3f), 0.3f, 0.51 / 32767.0);
  EXPECT_NE(RoundSigned16(0.3f), 0.3f);
  EXPECT_EQ(RoundWithin16(7.0, -1.0, 3.0), 3.0);
  EXPECT_NEAR(RoundWithin16(0.123, -1.0, 3.0), 0.123, 2.01 / 65535.0);
}

TEST(Quantisation, CostsWhatTheFormatsSay) {
  QuantisationOptions options;
  options.drawn.motions = 2;
  options.strands = 2;
  const std::vector<QuantisationRow> rows = MeasureQuantisation(options, BestIsa());
  ASSERT_EQ(rows.size(), 9u);
  for (const QuantisationRow& row : rows) {
    std::printf("%-50s %3d bytes: %.2e mm (worst %.2e), %.1e of the length, %.2e %%\n",
                row.what.c_str(), row.bytes, 1e3 * row.rms_m, 1e3 * row.worst_m, row.of_length,
                100.0 * row.of_secondary);
    EXPECT_GT(row.of_length, 0.0) << row.what;
  }
  const QuantisationRow &all = rows[0], &history = rows[2], &floats = rows[3], &world = rows[4],
                        &middle = rows[5], &box = rows[6], &root = rows[7], &tangent = rows[8];
  EXPECT_EQ(all.bytes, 122);
  EXPECT_LT(all.of_secondary, 0.03);
  EXPECT_LT(history.of_secondary, all.of_secondary);
  EXPECT_LT(floats.worst_m, 1e-6);
  EXPECT_LT(middle.rms_m, world.rms_m);
  // Three axes, each half a step off at most.
  EXPECT_LT(box.worst_m, 1.8 * 1.0 / 65535.0);
  EXPECT_LT(root.rms_m, box.rms_m);
  EXPECT_LT(tangent.of_length, 1.8 * 0.5 / 32767.0);
}

}  // namespace
}  // namespace pelt::accuracy
