// The texture that shells are cut from.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/groom/layer_params.hpp"

namespace pelt {
namespace {

LayerParams Params(float density, float least, uint32_t side = 512, uint32_t seed = 1) {
  LayerParams params;
  params.fur_density = density;
  params.fur_min_length = least;
  params.fur_texture_size = side;
  params.fur_seed = seed;
  return params;
}

double Filled(const std::vector<uint8_t>& texels) {
  return 1.0 - double(std::count(texels.begin(), texels.end(), uint8_t(0))) / double(texels.size());
}

// Thrown with replacement: 1 - exp(-density), and not the density.
TEST(FurTexture, IsFilledAsByThrowing) {
  const std::pair<float, double> wanted[] = {
      {0.0f, 0.0}, {.2f, .18127}, {.5f, .39347}, {.8f, .55067}, {3.0f, .95021}};
  for (const auto& [density, share] : wanted)
    for (uint32_t seed = 1; seed < 4; ++seed)
      EXPECT_NEAR(Filled(MakeFurTexture(Params(density, 0.2f, 512, seed))), share, 0.003)
          << density;
}

TEST(FurTexture, HasHairsOfEveryLengthFromTheLeastOn) {
  for (const float least : {0.0f, 0.2f, 0.75f, 1.0f}) {
    const std::vector<uint8_t> texels = MakeFurTexture(Params(1.0f, least));
    const uint32_t low = std::max(1u, uint32_t(255.0f * least + 0.5f));
    std::vector<uint32_t> count(256, 0);
    for (const uint8_t texel : texels) ++count[texel];
    for (uint32_t value = 1; value < low; ++value) EXPECT_EQ(count[value], 0u) << value;
    const double each = Filled(texels) * double(texels.size()) / double(256 - low);
    for (uint32_t value = low; value < 256; ++value)
      EXPECT_NEAR(double(count[value]), each, 6.0 * std::sqrt(each)) << value;
  }
}

TEST(FurTexture, DependsOnItsNumbersAlone) {
  const std::vector<uint8_t> texels = MakeFurTexture(Params(0.5f, 0.2f, 64));
  EXPECT_EQ(texels.size(), 64u * 64u);
  EXPECT_EQ(MakeFurTexture(Params(0.5f, 0.2f, 64)), texels);
  EXPECT_NE(MakeFurTexture(Params(0.5f, 0.2f, 64, 2)), texels);
  // The same bytes on every machine; and as a few lines of Python throw them.
  uint64_t hash = 14695981039346656037u;
  for (const uint8_t texel : texels) hash = (hash ^ texel) * 1099511628211u;
  EXPECT_EQ(hash, 17174383772482024064u);
}

}  // namespace
}  // namespace pelt
