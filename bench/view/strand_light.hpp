// A hair and the skin below it under a whole set of lights: the terms of strand_shading.hpp put together.
// shaders/strand_light.glsl has the same, by the same names.
#pragma once

#include "bench/view/spherical_harmonics.hpp"
#include "bench/view/strand_shading.hpp"

namespace pelt {

// Colours are radiance: what a white Lambert patch that faces the light reflects.
struct LightSet {
  glm::vec3 to_sun, sun;
  glm::vec3 to_rim, rim;  // a light behind what is seen; a negative one darkens outlines
  glm::vec3 sky[16];      // spherical harmonics
};

// How a coat of hair takes light.
struct HairLook {
  float primary, primary_exponent, primary_shift;  // in the light's colour, shifted to the root
  float secondary, secondary_exponent, secondary_shift;  // in the hair's, to the tip
  float noise;  // how far noise breaks the secondary one up, 0 to 1
  float wrap;   // of light round the body
  float rim_exponent, rim_from;
  float backlight, backlight_exponent;
  float scatter,
      scatter_depth;  // share of light kept inside the coat, and how fast it takes on colour
};

// A place on a hair.
struct HairPoint {
  glm::vec3 colour, tangent;
  glm::vec3 normal;  // of the skin at the root
  glm::vec3 to_eye;
  float depth_light;  // DepthShadow
  float sun_share;    // SelfShadow
  float noise;        // StrandNoise
};

// Colour of hair where this share of light comes straight, the rest by way of other hairs.
inline glm::vec3 CoatColour(const HairLook& look, const glm::vec3& colour, float share) {
  const float inside = 1.0f - share;
  return colour * share +
         MultipleScatter(colour, inside, look.scatter_depth) * (look.scatter * inside);
}

// Both highlights, without the light's colour.
inline glm::vec3 Highlights(const HairLook& look, const HairPoint& p, const glm::vec3& to_light) {
  const glm::vec3 halfway = Halfway(to_light, p.to_eye);
  const glm::vec3 to_root = ShiftTangent(p.tangent, p.normal, look.primary_shift);
  const glm::vec3 to_tip = ShiftTangent(p.tangent, p.normal, -look.secondary_shift);
  const float first = look.primary * HairLobe(to_root, halfway, look.primary_exponent);
  const float second = look.secondary * HairLobe(to_tip, halfway, look.secondary_exponent) *
                       glm::mix(1.0f, 2.0f * p.noise, look.noise);
  return glm::vec3(first) + p.colour * second;
}

// What the light behind adds at the outline, of hair or skin of this colour.
inline glm::vec3 OutlineLight(const LightSet& light, const HairLook& look, const glm::vec3& colour,
                              const glm::vec3& normal, const glm::vec3& to_eye) {
  const float rim =
      Rim(normal, to_eye, look.rim_exponent) * RimFrom(normal, light.to_rim, look.rim_from);
  return light.rim * glm::mix(colour, glm::vec3(1.0f), 0.25f) * rim;
}

inline glm::vec3 ShadeHair(const LightSet& light, const HairLook& look, const HairPoint& p) {
  const glm::vec3 deep = CoatColour(look, p.colour, p.depth_light);
  const glm::vec3 sunlit = CoatColour(look, p.colour, p.depth_light * p.sun_share);
  const glm::vec3 sun = light.sun * WrapDiffuse(glm::dot(p.normal, light.to_sun), look.wrap);
  const glm::vec3 through = TransmittedColour(p.colour) * (look.backlight * p.depth_light);
  glm::vec3 sum = sunlit * sun * HairDiffuse(p.tangent, light.to_sun);
  sum += deep * 0.5f *
         (ShLight(light.sky, p.normal, kShLambert) + ShLight(light.sky, p.tangent, kShHair));
  sum += Highlights(look, p, light.to_sun) * sun * (p.sun_share * p.depth_light);
  sum += through * light.sun *
         (p.sun_share * Backlight(p.tangent, light.to_sun, p.to_eye, look.backlight_exponent));
  sum += through * glm::max(light.rim, glm::vec3(0.0f)) *
         Backlight(p.tangent, light.to_rim, p.to_eye, look.backlight_exponent);
  return AddRim(sum, OutlineLight(light, look, p.colour, p.normal, p.to_eye) * p.depth_light);
}

// Skin, of its own or below hair that leaves `depth_light` of the light there.
inline glm::vec3 ShadeSkin(const LightSet& light, const HairLook& look, const glm::vec3& colour,
                           const glm::vec3& normal, const glm::vec3& to_eye, float depth_light,
                           float sun_share) {
  const float facing = std::max(glm::dot(normal, light.to_sun), 0.0f);
  const glm::vec3 sum =
      CoatColour(look, colour, depth_light * sun_share) * light.sun * facing +
      CoatColour(look, colour, depth_light) * ShLight(light.sky, normal, kShLambert);
  return AddRim(sum, OutlineLight(light, look, colour, normal, to_eye) * depth_light);
}

}  // namespace pelt
