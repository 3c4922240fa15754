// What paint does to a colour and to the light on hair, at values that can be computed by hand.
#include <gtest/gtest.h>

#include "bench/shading/default_look.hpp"
#include "bench/shading/shading.hpp"

namespace pelt {
namespace {

const glm::vec3 kFur(0.30f, 0.18f, 0.08f), kUp(0.0f, 1.0f, 0.0f);
constexpr PaintLook kLook{0.45f, {0.25f, 0.18f, 0.10f}, {0.9f, 0.92f, 0.95f}, {0.6f, 0.55f, 0.5f}};

void ExpectNear(const glm::vec3& found, const glm::vec3& wanted, float within) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], wanted[c], within) << c;
}
float Luminance(const glm::vec3& c) { return glm::dot(c, glm::vec3(0.2126f, 0.7152f, 0.0722f)); }
float Spread(const glm::vec3& c) { return std::max({c.x, c.y, c.z}) - std::min({c.x, c.y, c.z}); }

TEST(PaintShading, NoPaintChangesNothing) {
  const glm::vec4 none(0.0f);
  ExpectNear(PaintedColour(kLook, kFur, none), kFur, 1e-5f);
  EXPECT_EQ(SeenPaint(none, kUp, 0.0f), none);
  const HairLook look = PaintedHair(kDefaultHair, none);
  EXPECT_EQ(look.primary, kDefaultHair.primary);
  EXPECT_EQ(look.secondary_exponent, kDefaultHair.secondary_exponent);
  EXPECT_EQ(look.noise, kDefaultHair.noise);
  EXPECT_EQ(look.scatter, kDefaultHair.scatter);
}

// All of it hides what is below, for any noise.
TEST(PaintShading, AllMudIsMud) {
  for (const float noise : {0.0f, 0.4f, 1.0f}) {
    const glm::vec4 seen = SeenPaint({1.0f, 0, 0, 0}, kUp, noise);
    const glm::vec3 mud = PaintedColour(kLook, kFur, seen);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(SrgbFromLinear(mud[c]), kLook.mud[c], 1e-4f);
  }
  EXPECT_LT(PaintedHair(kDefaultHair, {1, 0, 0, 0}).primary, 0.11f * kDefaultHair.primary);
}

TEST(PaintShading, MudComesInClots) {
  EXPECT_GT(Clotted(0.4f, 0.0f), 0.85f);
  EXPECT_EQ(Clotted(0.4f, 0.9f), 0.0f);
  for (const float noise : {0.0f, 0.5f, 1.0f})
    for (float amount = 0.0f; amount < 1.0f; amount += 0.05f)
      EXPECT_LE(Clotted(amount, noise), Clotted(amount + 0.05f, noise));
}

TEST(PaintShading, SnowLiesOnTopAlone) {
  EXPECT_EQ(SnowCover(1.0f, kUp, 0.7f), 1.0f);
  EXPECT_EQ(SnowCover(1.0f, -kUp, 0.0f), 0.0f);
  EXPECT_LT(SnowCover(1.0f, {1, 0, 0}, 0.3f), 1.0f);
  ExpectNear(PaintedColour(kLook, kFur, {0, 1, 0, 0}), kLook.snow, 1e-6f);
  EXPECT_GT(PaintedHair(kDefaultHair, {0, 1, 0, 0}).scatter, kDefaultHair.scatter);
}

// As the tint of a layer does it, which multiplies sRGB bytes.
TEST(PaintShading, SoakedIsAsDarkAsTheLayersTint) {
  const glm::vec3 wet = PaintedColour(kLook, kFur, {0, 0, 1, 0});
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(SrgbFromLinear(wet[c]), kLook.wet_darken * SrgbFromLinear(kFur[c]), 1e-5f);
  const HairLook look = PaintedHair(kDefaultHair, {0, 0, 1, 0});
  EXPECT_GT(look.primary, 2.0f * kDefaultHair.primary);
  EXPECT_GT(look.primary_exponent, 1.5f * kDefaultHair.primary_exponent);
  EXPECT_LT(look.noise, kDefaultHair.noise);
  // Mud on it takes the shine again.
  EXPECT_LT(PaintedHair(kDefaultHair, {1, 0, 1, 0}).primary, 0.2f * kDefaultHair.primary);
}

TEST(PaintShading, DustIsGreyAndPale) {
  const glm::vec3 dusty = PaintedColour(kLook, kFur, {0, 0, 0, 1});
  EXPECT_LT(Spread(dusty), Spread(kFur));
  EXPECT_GT(Luminance(dusty), Luminance(kFur));
  EXPECT_LT(PaintedHair(kDefaultHair, {0, 0, 0, 1}).secondary, 0.3f * kDefaultHair.secondary);
}

}  // namespace
}  // namespace pelt
