// bench/shading/shaders/relief.glsl against values that were worked out apart from it, and against what it stands for.
#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdio>

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
  EXPECT_NEAR(ReliefHit(Wall, {0.2f, 0.0f}, {0.0f, 0.0f}, 16.0f, 0.0f).z, 0.0f, kSlack);
  EXPECT_NEAR(ReliefHit(Wall, {0.7f, 0.0f}, {0.0f, 0.0f}, 16.0f, 0.0f).z, 0.5f, kSlack);
  // Aslant towards +x: past the wall's foot below its top, onto the top above.
  const glm::vec3 side = ReliefHit(Wall, {0.1f, 0.0f}, {-0.6f, 0.0f}, 64.0f, 0.0f);
  EXPECT_NEAR(side.x, 0.5f, 0.6f / 64.0f);
  EXPECT_NEAR(side.z, 1.0f / 3.0f, 1.0f / 64.0f);
  const glm::vec3 top = ReliefHit(Wall, {0.4f, 0.0f}, {-0.6f, 0.0f}, 64.0f, 0.0f);
  EXPECT_NEAR(top.x, 0.7f, 0.6f / 64.0f);
  EXPECT_NEAR(top.z, 0.5f, kSlack);
}

TEST(Relief, AnEvenSlopeIsMetExactlyByAnyNumberOfSteps) {
  const auto slope = [](const glm::vec2& place) { return place.x; };
  for (const float steps : {2.0f, 3.5f, 8.0f, 23.0f}) {
    // The ray's height is 1 - t, the slope's 0.2 + 0.6 t: they meet at t = 0.5.
    const glm::vec3 hit = ReliefHit(slope, {0.2f, 0.0f}, {-0.6f, 0.0f}, steps, 0.0f);
    EXPECT_NEAR(hit.x, 0.5f, kSlack) << steps;
    EXPECT_NEAR(hit.z, 0.5f, kSlack) << steps;
  }
}

float HairTile(const glm::vec2& place) {
  static const ControlMap kTile = [] {
    ControlMap tile{kHairTileSide, kHairTileSide, {}};
    for (const uint8_t height : MakeHairTile())
      tile.rgba.insert(tile.rgba.end(), {height, height, height, 255});
    return tile;
  }();
  return kTile.Sample(place, 0);
}

// More steps come ever nearer to where a very fine march ends; the most that a look has leaves little.
TEST(Relief, StepsConvergeOnTheTileOfHairs) {
  const auto height = HairTile;
  const auto mean_error = [&](float steps) {
    float sum = 0.0f;
    for (uint32_t i = 0; i < 400; ++i) {
      const glm::vec2 at(HashShare(2 * i), HashShare(2 * i + 1));
      const glm::vec2 shift(0.03f, 0.02f);
      sum += std::abs(ReliefHit(height, at, shift, steps, 0.0f).z -
                      ReliefHit(height, at, shift, 512, 0.0f).z);
    }
    return sum / 400.0f;
  };
  EXPECT_LT(mean_error(16.0f), 0.5f * mean_error(4.0f));
  EXPECT_LT(mean_error(64.0f), 0.5f * mean_error(16.0f));
  EXPECT_LT(mean_error(16.0f), 0.05f);
}

TEST(Relief, StepsAreCountedUntilTheHairIsMet) {
  const auto even = [](const glm::vec2&) { return 0.5f; };
  EXPECT_EQ(ReliefHit(even, {0.0f, 0.0f}, {0.1f, 0.0f}, 8.0f, 0.0f).w, 4.0f);
  EXPECT_EQ(ReliefHit(even, {0.0f, 0.0f}, {0.1f, 0.0f}, 7.5f, 0.5f).w, 5.0f)
      << "of 3.5, 4.5 eighths";
  const auto bald = [](const glm::vec2&) { return 0.0f; };
  for (const float jitter : {0.0f, 0.3f, 0.9f}) {
    const glm::vec4 hit = ReliefHit(bald, {0.0f, 0.0f}, {0.1f, 0.0f}, 8.0f, jitter);
    EXPECT_NEAR(glm::length(hit - glm::vec4(-0.1f, 0, 0, jitter > 0.0f ? 9 : 8)), 0.0f, kSlack);
  }
  EXPECT_EQ(ReliefStepColour(0.0f, 16.0f), glm::vec3(0, 0, 1));
  EXPECT_EQ(ReliefStepColour(8.0f, 16.0f), glm::vec3(0, 1, 0));
  EXPECT_EQ(ReliefStepColour(28.0f, 16.0f), glm::vec3(1, 0, 0));
}

