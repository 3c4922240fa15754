// bench/shading/shaders/strand_light.glsl: what the terms are for when they are put together.
#include <gtest/gtest.h>

#include <glm/gtc/constants.hpp>

#include "bench/shading/default_look.hpp"
#include "bench/shading/shading.hpp"

namespace pelt {
namespace {

// A hair that lies on the ground of the z axis, seen from above.
HairPoint SomePoint() {
  return {.colour = glm::vec3(0.5f, 0.2f, 0.05f),
          .tangent = {1.0f, 0.0f, 0.0f},
          .normal = {0.0f, 0.0f, 1.0f},
          .to_eye = {0.0f, 0.0f, 1.0f},
          .depth_light = 1.0f,
          .sun_share = 1.0f,
          .noise = 0.5f};
}

// A look and lights of one term alone.
HairLook NoLook() {
  HairLook look{};
  look.rim = 1.0f;
  look.primary_exponent = look.secondary_exponent = look.rim_exponent = look.backlight_exponent =
      1.0f;
  return look;
}
LightSet NoLight() {
  LightSet light{};
  light.to_sun = light.to_rim = {0.0f, 0.0f, 1.0f};
  return light;
}

void ExpectColour(const glm::vec3& got, const glm::vec3& wanted) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(got[c], wanted[c], 1e-5f) << "rgb"[c];
}

TEST(StrandLight, SunAcrossTheHairGivesItsColour) {
  LightSet light = NoLight();
  light.sun = {1.0f, 0.5f, 2.0f};
  const HairPoint point = SomePoint();
  ExpectColour(ShadeHair(light, NoLook(), point), point.colour * light.sun);
  ExpectColour(ShadeSkin(light, NoLook(), point.colour, point.normal, point.to_eye, 1.0f, 1.0f),
               point.colour * light.sun);
}

TEST(StrandLight, EvenSkyGivesTheColour) {
  LightSet light = NoLight();
  light.sky[0] = glm::vec3(std::sqrt(4.0f * glm::pi<float>()));
  const HairPoint point = SomePoint();
  ExpectColour(ShadeHair(light, NoLook(), point), point.colour);
  ExpectColour(ShadeSkin(light, NoLook(), point.colour, point.normal, point.to_eye, 1.0f, 1.0f),
               point.colour);
}

TEST(StrandLight, ShadowTakesTheSunAndLeavesTheSky) {
  LightSet light = NoLight();
  light.sun = glm::vec3(1.0f);
  light.sky[0] = glm::vec3(std::sqrt(4.0f * glm::pi<float>()));
  HairPoint point = SomePoint();
  point.sun_share = 0.0f;
  ExpectColour(ShadeHair(light, NoLook(), point), point.colour);
  point.depth_light = 0.25f;
  ExpectColour(ShadeHair(light, NoLook(), point), point.colour * 0.25f);
}

TEST(StrandLight, PaleFurStaysPaleInside) {
  const glm::vec3 white(1.0f), brown(0.3f, 0.15f, 0.05f);
  const float share = 0.22f;
  const glm::vec3 pale = CoatColour(kDefaultHair, white, share);
  const glm::vec3 dark = CoatColour(kDefaultHair, brown, share);
  EXPECT_GT(pale.x, 0.65f);
  EXPECT_NEAR(pale.x, pale.z, 1e-5f);
  for (int c = 0; c < 3; ++c) EXPECT_LT(dark[c] / brown[c], pale[c]);
  EXPECT_GT(dark.x / dark.z, brown.x / brown.z);  // and colours deepen
  ExpectColour(CoatColour(kDefaultHair, brown, 1.0f), brown);
}

TEST(StrandLight, PrimaryHasTheLightsColourSecondaryTheHairs) {
  HairLook look = NoLook();
  HairPoint point = SomePoint();
  look.primary = 1.0f;
  ExpectColour(Highlights(look, point, point.normal), glm::vec3(1.0f));
  look.primary = 0.0f;
  look.secondary = 1.0f;
  ExpectColour(Highlights(look, point, point.normal), point.colour);
  look.noise = 1.0f;
  point.noise = 0.0f;
  ExpectColour(Highlights(look, point, point.normal), glm::vec3(0.0f));
}

// The middle of a highlight, by the tilt of a hair that stands along x on a round body.
float TiltOfHighlight(const HairLook& look) {
  float best = -1.0f, tilt = 0.0f;
  HairPoint point = SomePoint();
  const glm::vec3 light = point.to_eye;
  for (float degrees = -20.0f; degrees <= 20.0f; degrees += 0.1f) {
    const float a = glm::radians(degrees);
    point.tangent = {std::cos(a), 0.0f, -std::sin(a)};
    point.normal = {std::sin(a), 0.0f, std::cos(a)};
    const float shine = Highlights(look, point, light).x;
    if (shine <= best) continue;
    best = shine;
    tilt = degrees;
  }
  return tilt;
}

TEST(StrandLight, PrimaryMovesToTheRootSecondaryToTheTip) {
  HairLook first = NoLook(), second = NoLook();
  first.primary = second.secondary = 1.0f;
  first.primary_exponent = second.secondary_exponent = 90.0f;
  EXPECT_NEAR(TiltOfHighlight(first), 0.0f, 0.2f);
  first.primary_shift = second.secondary_shift = 0.1f;
  // The hair bends away from the light towards its tip: there the tilt is larger.
  const float degrees = glm::degrees(std::atan(0.1f));
  EXPECT_NEAR(std::abs(TiltOfHighlight(first)), degrees, 0.2f);
  EXPECT_NEAR(TiltOfHighlight(first), -TiltOfHighlight(second), 0.2f);
}

TEST(StrandLight, RimGlowsOrDarkensAndNeverGoesBelow0) {
  LightSet light = NoLight();
  light.rim = glm::vec3(1.0f);
  HairPoint point = SomePoint();
  point.to_eye = {1.0f, 0.0f, 0.0f};
  ExpectColour(ShadeHair(light, NoLook(), point), glm::mix(point.colour, glm::vec3(1.0f), 0.25f));
  light.sun = glm::vec3(1.0f);
  light.rim = glm::vec3(-0.2f);
  const glm::vec3 dark = ShadeHair(light, NoLook(), point);
  for (int c = 0; c < 3; ++c) EXPECT_LT(dark[c], point.colour[c]);
  light.rim = glm::vec3(-9.0f);
  ExpectColour(ShadeHair(light, NoLook(), point), glm::vec3(0.0f));
}

TEST(StrandLight, BacklightGlowsThroughTheHairInItsOwnColour) {
  LightSet light = NoLight();
  light.sun = glm::vec3(1.0f);
  HairPoint point = SomePoint();
  point.normal = {0.0f, 0.0f, -1.0f};
  light.to_sun = {0.0f, 0.0f, -1.0f};
  HairLook look = NoLook();
  const glm::vec3 without = ShadeHair(light, look, point);
  look.backlight = 0.5f;
  ExpectColour(ShadeHair(light, look, point) - without, glm::sqrt(point.colour) * 0.5f);
}

// The default look, on hair of any direction: light is a finite number, and no less than none.
TEST(StrandLight, DefaultLookIsFiniteEverywhere) {
  const LightSet light = DefaultLights();
  HairPoint point = SomePoint();
  for (int i = 0; i < 4000; ++i) {
    const auto turn = [i](float rate) {
      const float a = rate * float(i);
      return glm::normalize(glm::vec3(std::cos(a), std::sin(1.7f * a), std::sin(a)));
    };
    point.tangent = turn(0.31f);
    point.normal = turn(0.17f);
    point.to_eye = i % 5 ? turn(0.05f) : -light.to_sun;
    point.depth_light = float(i % 11) / 10.0f;
    point.sun_share = float(i % 7) / 6.0f;
    point.colour = glm::vec3(float(i % 3) / 2.0f);
    const glm::vec3 lit = ShadeHair(light, kDefaultHair, point);
    for (int c = 0; c < 3; ++c) {
      ASSERT_TRUE(std::isfinite(lit[c])) << i;
      ASSERT_GE(lit[c], 0.0f) << i;
      ASSERT_LT(lit[c], 8.0f) << i;
    }
  }
}

}  // namespace
}  // namespace pelt
