// Flow maps of planes whose groom is known, and what UVs may do to them.
#include "core/groom/flow_map.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/error.hpp"
#include "core/groom/groom_file.hpp"
#include "core/groom/height_field.hpp"
#include "core/random.hpp"
#include "tests/error_from.hpp"
#include "tests/groom/torus_character.hpp"

namespace pelt::test {
namespace {

constexpr uint32_t kSide = 32;

// A square metre on the ground, whose UVs are a function of x and z; a second one above it, where `floors` is 2.
struct Plane {
  Character character;
  RestGeometry rest;
  FurSetup setup;
  LayerSetup layer;

  explicit Plane(const std::function<glm::vec2(glm::vec2)>& uv_of, uint32_t floors = 1) {
    constexpr uint32_t kCells = 4;
    Mesh& mesh = character.mesh;
    mesh.materials = {"skin"};
    for (uint32_t floor = 0; floor < floors; ++floor) {
      const uint32_t first = uint32_t(rest.position.size());
      for (uint32_t j = 0; j <= kCells; ++j)
        for (uint32_t i = 0; i <= kCells; ++i) {
          const glm::vec2 at(float(i) / kCells, float(j) / kCells);
          rest.position.push_back({at.x, float(floor), at.y});
          rest.normal.push_back({0.0f, floor == 0 ? 1.0f : -1.0f, 0.0f});
          rest.tangent.push_back({1.0f, 0.0f, 0.0f});
          mesh.uv.push_back(uv_of(at));
        }
      for (uint32_t j = 0; j < kCells; ++j)
        for (uint32_t i = 0; i < kCells; ++i) {
          const uint32_t a = first + j * (kCells + 1) + i, b = a + kCells + 1;
          mesh.triangles.push_back({a, b, a + 1});
          mesh.triangles.push_back({a + 1, b, b + 1});
        }
    }
    mesh.position = rest.position;
    mesh.normal = rest.normal;
    mesh.triangle_material.assign(mesh.triangles.size(), 0);
    setup.path = "plane.toml";
    layer.name = "coat";
    layer.length = 0.05f;
  }