TEST(Relief, JitterIsEvenOverPixelsAndFrames) {
  float of_pixels = 0.0f, of_frames = 0.0f;
  for (int i = 0; i < 4096; ++i) {
    of_pixels += ReliefJitter({float(i % 64), float(i / 64)}, 0.0f) / 4096.0f;
    of_frames += ReliefJitter({7.0f, 11.0f}, float(i % 64)) / 4096.0f;
  }
  EXPECT_NEAR(of_pixels, 0.5f, 0.01f);
  EXPECT_NEAR(of_frames, 0.5f, 0.05f);
  EXPECT_NE(ReliefJitter({7.0f, 11.0f}, 0.0f), ReliefJitter({8.0f, 11.0f}, 0.0f));
}

// Four steps miss hairs; the mean of frames that miss others is nearer to what is there.
TEST(Relief, AccumulatedFramesAreNearerThanOne) {
  constexpr int kPlaces = 1500, kFrames = 16;
  const glm::vec2 shift(0.12f, 0.08f);
  float one = 0.0f, accumulated = 0.0f;
  for (int i = 0; i < kPlaces; ++i) {
    const glm::vec2 at(HashShare(uint32_t(2 * i)), HashShare(uint32_t(2 * i + 1)));
    const glm::vec2 pixel(float(i % 20), float(i / 20));
    const float there = ReliefHit(HairTile, at, shift, 512.0f, 0.0f).z;
    float mean = 0.0f;
    for (int frame = 0; frame < kFrames; ++frame)
      mean += ReliefHit(HairTile, at, shift, 4.0f, ReliefJitter(pixel, float(frame))).z /
              float(kFrames);
    one += std::abs(ReliefHit(HairTile, at, shift, 4.0f, 0.0f).z - there) / float(kPlaces);
    accumulated += std::abs(mean - there) / float(kPlaces);
  }
  std::printf("4 steps are %.3f of the depth off, the mean of %d frames %.3f\n", one, kFrames,
              accumulated);
  EXPECT_LT(accumulated, 0.93f * one);
}

// How far the place that is looked up in the tile is from where a ray of 256 steps ends, and that from where one ends
// that is followed lower than kReliefLowest: the distortion of fur 34 mm long that stands up by 60 degrees, tile's
// texels, the mean over it.
struct Slide {
  float steps, lowest;
};
Slide SlideAt(float degrees, float least, float most) {
  constexpr uint32_t kPlaces = 400;
  const float depth = kReliefDepth * 0.034f / (0.0035f * float(kHairTileDots));
  const glm::vec3 flow(0.5f, 0.0f, 0.8660254f);
  const glm::vec3 view(-std::sin(glm::radians(degrees)), 0.0f, std::cos(glm::radians(degrees)));
  const glm::vec2 shift = ReliefShift(flow, view, depth * flow.z);
  const glm::vec2 whole = (glm::vec2(view) / view.z - glm::vec2(flow) / flow.z) * (depth * flow.z);
  const float steps = ReliefSteps(flow, view, least, most);
  Slide slide{};
  for (uint32_t i = 0; i < kPlaces; ++i) {
    const glm::vec2 at(HashShare(2 * i), HashShare(2 * i + 1));
    const glm::vec2 there = ReliefHit(HairTile, at, shift, 256.0f, 0.0f);
    const glm::vec2 seen = ReliefHit(HairTile, at, shift, steps, 0.0f);
    const glm::vec2 traced = ReliefHit(HairTile, at, whole, 256.0f, 0.0f);
    slide.steps += glm::length(seen - there) * float(kHairTileSide) / float(kPlaces);
    slide.lowest += glm::length(there - traced) * float(kHairTileSide) / float(kPlaces);
  }
  return slide;
}

TEST(Relief, LooksUpNearWhereATracedRayEnds) {
  constexpr float kMillimetres = 3.5f * float(kHairTileDots) / float(kHairTileSide);
  std::printf("of a texel, %.2f mm: degrees off the normal, steps 4-16, 2-4, lowest\n",
              kMillimetres);
  for (const float degrees : {0.0f, 30.0f, 60.0f, 75.0f, 85.0f}) {
    const Slide slide = SlideAt(degrees, 4.0f, 16.0f);
    const float few = SlideAt(degrees, 2.0f, 4.0f).steps;
    std::printf("  %2.0f: %6.2f %6.2f %6.2f\n", degrees, slide.steps, few, slide.lowest);
    EXPECT_GT(few, slide.steps) << degrees;
    EXPECT_LT(slide.steps * kMillimetres, degrees > 80.0f ? 3.0f : degrees > 70.0f ? 2.0f : 1.0f);
    if (degrees < 78.0f) {
      EXPECT_EQ(slide.lowest, 0.0f) << degrees;
    }
  }
  EXPECT_GT(SlideAt(85.0f, 4.0f, 16.0f).lowest, 5.0f) << "of a cosine of 0.087 in place of 0.2";
}

