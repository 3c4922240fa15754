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
