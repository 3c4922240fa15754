// Attributes: value, map, randomise and range of each, and the rest shape.
#include "core/groom/attributes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/groom/torus_character.hpp"

namespace pelt::test {
namespace {

struct Fixture : CoatedTorus {
  Fixture() {
    layer.name = "coat";
    layer.density = float(2000.0 / AreaOf(character, rest));
    Scatter();
  }
};

Attribute Varying(float value, float randomise) {
  Attribute attribute(value);
  attribute.randomise = randomise;
  return attribute;
}

float WidthOf(const GroomedStrand& strand) { return strand.stored[PlaceOf(&LayerSetup::width)]; }

TEST(RestShape, SegmentsAreEqualAndAddUpToTheLength) {
  for (const uint32_t points : {4u, 5u}) {
    for (const double curl : {0.0, 3.0, 40.0}) {
      const RestShape shape = MakeRestShape({0.6, 0.0, 0.8}, 0.09, curl, 25.0, points);
      glm::dvec3 last(0.0);
      for (uint32_t i = 0; i + 1 < points; ++i) {
        EXPECT_NEAR(glm::length(shape.offset[i] - last), 0.09 / (points - 1), 1e-15);
        last = shape.offset[i];
      }
    }
  }
}

TEST(RestShape, WithoutCurlIsStraightAndWithItBendsTowardsTheSurface) {
  const glm::dvec3 direction(0.6, 0.0, 0.8);
  const RestShape straight = MakeRestShape(direction, 0.1, 0.0, 7.0, 5);
  EXPECT_NEAR(glm::length(straight.offset[3] - direction * 0.1), 0.0, 1e-15);
  const double curl = 8.0;  // radians per metre: 0.2 per segment
  const RestShape bent = MakeRestShape(direction, 0.1, curl, 0.0, 5);
  double angle = std::atan2(0.8, 0.6);
  glm::dvec3 end(0.0);
  for (int i = 0; i < 4; ++i) {
    end += glm::dvec3(std::cos(angle), 0.0, std::sin(angle)) * 0.025;
    EXPECT_NEAR(glm::length(bent.offset[i] - end), 0.0, 1e-14) << i;
    angle -= curl * 0.025;
  }
  EXPECT_LT(bent.offset[3].z, straight.offset[3].z);
}

TEST(RestShape, TwistTurnsThePlaneOfTheCurl) {
  const RestShape shape = MakeRestShape({1.0, 0.0, 0.0}, 0.1, 10.0, 0.0, 5);
  EXPECT_NEAR(shape.offset[3].y, 0.0, 1e-15);
  const RestShape twisted = MakeRestShape({1.0, 0.0, 0.0}, 0.1, 10.0, 20.0, 5);
  EXPECT_GT(std::abs(twisted.offset[3].y), 1e-3);
  // Curl bends as much per segment in any plane.
  glm::dvec3 before = twisted.offset[0];
  for (int i = 1; i < 4; ++i) {
    const glm::dvec3 step = twisted.offset[i] - twisted.offset[i - 1];
    EXPECT_NEAR(DegreesBetween(before, step), 0.25 * 180 / M_PI, 1e-9);
    before = step;
  }
}

TEST(RestShape, CurlFollowsItsProfileAlongTheStrand) {
  const RestShape bent =
      MakeRestShape({0.6, 0.0, 0.8}, 0.1, 8.0, 0.0, 5, glm::dvec3(0.5, 1.0, 2.0));
  double angle = std::atan2(0.8, 0.6);
  glm::dvec3 end(0.0);
  for (int i = 0; i < 4; ++i) {
    const double t = i / 4.0;
    if (i > 0) angle -= 8.0 * 0.025 * (0.5 + t + 2.0 * t * t);
    end += glm::dvec3(std::cos(angle), 0.0, std::sin(angle)) * 0.025;
    EXPECT_NEAR(glm::length(bent.offset[i] - end), 0.0, 1e-13) << i;
  }
}

TEST(Attributes, TheTipsOffsetRaisesTheTipAndTheStrandGrows) {
  Fixture f;
  f.layer.length = Attribute(0.05f);
  f.layer.elevation = Attribute(30.0f);
  f.layer.offset_tip = Attribute(0.02f);
  const glm::dvec3 tip(0.05 * std::sqrt(0.75), 0.0, 0.05 * 0.5 + 0.02);
  for (const GroomedStrand& s : f.Groom()) {
    for (int i = 0; i < 3; ++i)
      EXPECT_NEAR(glm::length(s.rest.offset[i] - tip * ((i + 1) / 3.0)), 0.0, 1e-7);
    EXPECT_NEAR(s.length, glm::length(tip), 1e-7);
  }
  f.layer.offset_tip = Attribute(-0.1f);  // it lies flat, and no deeper
  for (const GroomedStrand& s : f.Groom()) {
    for (const glm::dvec3& at : {s.rest.offset[0], s.rest.offset[1], s.rest.offset[2]}) {
      EXPECT_GT(at.z, 0.0);
      EXPECT_LT(at.z, 0.001);
    }
    EXPECT_NEAR(s.length, tip.x, 1e-4);
  }
}

TEST(Attributes, DirectionIsAVectorWithARangeOfEachAxis) {
  Fixture f;
  f.layer.direction_vector = glm::vec3(0.3f, 0.4f, 1.2f);
  for (const GroomedStrand& s : f.Groom())
    EXPECT_LT(DegreesBetween(s.rest.offset[0], {0.3, 0.4, 1.2}), 1e-4);
  f.layer.direction_vector = glm::vec3(0.0f, 0.0f, 2.0f);
  f.layer.direction_range = glm::vec3(0.1f, 0.2f, 0.0f);
  const auto slopes = [&] {
    std::vector<glm::dvec2> found;
    for (const GroomedStrand& s : f.Groom())
      found.push_back(glm::dvec2(s.rest.offset[0]) / s.rest.offset[0].z);
    return found;
  };
  const std::vector<glm::dvec2> both = slopes();
  glm::dvec2 most(0.0);
  double product = 0.0;
  for (const glm::dvec2& slope : both) {
    most = glm::max(most, glm::abs(slope));
    product += slope.x * slope.y;
  }
  EXPECT_LE(most.x, 0.1 + 1e-8);
  EXPECT_LE(most.y, 0.2 + 1e-8);
  EXPECT_GT(most.x, 0.095);
  EXPECT_GT(most.y, 0.19);
  EXPECT_NEAR(product / double(both.size()), 0.0, 0.001) << "each axis has a number of its own";
  f.layer.direction_range.y = 0.0f;
  const std::vector<glm::dvec2> one = slopes();
  for (size_t i = 0; i < one.size(); ++i) {
    EXPECT_NEAR(one[i].x, both[i].x, 1e-12);
    EXPECT_NEAR(one[i].y, 0.0, 1e-12);
  }
}

TEST(Attributes, RandomiseStaysInsideItsBoundsAndUsesThem) {
  Fixture f;
  f.layer.length = Varying(0.05f, 0.4f);
  f.layer.width = Varying(0.001f, 0.2f);
  float least = 1.0f, most = 0.0f;
  double sum = 0.0;
  for (const GroomedStrand& s : f.Groom()) {
    least = std::min(least, s.length);
    most = std::max(most, s.length);
    sum += s.length;
    EXPECT_GE(WidthOf(s), 0.0008f - 1e-7f);
    EXPECT_LE(WidthOf(s), 0.0012f + 1e-7f);
    EXPECT_NEAR(glm::length(s.rest.offset[0]) * 3.0, s.length, 1e-6);
  }
  EXPECT_GE(least, 0.03f - 1e-6f);
  EXPECT_LE(most, 0.07f + 1e-6f);
  EXPECT_LT(least, 0.0305f);
  EXPECT_GT(most, 0.0695f);
  EXPECT_NEAR(sum / double(f.points.size()), 0.05, 0.001);
}

TEST(Attributes, RangeClampsAndMapsScale) {
  Fixture f;
  f.layer.length = Varying(0.05f, 1.0f);
  f.layer.length.range = glm::vec2(0.045f, 0.06f);
  f.layer.strength.map = MakeMap([](float u, float) { return u < 0.5f ? 0.2f : 1.0f; }, 3);
  for (const GroomedStrand& s : f.Groom()) {
    EXPECT_GE(s.length, 0.045f);
    EXPECT_LE(s.length, 0.06f);
    const glm::vec2 uv = Interpolate(f.character.mesh.uv, f.character.mesh, s.place);
    if (uv.x > 0.02f && uv.x < 0.48f) {
      EXPECT_NEAR(s.strength, 0.2f, 0.01f);
    }
    if (uv.x > 0.52f && uv.x < 0.98f) {
      EXPECT_NEAR(s.strength, 1.0f, 1e-5f);
    }
  }
  f.layer.strength = Attribute(3.0f);
  f.layer.length = Attribute(0.0f);
  for (const GroomedStrand& s : f.Groom()) {
    EXPECT_EQ(s.strength, 1.0f);
    EXPECT_EQ(s.length, kShortestStrand);
  }
}

// Red is twice the value, black none, where a setup says so.
TEST(Attributes, AMapsEndsStandForWhatTheSetupSays) {
  Fixture f;
  f.layer.length = Attribute(0.05f);
  f.layer.length.map = MakeMap([](float u, float) { return u < 0.5f ? 0.0f : 1.0f; });
  f.layer.length.map.low = 0.5f;
  f.layer.length.map.high = 2.0f;
  for (const GroomedStrand& s : f.Groom()) {
    const glm::vec2 uv = Interpolate(f.character.mesh.uv, f.character.mesh, s.place);
    if (uv.x > 0.02f && uv.x < 0.48f) {
      EXPECT_NEAR(s.length, 0.025f, 1e-6f);
    }
    if (uv.x > 0.52f && uv.x < 0.98f) {
      EXPECT_NEAR(s.length, 0.1f, 1e-6f);
    }
  }
}

TEST(Attributes, ChangingOneMovesNoOther) {
  Fixture f;
  f.layer.length = Varying(0.05f, 0.5f);
  f.layer.width = Varying(0.001f, 0.5f);
  const auto before = f.Groom();
  f.layer.length.randomise = 0.0f;
  f.layer.frizz = Attribute(20.0f);
  const auto after = f.Groom();
  for (size_t i = 0; i < before.size(); ++i) EXPECT_EQ(WidthOf(before[i]), WidthOf(after[i]));
}

TEST(Attributes, FrizzTiltsByAtMostItsAngleAndDirectionTurns) {
  Fixture f;
  f.layer.elevation = Attribute(60.0f);
  f.layer.frizz = Attribute(15.0f);
  const glm::dvec3 combed(0.5, 0.0, std::sqrt(0.75));
  double most = 0.0, sum = 0.0;
  for (const GroomedStrand& s : f.Groom()) {
    const double tilt = DegreesBetween(s.rest.offset[0], combed);
    most = std::max(most, tilt);
    sum += tilt;
  }
  EXPECT_LE(most, 15.0 + 1e-6);
  EXPECT_GT(most, 14.5);
  EXPECT_NEAR(sum / double(f.points.size()), 10.0, 0.5);  // even over the disk: two thirds

  f.layer.frizz = Attribute(0.0f);
  f.layer.direction = Attribute(90.0f);
  for (const GroomedStrand& s : f.Groom()) {
    EXPECT_LT(DegreesBetween(s.rest.offset[0], {0.0, 0.5, std::sqrt(0.75)}), 1e-6);
  }
}

TEST(Attributes, NoStrandStartsIntoTheSkin) {
  Fixture f;
  f.layer.elevation = Attribute(-30.0f);
  f.layer.frizz = Attribute(80.0f);
  for (const GroomedStrand& s : f.Groom()) {
    EXPECT_GT(s.rest.offset[0].z, 0.03 * glm::length(s.rest.offset[0]));
  }
}

// One material of the torus is orange, of the other nothing is known.
TEST(Attributes, ColoursThatTheSetupDoesNotSayAreTheSurfaces) {
  Fixture f;
  f.character.mesh.looks.resize(2);
  f.character.mesh.looks[0] = {.stated = true, .base_colour = {1.0f, 0.215861f, 0.0f}};
  const LayerSetup plain;
  int orange = 0, others = 0;
  for (const GroomedStrand& s : f.Groom()) {
    if (f.character.mesh.triangle_material[s.place.triangle] == 0) {
      ++orange;
      EXPECT_EQ(s.tip_colour, 0xff0080ffu);
      EXPECT_EQ(s.base_colour & 255, 203u);  // 0.6 of it in linear light
    } else {
      ++others;
      EXPECT_EQ(s.tip_colour, plain.tip_colour | 0xff000000u);
      EXPECT_EQ(s.base_colour, plain.base_colour | 0xff000000u);
    }
  }
  EXPECT_GT(orange, 0);
  EXPECT_GT(others, 0);
  f.layer.tip_colour = 0xff123456u;
  for (const GroomedStrand& s : f.Groom()) EXPECT_EQ(s.tip_colour, 0xff123456u);
}

TEST(Attributes, ColoursFollowMapAndVariationAndKeepTheirAlpha) {
  Fixture f;
  f.layer.base_colour = 0x80ff6432;  // alpha 128, b 255, g 100, r 50
  f.layer.tip_colour = 0xffc8c8c8;
  f.layer.colour_map = MakeMap([](float, float) { return 0.5f; });
  for (const GroomedStrand& s : f.Groom()) {
    EXPECT_EQ(s.base_colour >> 24, 0x80u);
    EXPECT_NEAR(double(s.base_colour & 255), 25.0, 1.0);
    EXPECT_NEAR(double(s.base_colour >> 8 & 255), 50.0, 1.0);
    EXPECT_NEAR(double(s.base_colour >> 16 & 255), 128.0, 1.0);
  }
  // Each end has a map of its own besides.
  f.layer.tip_colour_map = MakeMap([](float, float) { return 0.5f; });
  for (const GroomedStrand& s : f.Groom()) {
    EXPECT_NEAR(double(s.base_colour & 255), 25.0, 1.0);
    EXPECT_NEAR(double(s.tip_colour & 255), 50.0, 1.0);
  }
  f.layer.base_colour_map = f.layer.tip_colour_map;
  f.layer.tip_colour_map = {};
  for (const GroomedStrand& s : f.Groom()) {
    EXPECT_NEAR(double(s.base_colour & 255), 12.5, 1.0);
    EXPECT_NEAR(double(s.tip_colour & 255), 100.0, 1.0);
  }
  f.layer.base_colour_map = f.layer.colour_map = {};
  f.layer.colour_variation = Attribute(0.25f);
  uint32_t least = 255, most = 0;
  for (const GroomedStrand& s : f.Groom()) {
    least = std::min(least, s.tip_colour & 255);
    most = std::max(most, s.tip_colour & 255);
  }
  EXPECT_NEAR(least, 150.0, 2.0);
  EXPECT_NEAR(most, 250.0, 2.0);
}

TEST(Attributes, FilmStripsAreAllUsed) {
  Fixture f;
  f.layer.film_strip_count = 3;
  uint32_t count[3] = {};
  for (const GroomedStrand& s : f.Groom()) {
    ASSERT_LT(s.film_strip, 3);
    ++count[s.film_strip];
  }
  for (const uint32_t c : count) EXPECT_NEAR(c, double(f.points.size()) / 3, 100.0);
}

// Each of the strips has its part of the map's range, and where two meet no third one grows.
TEST(Attributes, ATypeMapPicksTheFilmStrip) {
  Fixture f;
  f.layer.film_strip_count = 3;
  f.layer.type_map = MakeMap([](float u, float) { return u < 0.5f ? 0.2f : 0.9f; }, 1);
  const auto expect = [&](uint32_t left, uint32_t right) {
    uint32_t count[2] = {};
    for (const GroomedStrand& s : f.Groom()) {
      const float u = Interpolate(f.character.mesh.uv, f.character.mesh, s.place).x;
      const bool is_right = u - std::floor(u) >= 0.5f;
      EXPECT_EQ(s.film_strip, is_right ? right : left) << u;
      ++count[is_right];
    }
    EXPECT_GT(std::min(count[0], count[1]), 500u);
  };
  expect(0, 2);
  f.layer.type_map.low = 1.0f;
  f.layer.type_map.high = 0.0f;
  expect(2, 0);
}

TEST(Attributes, LiftVariesByVertexInsideItsRange) {
  Fixture f;
  f.layer.offset = Varying(0.01f, 0.5f);
  f.layer.offset.range = glm::vec2(0.006f, 1.0f);
  const AttributeMaker maker = f.Maker();
  float least = 1.0f, most = 0.0f;
  for (uint32_t v = 0; v < f.character.mesh.position.size(); ++v) {
    least = std::min(least, maker.LiftVertex(v));
    most = std::max(most, maker.LiftVertex(v));
  }
  EXPECT_EQ(least, 0.006f);
  EXPECT_GT(most, 0.0145f);
  EXPECT_LE(most, 0.015f);
}

}  // namespace
}  // namespace pelt::test
