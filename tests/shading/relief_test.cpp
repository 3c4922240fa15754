// bench/shading/shaders/relief.glsl against values that were worked out apart from it, and against what it stands for.
#include <gtest/gtest.h>

#include <array>

#include "bench/shading/shading.hpp"
#include "core/groom/fur_setup.hpp"
#include "core/groom/height_field.hpp"

namespace pelt {
namespace {

constexpr float kSlack = 1e-5f;

TEST(Relief, StepsGrowTheMoreTheRayGoesAcrossTheHair) {
  const auto steps = [](glm::vec3 flow, glm::vec3 view) {
    return ReliefSteps(flow, view, 2.0f, 16.0f);
  };
  EXPECT_NEAR(steps({0, 0, 1}, {0, 0, 1}), 2.0f, kSlack);
  EXPECT_NEAR(steps({0, 0, 1}, {1, 0, 0}), 16.0f, kSlack);
  EXPECT_NEAR(steps({1, 0, 0.5f}, {-0.8f, 0, 0.6f}), 23.0f, kSlack) << "not clamped above";
  EXPECT_NEAR(steps({0.5f, 0, 1}, {0.6f, 0, 0.8f}), 2.0f, kSlack) << "0.6 is clamped below";
}

TEST(Relief, ShiftIsThatOfViewAndHairTogether) {
  const glm::vec2 shift = ReliefShift({1, 0, 0.5f}, {-0.8f, 0, 0.6f}, 0.03f);
  EXPECT_NEAR(shift.x, -0.1f, kSlack);
  EXPECT_NEAR(shift.y, 0.0f, kSlack);
  const glm::vec3 along = glm::normalize(glm::vec3(0.3f, -0.2f, 0.9f));
  EXPECT_NEAR(glm::length(ReliefShift(along, along, 1.0f)), 0.0f, kSlack)
      << "who looks along the hair sees its root";
  EXPECT_NEAR(ReliefShift({0, 0, 1}, {1, 0, 0}, 1.0f).x, 5.0f, kSlack) << "no further than this";
}

TEST(Relief, FlowComesOutOfItsTexel) {
  const glm::vec3 flow = ReliefFlow(glm::vec4(128.0f + 127.0f * 0.6f, 128.0f, 9.0f, 9.0f) / 255.0f);
  EXPECT_NEAR(flow.x, 0.6f, kSlack);
  EXPECT_NEAR(flow.y, 0.0f, kSlack);
  EXPECT_NEAR(flow.z, 0.8f, kSlack);
  EXPECT_EQ(ReliefFlow(glm::vec4(1.0f)).z, 0.0f);
}

// A wall half as high as the relief is deep, from 0.5 on.
float Wall(const glm::vec2& place) { return place.x >= 0.5f ? 0.5f : 0.0f; }

TEST(Relief, TheRayMeetsWhatStandsInItsWay) {
  // Straight down: the ground, or the wall's top.
  EXPECT_NEAR(ReliefHit(Wall, {0.2f, 0.0f}, {0.0f, 0.0f}, 16.0f).z, 0.0f, kSlack);
  EXPECT_NEAR(ReliefHit(Wall, {0.7f, 0.0f}, {0.0f, 0.0f}, 16.0f).z, 0.5f, kSlack);
  // Aslant towards +x: past the wall's foot below its top, onto the top above.
  const glm::vec3 side = ReliefHit(Wall, {0.1f, 0.0f}, {-0.6f, 0.0f}, 64.0f);
  EXPECT_NEAR(side.x, 0.5f, 0.6f / 64.0f);
  EXPECT_NEAR(side.z, 1.0f / 3.0f, 1.0f / 64.0f);
  const glm::vec3 top = ReliefHit(Wall, {0.4f, 0.0f}, {-0.6f, 0.0f}, 64.0f);
  EXPECT_NEAR(top.x, 0.7f, 0.6f / 64.0f);
  EXPECT_NEAR(top.z, 0.5f, kSlack);
}

TEST(Relief, AnEvenSlopeIsMetExactlyByAnyNumberOfSteps) {
  const auto slope = [](const glm::vec2& place) { return place.x; };
  for (const float steps : {2.0f, 3.5f, 8.0f, 23.0f}) {
    // The ray's height is 1 - t, the slope's 0.2 + 0.6 t: they meet at t = 0.5.
    const glm::vec3 hit = ReliefHit(slope, {0.2f, 0.0f}, {-0.6f, 0.0f}, steps);
    EXPECT_NEAR(hit.x, 0.5f, kSlack) << steps;
    EXPECT_NEAR(hit.z, 0.5f, kSlack) << steps;
  }
}

// More steps come ever nearer to where a very fine march ends; the most that a look has leaves little.
TEST(Relief, StepsConvergeOnTheTileOfHairs) {
  ControlMap tile{kHairTileSide, kHairTileSide, {}};
  for (const uint8_t height : MakeHairTile())
    tile.rgba.insert(tile.rgba.end(), {height, height, height, 255});
  const auto height = [&](const glm::vec2& place) { return tile.Sample(place, 0); };
  const auto mean_error = [&](float steps) {
    float sum = 0.0f;
    for (uint32_t i = 0; i < 400; ++i) {
      const glm::vec2 at(HashShare(2 * i), HashShare(2 * i + 1));
      const glm::vec2 shift(0.03f, 0.02f);
      sum += std::abs(ReliefHit(height, at, shift, steps).z - ReliefHit(height, at, shift, 512).z);
    }
    return sum / 400.0f;
  };
  EXPECT_LT(mean_error(16.0f), 0.5f * mean_error(4.0f));
  EXPECT_LT(mean_error(64.0f), 0.5f * mean_error(16.0f));
  EXPECT_LT(mean_error(16.0f), 0.05f);
}

TEST(Relief, HigherHairsKeepTheLightAway) {
  const glm::vec3 before_wall(0.45f, 0.0f, 0.0f);
  EXPECT_NEAR(ReliefShadow(Wall, before_wall, {-1.0f, 0.0f}, 0.75f), 1.0f, kSlack);
  EXPECT_NEAR(ReliefShadow(Wall, before_wall, {1.0f, 0.0f}, 0.75f), 0.25f, kSlack);
  EXPECT_NEAR(ReliefShadow(Wall, {0.7f, 0.0f, 0.5f}, {1.0f, 0.0f}, 0.75f), 1.0f, kSlack)
      << "nothing is above the wall";
  EXPECT_NEAR(ReliefAmbient(0.0f, 0.22f), 0.22f, kSlack);
  EXPECT_NEAR(ReliefAmbient(0.5f, 0.22f), 0.61f, kSlack);
  EXPECT_NEAR(ReliefAmbient(1.0f, 0.22f), 1.0f, kSlack);
}

TEST(Relief, SheenHasTheDistributionsOfItsSources) {
  constexpr std::array<std::array<float, 3>, 3> kValues{
      {{0.0f, 0.636620f, 0.795775f}, {0.5f, 0.477465f, 0.457486f}, {0.9f, 0.120958f, 0.159156f}}};
  for (const auto& [n_dot_h, charlie, ashikhmin] : kValues) {
    EXPECT_NEAR(SheenCharlie(n_dot_h, 0.5f), charlie, kSlack);
    EXPECT_NEAR(SheenAshikhmin(n_dot_h, 0.5f), ashikhmin, kSlack);
  }
  EXPECT_NEAR(SheenVisibility(1.0f, 1.0f), 0.25f, kSlack);
  EXPECT_NEAR(SheenVisibility(0.5f, 0.5f), 1.0f / 3.0f, kSlack);
  EXPECT_NEAR(Fresnel(1.0f, 0.04f), 0.04f, kSlack);
  EXPECT_NEAR(Fresnel(0.5f, 0.04f), 0.07f, kSlack);
  EXPECT_NEAR(Fresnel(0.0f, 0.04f), 1.0f, kSlack);
}

TEST(Relief, SheenDistributionsAreNormalised) {
  for (const float roughness : {0.3f, 0.5f, 1.0f}) {
    double charlie = 0.0, ashikhmin = 0.0;
    constexpr int kSteps = 4000;
    for (int i = 0; i < kSteps; ++i) {
      const double angle = (i + 0.5) / kSteps * M_PI / 2.0;
      const double ring = 2.0 * M_PI * std::sin(angle) * std::cos(angle) * M_PI / 2.0 / kSteps;
      charlie += ring * double(SheenCharlie(float(std::cos(angle)), roughness));
      ashikhmin += ring * double(SheenAshikhmin(float(std::cos(angle)), roughness));
    }
    EXPECT_NEAR(charlie, 1.0, 1e-4) << roughness;
    EXPECT_NEAR(ashikhmin, 1.0, 1e-4) << roughness;
  }
}

TEST(Relief, SheenIsAtTheEdgeAndNotBehind) {
  const glm::vec3 up(0.0f, 0.0f, 1.0f);
  const auto towards = [](float degrees) {
    return glm::vec3(std::sin(glm::radians(degrees)), 0.0f, std::cos(glm::radians(degrees)));
  };
  const float middle = ReliefSheen(up, towards(60.0f), towards(0.0f), 0.45f);
  const float edge = ReliefSheen(up, towards(60.0f), towards(85.0f), 0.45f);
  EXPECT_GT(edge, 20.0f * middle);
  EXPECT_LT(edge, 1.0f);
  EXPECT_EQ(ReliefSheen(up, -towards(60.0f), towards(0.0f), 0.45f), 0.0f);
}

}  // namespace
}  // namespace pelt
