// Chains of few links against a finer one: the error falls with the links, and is nothing where
// there is none.
#include "bench/accuracy/model_error.hpp"

#include <gtest/gtest.h>

#include "bench/accuracy/quantile.hpp"

namespace pelt::accuracy {
namespace {

TEST(ModelError, FallsWithTheLinksAndIsNothingForTheRodItself) {
  ModelErrorOptions options;
  options.links = {3, 4, 8, kRodLinks};
  options.presets = {kPresets[0], kPresets[2]};
  options.drawn.motions = 2;
  options.strands = 1;
  options.seconds = 2.0;
  const std::vector<ModelErrorRow> rows = MeasureModelError(options);
  ASSERT_EQ(rows.size(), 8u);
  for (size_t preset = 0; preset < 2; ++preset) {
    double median[4];
    for (size_t l = 0; l < 4; ++l) {
      const ModelErrorRow& row = rows[2 * l + preset];
      EXPECT_EQ(row.links, options.links[l]);
      EXPECT_EQ(row.preset, preset);
      ASSERT_EQ(row.errors.size(), 2u);
      median[l] = Quantile(row.errors, 0.5);
      std::printf("%2d links, %s: %.1f %% off the rod\n", row.links,
                  options.presets[preset].name.data(), 100.0 * median[l]);
    }
    EXPECT_LT(median[0], 0.8);
    EXPECT_GT(median[0], 0.03);
    EXPECT_LT(median[2], 0.6 * median[0]);
    EXPECT_EQ(median[3], 0.0);
  }
}

// By the solver a chain is as far off the rod as exactly, and what the solver itself gets wrong.
TEST(ModelError, OfTheSolverIsThatOfItsLinks) {
  ModelErrorOptions options;
  options.links = {3, 8};
  options.presets = {kPresets[2]};
  options.drawn.motions = 2;
  options.strands = 1;
  options.seconds = 2.0;
  options.isa = BestIsa();
  const std::vector<ModelErrorRow> rows = MeasureModelError(options);
  ASSERT_EQ(rows.size(), 8u);
  for (size_t l = 0; l < 2; ++l) {
    const double exactly = Quantile(rows[4 * l].errors, 0.5);
    EXPECT_FALSE(rows[4 * l].quality);
    for (size_t q = 1; q < 4; ++q) {
      const double moved = Quantile(rows[4 * l + q].errors, 0.5);
      std::printf("%d links, quality %zu: %.2f %% off the rod, exactly %.2f\n", rows[4 * l].links,
                  q - 1, 100.0 * moved, 100.0 * exactly);
      EXPECT_NEAR(moved, exactly, q == 1 ? 0.06 : 0.02);
    }
  }
}

TEST(ModelError, IsOfItsSeed) {
  ModelErrorOptions options;
  options.links = {3};
  options.presets = {kPresets[0]};
  options.drawn.motions = options.strands = 1;
  options.seconds = 1.0;
  const double first = MeasureModelError(options)[0].errors[0];
  EXPECT_EQ(MeasureModelError(options)[0].errors[0], first);
  options.drawn.seed += 1;
  EXPECT_NE(MeasureModelError(options)[0].errors[0], first);
}

}  // namespace
}  // namespace pelt::accuracy