  // Everywhere the same way: towards +x turned to +z by this angle, and raised.
  void CombAll(double degrees, double raised) {
    const double a = degrees * M_PI / 180.0, e = raised * M_PI / 180.0;
    const glm::dvec3 d(std::cos(a) * std::cos(e), std::sin(e), std::sin(a) * std::cos(e));
    layer.comb = {{glm::vec3(0.5f, 0.0f, 0.5f), glm::vec3(d), 1e4f}};
  }
  FlowMap Make(uint32_t side = kSide) const {
    return MakeFlowMap(character, rest, setup, layer, side);
  }
};

glm::vec2 AsItIs(glm::vec2 at) { return at; }

glm::dvec2 LeanAt(const FlowMap& map, uint32_t x, uint32_t y) {
  const uint8_t* texel = &map.rgba[(size_t(y) * map.side + x) * 4];
  return (glm::dvec2(texel[0], texel[1]) - 128.0) / 127.0;
}

void ExpectLean(const FlowMap& map, const glm::dvec2& wanted) {
  for (uint32_t y = 0; y < map.side; ++y)
    for (uint32_t x = 0; x < map.side; ++x) {
      const glm::dvec2 lean = LeanAt(map, x, y);
      ASSERT_NEAR(lean.x, wanted.x, 0.6 / 127.0) << x << ' ' << y;
      ASSERT_NEAR(lean.y, wanted.y, 0.6 / 127.0) << x << ' ' << y;
    }
}

TEST(FlowMap, HasTheCombsDirectionAtEveryTexel) {
  Plane plane(AsItIs);
  for (const double raised : {5.0, 40.0, 90.0})
    for (double degrees = 0.0; degrees < 360.0; degrees += 30.0) {
      SCOPED_TRACE(degrees);
      plane.CombAll(degrees, raised);
      const FlowMap map = plane.Make();
      const double a = degrees * M_PI / 180.0, lies = std::cos(raised * M_PI / 180.0);
      ExpectLean(map, glm::dvec2(std::cos(a), std::sin(a)) * lies);
      EXPECT_EQ(map.covered, kSide * kSide);
      EXPECT_EQ(map.contested, 0u);
      EXPECT_EQ(map.sheets, 1u);
    }
}

TEST(FlowMap, GoesWithTheTextureThatIsTurnedMirroredOrStretched) {
  const struct {
    std::function<glm::vec2(glm::vec2)> uv;
    glm::dvec2 wanted;  // of hair along +x and +z alike
  } kCases[] = {{[](glm::vec2 at) { return glm::vec2(1.0f - at.x, at.y); }, {-1.0, 1.0}},
                {[](glm::vec2 at) { return glm::vec2(at.x, 1.0f - at.y); }, {1.0, -1.0}},
                {[](glm::vec2 at) { return glm::vec2(at.y, 1.0f - at.x); }, {1.0, -1.0}},
                {[](glm::vec2 at) { return glm::vec2(0.5f * at.x, at.y); }, {0.5, 1.0}},
                {[](glm::vec2 at) { return glm::vec2(7.25f + at.x, at.y - 3.5f); }, {1.0, 1.0}}};
  for (const auto& test : kCases) {
    Plane plane(test.uv);
    plane.CombAll(45.0, 20.0);
    const double lies = std::cos(20.0 * M_PI / 180.0);
    ExpectLean(plane.Make(), glm::normalize(test.wanted) * lies);
  }
}

TEST(FlowMap, LiesRoundTheTextureWhereUvsGoBeyondIt) {
  const auto make = [](glm::vec2 moved) {
    Plane plane([=](glm::vec2 at) { return at + moved; });
    plane.CombAll(30.0, 20.0);
    plane.layer.comb.push_back({{0.2f, 0.0f, 0.3f}, {-1.0f, 0.2f, 0.5f}, 0.6f});  // and not alike
    return plane.Make();
  };
  const FlowMap within = make({0.0f, 0.0f}), beyond = make({7.25f, -3.5f});
  EXPECT_EQ(beyond.covered, kSide * kSide);
  for (uint32_t y = 0; y < kSide; ++y)
    for (uint32_t x = 0; x < kSide; ++x)
      ASSERT_EQ(LeanAt(beyond, (x + kSide / 4) % kSide, (y + kSide / 2) % kSide),
                LeanAt(within, x, y))
          << x << ' ' << y;
  EXPECT_NE(LeanAt(within, 7, 10), LeanAt(within, 30, 30));
}

TEST(FlowMap, HasLengthsAndDensity) {
  Plane plane(AsItIs);
  plane.layer.length.map = MakeMap([](float u, float) { return 0.25f + 0.75f * u; });
  plane.layer.length.randomise = 0.5f;  // makes no difference
  plane.layer.mask.bald = MakeMap([](float, float v) { return v < 0.5f ? 0.0f : 1.0f; });
  const FlowMap map = plane.Make();
  EXPECT_NEAR(map.longest_m, 0.05f, 0.001f);
  for (uint32_t y = 0; y < kSide; ++y)
    for (uint32_t x = 1; x + 1 < kSide; ++x) {  // the map repeats, and is mixed at its edges
      const uint8_t* texel = &map.rgba[(y * kSide + x) * 4];
      const double length = 0.05 * (0.25 + 0.75 * (x + 0.5) / kSide);
      ASSERT_NEAR(texel[2] / 255.0, length / double(map.longest_m), 1.5 / 255.0) << x;
      if (y > 0 && y + 1 < kSide) {
        ASSERT_EQ(texel[3], y < kSide / 2 ? 255 : 0) << y;
      }
    }
}

TEST(FlowMap, FillsWhatNoTriangleHas) {
  Plane plane([](glm::vec2 at) { return 0.25f + 0.25f * at; });
  plane.CombAll(120.0, 30.0);
  const FlowMap map = plane.Make();
  EXPECT_EQ(map.covered, kSide * kSide / 16);
  const double lies = std::cos(30.0 * M_PI / 180.0);
  ExpectLean(map, glm::dvec2(-0.5, std::sqrt(0.75)) * lies);
  for (size_t i = 2; i < map.rgba.size(); i += 4) {
    ASSERT_EQ(map.rgba[i], 255);
    ASSERT_EQ(map.rgba[i + 1], 255);
  }
}

TEST(FlowMap, PartsAtOnePlaceOfTheTextureGetSheets) {
  Plane plane(AsItIs, 2);
  plane.CombAll(0.0, 0.0);
  const FlowMap map = plane.Make();
  ASSERT_EQ(map.sheets, 2u);
  EXPECT_EQ(map.rgba.size(), kSide * kSide * 4 * 2);
  EXPECT_EQ(map.contested, 0u);
  EXPECT_EQ(map.covered, 2 * kSide * kSide);
  const size_t half = plane.character.mesh.triangles.size() / 2;
  for (size_t t = 0; t < map.sheet.size(); ++t) EXPECT_EQ(map.sheet[t], t < half ? 0 : 1);
}

// Half of it lies on the other half: one island, which contests its own texels.
TEST(FlowMap, SaysWhatAFoldedPartLoses) {
  Plane plane([](glm::vec2 at) { return glm::vec2(std::abs(at.x - 0.5f), at.y); });
  const FlowMap map = plane.Make();
  EXPECT_EQ(map.sheets, 1u);
  EXPECT_EQ(map.covered, kSide * kSide / 2);
  EXPECT_GT(map.contested, map.covered * 8 / 10);
}

TEST(FlowMap, WhereTheLayerCannotGrowThereIsNoSheet) {
  Plane plane(AsItIs);
  plane.layer.mask.range = Mask::Range{{0.0f, 0.0f, 0.0f}, {0.4f, 1.0f, 1.0f}};
  const FlowMap map = plane.Make();
  const auto none = std::ranges::count(map.sheet, FlowMap::kNoSheet);
  EXPECT_EQ(size_t(none), map.sheet.size() / 2);
  EXPECT_EQ(map.covered, kSide * kSide / 2);
}

TEST(FlowMap, IsWholeAcrossTheSeamsOfATorus) {
  Plane settings(AsItIs);
  const Character torus = MakeTorus();
  settings.layer.comb_joint = "ring_2";
  const FlowMap map =
      MakeFlowMap(torus, ComputeRestGeometry(torus, 1.0f), settings.setup, settings.layer, 64);
  EXPECT_EQ(map.covered, 64u * 64u);
  EXPECT_EQ(map.contested, 0u);
  double inside = 0.0, across = 0.0;
  for (uint32_t y = 0; y < 64; ++y)
    for (uint32_t x = 0; x < 64; ++x) {
      const double step = glm::length(LeanAt(map, x, y) - LeanAt(map, (x + 1) % 64, y));
      (x == 63 ? across : inside) = std::max(x == 63 ? across : inside, step);
    }
  EXPECT_LE(across, 1.5 * inside);
}

TEST(FlowMap, TheSameBytesEverywhere) {
  Plane settings(AsItIs);
  const Character torus = MakeTorus();
  settings.layer.comb = {{{0.3f, 0.1f, 0.0f}, {0.2f, 0.3f, 1.0f}, 0.4f}};
  settings.layer.curl = 400.0f;
  const FlowMap map =
      MakeFlowMap(torus, ComputeRestGeometry(torus, 1.0f), settings.setup, settings.layer, 64);
  EXPECT_EQ(HashGroomBytes(std::as_bytes(std::span(map.rgba))), 13213997652517328466u);
}

TEST(FlowMap, RefusesWhatHasNoPlaceInTheTexture) {
  const auto reason = [](const Plane& plane, uint32_t side) {
    return ErrorFrom([&] { plane.Make(side); });
  };
  Plane plane(AsItIs);
  EXPECT_EQ(reason(plane, 0),
            "plane.toml: layer 'coat': flow map: 0 texels a side; 1 to 4096 are allowed");
  EXPECT_NE(reason(plane, 5000), "");
  plane.character.mesh.uv.clear();
  EXPECT_EQ(reason(plane, 16),
            "plane.toml: layer 'coat': flow map: the character has no texture coordinates");
  const Plane round([](glm::vec2 at) { return at * 20.0f; });
  EXPECT_NE(reason(round, 16).find("more than twice"), std::string::npos);
  const Plane many(AsItIs, kMostFlowSheets + 1);
  EXPECT_NE(reason(many, 16).find("more than 64 parts"), std::string::npos);
}

FlowMapSetup AsInput(const FlowMap& map) {
  FlowMapSetup input;
  input.picture.map =
      std::make_shared<const ControlMap>(ControlMap{map.side, map.side * map.sheets, map.rgba});
  input.blue = FlowBlue::kLength;
  input.longest = map.longest_m;
  return input;
}

// Of a layer that says nothing but the map: every byte but that of rounding twice.
void ExpectSameReadBack(const Character& character, const RestGeometry& rest, const FurSetup& setup,
                        const FlowMap& written) {
  LayerSetup layer;
  layer.name = "read";
  layer.azimuth = 77.0f;
  layer.length.value = 3.0f;
  layer.flow_map = AsInput(written);
  const FlowMap again = MakeFlowMap(character, rest, setup, layer, written.side);
  ASSERT_EQ(again.sheets, written.sheets);
  ASSERT_EQ(again.rgba.size(), written.rgba.size());
  EXPECT_NEAR(again.longest_m, written.longest_m, 1e-5f);
  for (size_t i = 0; i < again.rgba.size(); ++i)
    ASSERT_NEAR(again.rgba[i], written.rgba[i], 1) << i / 4 << ", " << i % 4;
}

TEST(FlowMap, IsReadBackAsItWasWritten) {
  Plane plane([](glm::vec2 at) { return glm::vec2(1.0f - 0.75f * at.y, at.x); }, 2);
  plane.CombAll(30.0, 20.0);
  plane.layer.comb.push_back({{0.2f, 0.0f, 0.3f}, {-1.0f, 0.2f, 0.5f}, 0.6f});
  plane.layer.length.map = MakeMap([](float u, float) { return 0.25f + 0.5f * u; });
  const FlowMap written = plane.Make();
  ASSERT_EQ(written.sheets, 2u);
  EXPECT_NE(LeanAt(written, 20, 7), LeanAt(written, 20, 7 + kSide)) << "the floors differ";
  ExpectSameReadBack(plane.character, plane.rest, plane.setup, written);
  const Character torus = MakeTorus();
  const RestGeometry rest = ComputeRestGeometry(torus, 1.0f);
  LayerSetup layer;
  layer.name = "coat";
  layer.comb_joint = "ring_2";
  layer.curl = 400.0f;  // is in the map: what reads it has none
  ExpectSameReadBack(torus, rest, plane.setup, MakeFlowMap(torus, rest, plane.setup, layer, 64));
}

// At any place, not at texels alone; and by strands too.
TEST(FlowMap, ReadBackGivesDirectionsAndLengthsToItsPrecision) {
  Plane plane([](glm::vec2 at) { return glm::vec2(at.x, 1.0f - 0.5f * at.y); });
  for (double degrees = 0.0; degrees < 360.0; degrees += 45.0) {
    plane.CombAll(degrees, 40.0);
    LayerSetup read;
    read.flow_map = AsInput(plane.Make());
    const AttributeMaker maker(plane.character, plane.rest, plane.setup, read);
    const glm::dvec3 drawn(plane.layer.comb[0].direction);
    for (uint32_t t = 0; t < plane.character.mesh.triangles.size(); ++t) {
      const SurfacePoint at{t, {0.27f, 0.41f, 0.32f}};
      const StrandLie lie = maker.MeanLie(at);
      EXPECT_LT(DegreesBetween(lie.towards, drawn), 2.0) << degrees;
      EXPECT_NEAR(lie.length, 0.05, 1e-5);
      const GroomedStrand strand = maker.Groom({at, {}, {0.0f, 1.0f, 0.0f}, 0.01f}, t);
      EXPECT_LT(DegreesBetween(strand.frame.FromFrame(strand.rest.offset[2]), drawn), 2.0);
    }
  }
}

// Red 204 and blue 230 are 76 and 102 of 127, along u and up; grey of 128 says nothing.
TEST(FlowMap, APaintedMapOfVectorsCombs) {
  Plane plane(AsItIs);
  const auto lie = [&](uint8_t red, uint8_t blue, FlowBlue means) {
    LayerSetup layer;
    layer.azimuth = 90.0f;
    layer.elevation = 30.0f;
    layer.flow_map.emplace();
    layer.flow_map->picture.map =
        std::make_shared<const ControlMap>(ControlMap{1, 1, {red, 128, blue, 255}});
    layer.flow_map->blue = means;
    return AttributeMaker(plane.character, plane.rest, plane.setup, layer)
        .MeanLie({3, {0.2f, 0.3f, 0.5f}})
        .towards;
  };
  const auto expect = [](const glm::dvec3& got, const glm::dvec3& wanted) {
    EXPECT_LT(DegreesBetween(got, wanted), 1e-3) << got.x << ' ' << got.y << ' ' << got.z;
  };
  expect(lie(204, 230, FlowBlue::kUp), {76.0, 102.0, 0.0});
  expect(lie(204, 0, FlowBlue::kUnused), {76.0, std::sqrt(127.0 * 127.0 - 76.0 * 76.0), 0.0});
  expect(lie(204, 0, FlowBlue::kUp), {std::sqrt(1.0 - 0.035 * 0.035), 0.035, 0.0});
  expect(lie(128, 128, FlowBlue::kUnused), {0.0, 1.0, 0.0});
  expect(lie(128, 128, FlowBlue::kUp), {0.0, 0.5, -std::sqrt(0.75)});  // azimuth and elevation
}

TEST(FlowMap, RefusesAMapThatIsNotOfThisLayer) {
  Plane plane(AsItIs);
  plane.layer.flow_map = AsInput(Plane(AsItIs, 2).Make());
  EXPECT_EQ(ErrorFrom([&] { plane.Make(); }),
            "plane.toml: layer 'coat': key 'flow_map': has 2 sheets, where this layer's texture "
            "coordinates make 1");
  plane.character.mesh.uv.clear();
  EXPECT_NE(ErrorFrom([&] {
              AttributeMaker(plane.character, plane.rest, plane.setup, plane.layer);
            }).find("key 'flow_map': asks for a map over the surface"),
            std::string::npos);
}

TEST(SkinTexels, AStencilHasTheDensestLayerOfEachTexel) {
  Plane plane(AsItIs);
  LayerSetup bald = plane.layer, even = plane.layer, off = plane.layer;
  bald.mask.bald = MakeMap([](float, float v) { return v < 0.5f ? 0.0f : 1.0f; });
  even.density_map = MakeMap([](float, float) { return 0.5f; });
  off.params.enabled = false;
  plane.setup.layers = {bald, even, off};
  const std::vector<uint8_t> map = MakeStencil(plane.character, plane.rest, plane.setup, kSide);
  ASSERT_EQ(map.size(), size_t(kSide) * kSide);
  for (uint32_t y = 1; y + 1 < kSide; ++y)
    for (uint32_t x = 0; x < kSide; ++x) {
      if (y + 1 == kSide / 2 || y == kSide / 2) continue;  // mixed
      ASSERT_EQ(map[y * kSide + x], y < kSide / 2 ? 255 : 128) << x << ' ' << y;
    }
}

// Half of it lies on the other half, whose triangles have the greater numbers, and half of the texture has none.
TEST(SkinTexels, TakeTheLeastOfSeveralAndTheNearestOfNone) {
  Plane plane([](glm::vec2 at) { return glm::vec2(std::abs(at.x - 0.5f), at.y); });
  const std::vector<uint8_t> map = MakeSkinTexels(
      plane.character.mesh, 16, "", [](const SurfacePoint& at) { return uint8_t(at.triangle); });
  for (uint32_t y = 0; y < 16; ++y) {
    const uint8_t* row = &map[y * 16];
    for (uint32_t x = 0; x < 8; ++x) EXPECT_EQ(row[x] / 2, int(4 * (y / 4) + (7 - x) / 4));
    EXPECT_EQ(row[8], row[7]);
    EXPECT_EQ(row[15], row[0]);
  }
}

// Each dot against every texel, over the edges too.
TEST(HeightField, IsATileOfDotsThatRepeats) {
  constexpr uint32_t kTile = 48, kDots = 6;
  std::vector<double> wanted(kTile * kTile, 0.0);
  for (uint32_t i = 0; i < kDots * kDots; ++i) {
    Random random(MixSeed(7, i));
    const double x = i % kDots + random.Uniform(), y = i / kDots + random.Uniform();
    const double height = random.Uniform(0.35, 1.0), radius = random.Uniform(0.6, 1.0);
    for (int turn = 0; turn < 9; ++turn)
      for (uint32_t texel = 0; texel < kTile * kTile; ++texel) {
        const double dx = (texel % kTile + 0.5) / 8.0 - x - kDots * (turn % 3 - 1.0);
        const double dy = (texel / kTile + 0.5) / 8.0 - y - kDots * (turn / 3 - 1.0);
        wanted[texel] =
            std::max(wanted[texel], height * (1.0 - (dx * dx + dy * dy) / radius / radius));
      }
  }
  const std::vector<uint8_t> heights = MakeHeightField(kTile, kDots, 7);
  ASSERT_EQ(heights.size(), wanted.size());
  for (size_t i = 0; i < heights.size(); ++i)
    ASSERT_NEAR(heights[i] / 255.0, wanted[i], 0.51 / 255.0);
  EXPECT_GT(*std::ranges::max_element(heights), 200);
}

TEST(HeightField, TheSameBytesEverywhereAndOthersFromAnotherSeed) {
  const std::vector<uint8_t> tile = MakeHairTile();
  EXPECT_EQ(HashGroomBytes(std::as_bytes(std::span(tile))), 5219300773531125870u);
  EXPECT_NE(MakeHeightField(64, 8, 1), MakeHeightField(64, 8, 2));
  EXPECT_THROW(MakeHeightField(0, 1, 1), Error);
  EXPECT_THROW(MakeHeightField(8, 9, 1), Error);
}

}  // namespace
}  // namespace pelt::test
