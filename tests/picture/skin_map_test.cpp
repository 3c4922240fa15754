// The skin's darkening as a texture: by the strands' own area, without a step at seams, and none where it is bald.
#include "bench/picture/skin_map.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "tests/groom/torus_character.hpp"

namespace pelt {
namespace {

constexpr uint32_t kSide = 96;

struct Coat {
  Character torus = test::MakeTorus();
  RestGeometry rest = ComputeRestGeometry(torus, 1.0f);
  FurSetup setup;

  Coat(float width, float density = 20000.0f) {
    setup.path = "coat.toml";
    LayerSetup layer;
    layer.name = "coat";
    layer.density = density;
    layer.length = 0.03f;
    layer.width = width;
    setup.layers = {layer};
  }
  Groom Bake() const { return BakeGroom(torus, rest, setup, 1.0f); }
  std::vector<uint8_t> Map(const Groom& groom) const {
    std::vector<std::string> notes;
    return MakeSkinMap(torus, setup, groom, kSide, notes);
  }
};

double MeanOfColumn(const std::vector<uint8_t>& map, uint32_t x) {
  double sum = 0.0;
  for (uint32_t y = 0; y < kSide; ++y) sum += map[y * kSide + x];
  return sum / kSide;
}

// Of strands that are thrown on the skin, 1 - exp(-their area over its area) is covered, and has 22 % of the light.
TEST(SkinMap, IsAsDarkAsTheStrandsAreDense) {
  for (const float width : {0.0005f, 0.002f, 0.004f}) {
    const Coat coat(width);
    const Groom groom = coat.Bake();
    const double hair = double(groom.layers[0].strand_count) * 0.03 * double(width);
    const double covered = 1.0 - std::exp(-hair / test::AreaOf(coat.torus, coat.rest));
    const std::vector<uint8_t> map = coat.Map(groom);
    const double mean = std::accumulate(map.begin(), map.end(), 0.0) / (kSide * kSide);
    EXPECT_NEAR(mean, 255.0 * (1.0 - 0.78 * covered), 5.0) << width;
    EXPECT_NEAR(MeanOfColumn(map, 0), mean, 8.0) << "the ring's seam";
    EXPECT_NEAR(MeanOfColumn(map, kSide - 1), mean, 8.0);
  }
}

TEST(SkinMap, IsWhiteWhereNothingGrows) {
  Coat coat(0.002f);
  coat.setup.layers[0].mask.bald =
      test::MakeMap([](float u, float) { return u < 0.5f ? 0.0f : 1.0f; });
  const std::vector<uint8_t> map = coat.Map(coat.Bake());
  for (uint32_t y = 0; y < kSide; ++y) {
    EXPECT_LT(map[y * kSide + kSide / 4], 200) << y;
    EXPECT_EQ(map[y * kSide + kSide * 3 / 4], 255) << y;
  }
}

}  // namespace
}  // namespace pelt
