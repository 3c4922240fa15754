// bench/shading/shaders/strand_shading.glsl against values that were worked out apart from it.
#include <gtest/gtest.h>

#include <array>

#include "bench/shading/shading.hpp"

namespace pelt {
namespace {

constexpr float kNear = 1e-5f;
const glm::vec3 kX(1.0f, 0.0f, 0.0f), kY(0.0f, 1.0f, 0.0f), kZ(0.0f, 0.0f, 1.0f);

glm::vec3 Leaning(float degrees) {  // from x towards y
  return {std::cos(glm::radians(degrees)), std::sin(glm::radians(degrees)), 0.0f};
}

// A unit vector of this component along x.
glm::vec3 Along(float x) { return {x, std::sqrt(1.0f - x * x), 0.0f}; }

TEST(StrandShading, DiffuseIsTheSine) {
  constexpr std::array<std::array<float, 2>, 5> kValues{
      {{0.0f, 0.0f}, {30.0f, 0.5f}, {45.0f, 0.707107f}, {60.0f, 0.866025f}, {90.0f, 1.0f}}};
  for (const auto& [degrees, wanted] : kValues)
    EXPECT_NEAR(HairDiffuse(kX, Leaning(degrees)), wanted, kNear) << degrees;
}

TEST(StrandShading, LobesFallOffOnBothSides) {
  for (const float exponent : {28.0f, 90.0f}) {
    EXPECT_NEAR(HairLobe(kX, kY, exponent), 1.0f, kNear);
    EXPECT_NEAR(HairLobe(kX, -kX, exponent), 0.0f, kNear);
  }
  EXPECT_NEAR(HairLobe(kX, Along(0.1f), 90.0f), 0.636185f, kNear);
  EXPECT_NEAR(HairLobe(kX, Along(0.1f), 28.0f), 0.868746f, kNear);
  EXPECT_NEAR(HairLobe(kX, Along(-0.1f), 90.0f), 0.618372f, kNear);
  EXPECT_NEAR(HairLobe(kX, Along(-0.1f), 28.0f), 0.844421f, kNear);
}

TEST(StrandShading, HalfwayIsUnitOrShort) {
  EXPECT_NEAR(glm::dot(Halfway(kX, kY), Leaning(45.0f)), 1.0f, kNear);
  EXPECT_EQ(Halfway(kX, -kX), glm::vec3(0.0f));
}

TEST(StrandShading, TangentIsShiftedAlongTheNormal) {
  const glm::vec3 shifted = ShiftTangent(kY, kZ, 0.1f);
  EXPECT_NEAR(shifted.x, 0.0f, kNear);
  EXPECT_NEAR(shifted.y, 0.995037f, kNear);
  EXPECT_NEAR(shifted.z, 0.099504f, kNear);
}

TEST(StrandShading, WrappedLightReachesRoundAndIsBounded) {
  EXPECT_NEAR(WrapDiffuse(1.0f, 0.4f), 1.0f, kNear);
  EXPECT_NEAR(WrapDiffuse(0.0f, 0.4f), 0.285714f, kNear);
  EXPECT_NEAR(WrapDiffuse(-0.4f, 0.4f), 0.0f, kNear);
  EXPECT_EQ(WrapDiffuse(-1.0f, 0.4f), 0.0f);
}

TEST(StrandShading, RimGlowsAtTheOutlineOrDarkensIt) {
  EXPECT_NEAR(Rim(kX, Leaning(60.0f), 3.0f), 0.125f, kNear);
  EXPECT_NEAR(Rim(kX, -Leaning(60.0f), 3.0f), 0.125f, kNear);
  EXPECT_NEAR(Rim(kX, kY, 3.0f), 1.0f, kNear);
  EXPECT_NEAR(RimFrom(kX, kX, 0.0f), 1.0f, kNear);
  EXPECT_NEAR(RimFrom(-kX, kX, 0.0f), 1.0f, kNear);
  EXPECT_NEAR(RimFrom(kX, kX, 1.0f), 1.0f, kNear);
  EXPECT_NEAR(RimFrom(kY, kX, 1.0f), 0.5f, kNear);
  EXPECT_NEAR(RimFrom(-kX, kX, 0.5f), 0.5f, kNear);
  const glm::vec3 dark = AddRim(glm::vec3(0.5f, 0.2f, 0.3f), glm::vec3(-0.3f));
  EXPECT_NEAR(dark.x, 0.2f, kNear);
  EXPECT_EQ(dark.y, 0.0f);
  EXPECT_EQ(dark.z, 0.0f);
}

TEST(StrandShading, LightDiesAwayTowardsTheSkin) {
  constexpr std::array<std::array<float, 2>, 6> kValues{{{-0.01f, 0.22f},
                                                         {0.0f, 0.22f},
                                                         {0.0075f, 0.477304f},
                                                         {0.015f, 0.667992f},
                                                         {0.03f, 1.0f},
                                                         {0.06f, 1.0f}}};
  const glm::vec3 root(1.0f, 2.0f, 0.5f);
  for (const auto& [height, wanted] : kValues)
    EXPECT_NEAR(DepthShadow(root + kX * 0.2f + kZ * height, root, kZ, 0.03f, 0.22f), wanted, kNear)
        << height;
}

TEST(StrandShading, SelfShadowDeepensWithWhatLiesBefore) {
  const auto share = [](float coverage, float behind) {
    return SelfShadow(coverage, behind, 0.004f, 45.0f, 0.9f);
  };
  EXPECT_NEAR(share(1.0f, -0.1f), 1.0f, kNear);
  EXPECT_NEAR(share(1.0f, 0.004f), 1.0f, kNear);
  EXPECT_NEAR(share(1.0f, 0.010f), 0.787042f, kNear);
  EXPECT_NEAR(share(1.0f, 0.030f), 0.379330f, kNear);
  EXPECT_NEAR(share(1.0f, 0.100f), 0.111970f, kNear);
  EXPECT_NEAR(share(7.0f, 0.100f), 0.111970f, kNear);
  EXPECT_NEAR(share(0.25f, 0.010f), 0.946760f, kNear);
  EXPECT_NEAR(share(0.25f, 0.030f), 0.844833f, kNear);
  EXPECT_NEAR(share(0.25f, 0.100f), 0.777992f, kNear);
}

TEST(StrandShading, BacklightIsSeenAgainstTheLightOnly) {
  EXPECT_NEAR(Backlight(kY, kX, -kX, 8.0f), 1.0f, kNear);
  EXPECT_NEAR(Backlight(kX, kX, -kX, 8.0f), 0.0f, kNear);
  EXPECT_NEAR(Backlight(kZ, kX, -Leaning(60.0f), 2.0f), 0.25f, kNear);
  EXPECT_EQ(Backlight(kY, kX, kX, 8.0f), 0.0f);
  EXPECT_NEAR(TransmittedColour(glm::vec3(0.25f)).x, 0.5f, kNear);
}

TEST(StrandShading, ScatteredLightKeepsWhiteAndDeepensColour) {
  const glm::vec3 colour(1.0f, 0.5f, 0.0f);
  const glm::vec3 outside = MultipleScatter(colour, 0.0f, 2.0f);
  const glm::vec3 inside = MultipleScatter(colour, 0.5f, 2.0f);
  EXPECT_NEAR(outside.y, 0.5f, kNear);
  EXPECT_NEAR(inside.x, 1.0f, kNear);
  EXPECT_NEAR(inside.y, 0.25f, kNear);
  EXPECT_EQ(inside.z, 0.0f);
}

TEST(StrandShading, HairLiesOverWhatIsThere) {
  const glm::vec3 over = Over(glm::vec3(0.8f, 0.4f, 0.0f), 0.25f, glm::vec3(0.4f));
  EXPECT_NEAR(over.x, 0.5f, kNear);
  EXPECT_NEAR(over.y, 0.4f, kNear);
  EXPECT_NEAR(over.z, 0.3f, kNear);
}

TEST(StrandShading, SrgbIsTheStandardsCurve) {
  EXPECT_NEAR(LinearFromSrgb(128.0f / 255.0f), 0.215861f, kNear);
  EXPECT_NEAR(LinearFromSrgb(0.04045f), 0.0031308f, kNear);
  EXPECT_NEAR(LinearFromSrgb(0.02f), 0.00154799f, kNear);
  for (int byte = 0; byte < 256; ++byte) {
    const float v = float(byte) / 255.0f;
    EXPECT_NEAR(SrgbFromLinear(LinearFromSrgb(v)), v, kNear) << byte;
  }
}

TEST(StrandShading, NoiseIsEvenAndSmoothAlongTheHair) {
  EXPECT_EQ(HashShare(0u), 0.0f);
  EXPECT_NEAR(HashShare(1u), 0.408349f, kNear);           // lowbias32: 0x688990c0
  EXPECT_NEAR(HashShare(0xdeadbeefu), 0.899060f, kNear);  // 0xe628c683
  double sum = 0.0;
  for (uint32_t i = 0; i < 4096; ++i) {
    const float share = HashShare(i);
    ASSERT_GE(share, 0.0f);
    ASSERT_LT(share, 1.0f);
    sum += share;
  }
  EXPECT_NEAR(sum / 4096.0, 0.5, 0.02);
  EXPECT_NEAR(StrandNoise(3u, 0.0f, 4.0f), HashShare(192u), kNear);
  EXPECT_NEAR(StrandNoise(3u, 0.125f, 4.0f), 0.5f * (HashShare(192u) + HashShare(193u)), kNear);
  EXPECT_NEAR(StrandNoise(3u, 0.2499f, 4.0f), StrandNoise(3u, 0.2501f, 4.0f), 1e-2f);
}

}  // namespace
}  // namespace pelt
