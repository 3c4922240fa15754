// What keys make of strands' traits, in chunks and patches.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "tests/groom/groom_validator.hpp"
#include "tests/groom/torus_character.hpp"

namespace pelt::test {
namespace {

LayerSetup MakeCoat(float density) {
  LayerSetup layer;
  layer.name = "coat";
  layer.density = density;
  return layer;
}

// What keys say of all strands; a map that is black everywhere stands for its `low`.
TEST(StrandTraits, AreWhatTheirKeysSay) {
  LayerSetup layer = MakeCoat(4000.0f);
  layer.params.solver = Solver::kPbd;
  layer.params.velocity_damping = 4.0f;
  layer.stiffness_scale = Attribute(2.0f);
  layer.damping_scale = Attribute(0.5f);
  layer.clump_scale = Attribute(0.25f);
  layer.weight_scale.map.map = std::make_shared<const ControlMap>(ControlMap{1, 1, {0, 0, 0, 0}});
  layer.weight_scale.map.low = 3.0f;
  layer.angle_limit = Attribute(60.0f);
  layer.hardness_profile = {1.0f, 0.5f, 0.0f};
  for (const ChainKind chain : {ChainKind::kVertex, ChainKind::kStrand}) {
    layer.params.chain = chain;
    const Groom groom = BakeTorus(layer);
    ExpectValidGroom(groom);
    EXPECT_TRUE(groom.layers[0].params.traits);
    ASSERT_FALSE(groom.strand_traits.empty());
    ASSERT_EQ(groom.vertex_traits.empty(), chain == ChainKind::kStrand);
    for (const auto* blocks : {&groom.vertex_traits, &groom.strand_traits})
      for (const TraitBlock& own : *blocks)
        for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) {
          const float wanted[] = {2.0f, 1.0f, 0.0f, 2.0f};  // behind the last link: none reads it
          for (uint32_t i = 0; i < kTraitLinks; ++i) EXPECT_EQ(own.stiffness[i][lane], wanted[i]);
          EXPECT_EQ(own.drag[lane], -2.0f);
          EXPECT_EQ(own.clump[lane], 0.25f);
          EXPECT_EQ(own.weight[lane], 3.0f);
          EXPECT_EQ(own.bounce[lane], 1.0f);
          EXPECT_NEAR(own.least_cosine[lane], 0.5f, 1e-6f);
        }
  }
  EXPECT_FALSE(BakeTorus(MakeCoat(4000.0f)).layers[0].params.traits);
}

// Strands differ, and their vertices have the mean of those around them.
TEST(StrandTraits, VaryByStrand) {
  LayerSetup layer = MakeCoat(4000.0f);
  layer.bounce_scale.randomise = 0.5f;
  const Groom groom = BakeTorus(layer);
  ExpectValidGroom(groom);
  const auto spread = [](const std::vector<TraitBlock>& blocks) {
    float low = 10.0f, high = 0.0f;
    for (const TraitBlock& own : blocks)
      for (const float value : own.bounce) low = std::min(low, value), high = std::max(high, value);
    return std::pair(low, high);
  };
  const auto [least, most] = spread(groom.strand_traits);
  EXPECT_GE(least, 0.5f);
  EXPECT_LE(most, 1.5f);
  EXPECT_GT(most - least, 0.9f);
  const auto [lowest, highest] = spread(groom.vertex_traits);
  EXPECT_GT(lowest, least);
  EXPECT_LT(highest, most);
  EXPECT_GT(highest - lowest, 0.1f);
}

}  // namespace
}  // namespace pelt::test
