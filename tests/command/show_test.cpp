// The setup to start from: it can be read and covers its character, for any names of materials.
#include <gtest/gtest.h>

#include <algorithm>

#include "bench/command/commands.hpp"
#include "bench/scenarios/scenarios.hpp"
#include "core/character/pose.hpp"
#include "core/error.hpp"
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
    for (const LayerSetup& layer : fur.setup.layers) {
      EXPECT_EQ(layer.mask.materials, std::vector<std::string>{layer.name});
      EXPECT_GT(layer.film_strip_count, 1u) << "cards";
      ASSERT_TRUE(layer.mask.away_from) << "both have eyes";
      EXPECT_EQ(layer.mask.away_from->materials, std::vector<std::string>{"eye"});
    }
    for (const LayerDensity& density : fur.densities) {
      EXPECT_LT(density.scatter.spacing_m, 0.5f * density.longest_m) << density.layer;
      EXPECT_FALSE(density.IsCut());
    }
    EXPECT_GT(CountStrands(fur.groom), 4000u);
    EXPECT_LT(CountStrands(fur.groom), 8800u);
    EXPECT_EQ(fur.setup.unit_scale, 1.0f);
  }
}

// What is written can be run, or nothing is.
TEST(Show, WhatIsFlatIsRefused) {
  Character character = LoadCharacter("builtin");
  character.skeleton.rest[0].scale = glm::vec3(1.0f, 0.0f, 0.0f);
  EXPECT_THROW(StartFrom(character), Error);
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

// The lines of a triangle lie where a map is read for its edges, and beyond an edge where its image goes on.
TEST(Show, UvTemplateIsWhereMapsAreRead) {
  Character character = LoadCharacter("builtin");
  Mesh& mesh = character.mesh;
  mesh.triangles.resize(1);
  const auto corner = mesh.triangles[0];
  for (const float turns : {0.0f, 1.0f}) {
    for (const Wrap wrap : {Wrap::kRepeat, Wrap::kMirror}) {
      mesh.looks[mesh.triangle_material[0]].wrap = {wrap, Wrap::kRepeat};
      mesh.uv[corner[0]] = {0.1f + turns, 0.2f};
      mesh.uv[corner[1]] = {0.3f + turns, 0.2f};
      mesh.uv[corner[2]] = {0.1f + turns, 0.9f};
      const UvTemplate made = DrawUvTemplate(character, SurfaceColour(character));
      ASSERT_EQ(made.rgb.size(), size_t(made.width) * made.height * 3);
      ControlMap lines{made.width, made.height, {}};
      uint8_t red = 0;
      for (size_t i = 0; i < made.rgb.size(); i += 3) {
        red = std::max(red, made.rgb[i]);
        lines.rgba.insert(lines.rgba.end(), 4, std::max(made.rgb[i + 1], made.rgb[i + 2]));
      }
      EXPECT_EQ(red, 0) << "a map's own channel";
      const auto at = [&](float u, float v) {
        return lines.Sample({u + turns, v}, 0, mesh.looks[mesh.triangle_material[0]].wrap);
      };
      for (const float share : {0.0f, 0.3f, 0.5f, 0.9f}) {
        EXPECT_GT(at(0.1f + 0.2f * share, 0.2f), 0.2f) << share << turns << int(wrap);
        EXPECT_GT(at(0.1f, 0.2f + 0.7f * share), 0.2f) << share << turns << int(wrap);
      }
      for (const glm::vec2 off : {glm::vec2(0.2f, 0.1f), {0.15f, 0.4f}, {0.5f, 0.5f}, {0.9f, 0.8f}})
        EXPECT_EQ(at(off.x, off.y), 0.0f) << off.x << turns << int(wrap);
    }
  }
  mesh.uv.clear();
  EXPECT_THROW(DrawUvTemplate(character, SurfaceColour(character)), Error);
}

}  // namespace
}  // namespace pelt