// Skin in the plane of x and y, a metre for each unit of u and v, on which hairs of 6 cm stand up.
ReliefPoint StandingFur() {
  ReliefPoint point{};
  point.normal = {0.0f, 0.0f, 1.0f};
  point.axis_u = {1.0f, 0.0f, 0.0f};
  point.axis_v = {0.0f, 1.0f, 0.0f};
  point.repeat = {6.0f, 6.0f};
  point.flow = glm::vec4(128.0f / 255.0f, 128.0f / 255.0f, 1.0f, 1.0f);
  point.longest = 0.06f;
  point.to_eye = point.normal;
  return point;
}

TEST(Relief, WindPushesTipsAndLeavesRoots) {
  ReliefMarch march{4.0f, 16.0f, 0.0f, glm::vec3(0.01f, 0.0f, 5.0f), glm::vec2(0.0f)};
  const glm::vec3 to_sun(0.0f, 0.0f, 1.0f);
  const auto tips = [](const glm::vec2&) { return 1.0f; };
  const ReliefFur tip = TraceRelief(tips, march, StandingFur(), to_sun);
  EXPECT_NEAR(tip.height, 1.0f, kSlack);
  EXPECT_NEAR(tip.place.x, -kReliefDepth * 0.01f * 6.0f, kSlack) << "the root lies upwind";
  EXPECT_NEAR(tip.hair.x / tip.hair.z, 0.01f / 0.06f, kSlack) << "along the skin alone";
  // Bald skin is where it was, and so is all in still air.
  const auto root = [](const glm::vec2& at) { return at.x < -0.9f ? 1.0f : 0.0f; };
  march.pan = {1.0f, 0.0f};  // a gust of 1 comes where its tile has that
  const ReliefFur bald = TraceRelief(root, march, StandingFur(), to_sun);
  EXPECT_NEAR(bald.hair.x / bald.hair.z, 0.01f / 0.06f, kSlack);
  EXPECT_NEAR(glm::length(bald.place), 0.0f, kSlack);
  march.pan = {0.5f, 0.0f};
  EXPECT_NEAR(TraceRelief(root, march, StandingFur(), to_sun).hair.x, 0.0f, kSlack)
      << "between gusts";
  march.wind = glm::vec3(0.0f);
  EXPECT_NEAR(TraceRelief(tips, march, StandingFur(), to_sun).place.x, 0.0f, kSlack);
}

// Of relief.frag, whose uniforms are as they are here.
TEST(Relief, IsDrawnWithASunAndByItsSteps) {
  static_assert(sizeof(ReliefSettings) == 8 * 16 && offsetof(ReliefSettings, repeat_pan) == 112);
  ReliefSettings settings{};
  settings.eye = settings.to_sun = {0.0f, 0.0f, 1.0f};
  settings.longest = 0.06f;
  settings.tip_colour = {0.5f, 0.25f, 0.0f};
  settings.least_steps = settings.most_steps = 4.0f;
  settings.frame = -1.0f;
  settings.ambient = glm::vec3(1.0f);
  settings.roughness = 0.45f;
  settings.repeat_pan = {6.0f, 6.0f, 0.0f, 0.0f};
  const ReliefPoint fur = StandingFur();
  const auto draw = [&](float alpha) {
    return DrawRelief([](const glm::vec2&) { return 1.0f; }, settings, {fur.axis_u, fur.axis_v},
                      glm::vec3(0.0f), fur.normal, glm::vec2(0.0f),
                      glm::vec4(glm::vec3(fur.flow), alpha), glm::vec2(0.5f));
  };
  EXPECT_NEAR(glm::length(draw(0.5f) - glm::vec4(0.25f, 0.125f, 0.0f, 0.5f)), 0.0f, kSlack)
      << "of tips under the sky alone, premultiplied";
  settings.to_sun = {0.6f, 0.0f, 0.8f};
  settings.sun = glm::vec3(1.0f);
  const glm::vec4 sunlit = draw(1.0f);
  EXPECT_GT(sunlit.r, 0.5f + 0.5f * 0.6f * 0.8f) << "Kajiya and Kay's, and the sheen";
  EXPECT_LT(sunlit.r, 1.0f);
  settings.shows_steps = 1.0f;
  EXPECT_EQ(draw(1.0f), glm::vec4(ReliefStepColour(1.0f, 4.0f), 1.0f));
}

TEST(Relief, AxesComeFromWhatPixelsDiffer) {
  const glm::vec3 u(0.3f, -0.1f, 0.2f), v(0.05f, 0.4f, -0.2f);
  const glm::vec2 x(0.01f, -0.004f), y(0.003f, 0.02f);  // of u and v, to the next pixels
  const ReliefAxes axes = FindReliefAxes(u * x.x + v * x.y, u * y.x + v * y.y, x, y);
  EXPECT_NEAR(glm::length(axes.u - u), 0.0f, kSlack);
  EXPECT_NEAR(glm::length(axes.v - v), 0.0f, kSlack);
  EXPECT_EQ(FindReliefAxes(u, v, x, 2.0f * x).u, glm::vec3(0.0f)) << "a texture that stands still";
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
