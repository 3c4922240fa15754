// The setup to start from: it can be read, covers its character, and whatever materials are named.
#include <gtest/gtest.h>

#include "bench/scenarios/scenarios.hpp"
#include "bench/scenarios/starting_setup.hpp"
#include "core/character/pose.hpp"
#include "core/groom/bake.hpp"
#include "core/groom/fur_setup.hpp"

namespace pelt {
namespace {

struct StartedFur {
  FurSetup setup;
  Groom groom;
  std::vector<LayerDensity> densities;
};

StartedFur StartFrom(const Character& character, float unit_scale = 1.0f) {
  const RestGeometry rest = ComputeRestGeometry(character, unit_scale);
  StartedFur fur;
  fur.setup = ReadFurSetup(StartingSetup(character, rest, unit_scale), "start.toml", ".");
  fur.groom = BakeGroom(character, rest, fur.setup, unit_scale, nullptr, nullptr, &fur.densities);
  return fur;
}

uint64_t CountStrands(const Groom& groom) {
  uint64_t strands = 0;
  for (const GroomLayer& layer : groom.layers) strands += layer.strand_count;
  return strands;
}

TEST(Show, SetupsToStartFromCoverTheirCharacters) {
  for (const char* name : {"builtin", "scorpion"}) {
    const Character character = LoadCharacter(name);
    const StartedFur fur = StartFrom(character);
    size_t grown = 0;
    for (const MaterialLook& look : character.mesh.looks) grown += !look.bare;
    EXPECT_EQ(fur.setup.layers.size(), grown) << name;
    for (const LayerSetup& layer : fur.setup.layers)
      EXPECT_EQ(layer.mask.materials, std::vector<std::string>{layer.name});
    for (const LayerDensity& density : fur.densities) {
      EXPECT_LT(density.scatter.spacing_m, 0.5f * density.longest_m) << density.layer;
      EXPECT_FALSE(density.IsCut());
    }
    EXPECT_GT(CountStrands(fur.groom), 10000u);
    EXPECT_LT(CountStrands(fur.groom), 44000u);
    EXPECT_EQ(fur.setup.unit_scale, 1.0f);
  }
}

// As many strands on a mouse as on a mammoth.
TEST(Show, LengthsFollowTheSize) {
  const Character character = LoadCharacter("builtin");
  const uint64_t strands = CountStrands(StartFrom(character).groom);
  for (const float scale : {0.05f, 4.0f}) {
    const StartedFur fur = StartFrom(character, scale);
    EXPECT_NEAR(double(CountStrands(fur.groom)) / double(strands), 1.0, 0.1) << scale;
    EXPECT_EQ(fur.setup.unit_scale, scale);
  }
}

TEST(Show, MaterialsMayBeNamedAsTheyLike) {
  Character character = LoadCharacter("builtin");
  std::vector<std::string>& names = character.mesh.materials;
  const std::vector<std::string> before = names;
  names[0] = "a \"quoted\" \\ 'name' = [1] # é";
  const StartedFur quoted = StartFrom(character);
  EXPECT_EQ(quoted.setup.layers[0].name, names[0]);
  EXPECT_EQ(quoted.setup.layers.size(), before.size() - 1);
  // What a mask cannot name, or not by itself, gets one coat on all of it.
  for (const std::string& name :
       {before[2], std::string(), std::string("tab\there"), std::string("\xff")}) {
    names[0] = name;
    const StartedFur one = StartFrom(character);
    ASSERT_EQ(one.setup.layers.size(), 1u) << name;
    EXPECT_TRUE(one.setup.layers[0].mask.materials.empty());
    EXPECT_NEAR(double(CountStrands(one.groom)), double(CountStrands(quoted.groom)), 100.0);
  }
}

TEST(Show, SharesOfMaterialsAreTheWholeSurface) {
  const Character character = LoadCharacter("scorpion");
  const RestGeometry one = ComputeRestGeometry(character, 1.0f),
                     two = ComputeRestGeometry(character, 2.0f);
  uint64_t triangles = 0;
  double area = 0.0, doubled = 0.0;
  for (const MaterialShare& share : MeasureMaterials(character.mesh, one)) {
    triangles += share.triangles;
    area += share.area_m2;
  }
  for (const MaterialShare& share : MeasureMaterials(character.mesh, two)) doubled += share.area_m2;
  EXPECT_EQ(triangles, character.mesh.triangles.size());
  EXPECT_NEAR(doubled / area, 4.0, 1e-5);
}

}  // namespace
}  // namespace pelt
