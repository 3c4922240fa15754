// What mud, snow, water and dust do to hair and skin: to the colour that is lit, and to how it takes light.
// Amounts are 0 to 1; a vec4 of them is mud, snow, wet, dust, as a LookRecord has them. shaders/paint_shading.glsl has
// the same functions, by the same names.
//
// Wetness and mud tint sRGB values, as Pelt tints the colours of a layer that is not painted: both kinds of layer
// look alike in one weather.
#pragma once

#include "bench/view/strand_light.hpp"

namespace pelt {

struct PaintLook {
  float wet_darken;  // share of the brightness left of what is soaked; sRGB
  glm::vec3 mud;     // sRGB
  glm::vec3 snow, dust;
};

// colour * scale + add, in sRGB.
inline glm::vec3 TintColour(const glm::vec3& colour, float scale, const glm::vec3& add) {
  const auto tint = [&](int c) {
    return LinearFromSrgb(SrgbFromLinear(colour[c]) * scale + add[c]);
  };
  return {tint(0), tint(1), tint(2)};
}

inline glm::vec3 WetColour(const glm::vec3& colour, float wet, float darken) {
  return TintColour(colour, glm::mix(1.0f, darken, wet), glm::vec3(0.0f));
}

inline glm::vec3 MudColour(const glm::vec3& colour, float mud, const glm::vec3& mud_colour) {
  return TintColour(colour, 1.0f - mud, mud_colour * mud);
}

// Paler, and as grey as the dust.
inline glm::vec3 DustColour(const glm::vec3& colour, float dust, const glm::vec3& dust_colour) {
  const float grey = glm::dot(colour, glm::vec3(0.2126f, 0.7152f, 0.0722f));
  return glm::mix(colour, glm::mix(glm::vec3(grey), dust_colour, 0.5f), 0.8f * dust);
}

// An amount in clots: where the noise is low all of it is there early, where it is high late. None stays none, and all
// is all.
inline float Clotted(float amount, float noise) {
  return glm::smoothstep(0.5f * noise, 0.5f * noise + 0.5f, amount);
}

// Snow lies where the skin faces up.
inline float SnowCover(float snow, const glm::vec3& normal, float noise) {
  return Clotted(snow * glm::smoothstep(-0.3f, 0.5f, normal.y), noise);
}

// The amounts that are seen at a place: `noise` as StrandNoise.
inline glm::vec4 SeenPaint(const glm::vec4& paint, const glm::vec3& normal, float noise) {
  return {Clotted(paint.x, noise), SnowCover(paint.y, normal, noise), paint.z, paint.w};
}

// Water soaks in, dust lies on it, mud on both, snow on all. `paint` as SeenPaint.
inline glm::vec3 PaintedColour(const PaintLook& look, const glm::vec3& colour,
                               const glm::vec4& paint) {
  const glm::vec3 wet = WetColour(colour, paint.z, look.wet_darken);
  const glm::vec3 dusty = DustColour(wet, paint.w, look.dust);
  return glm::mix(MudColour(dusty, paint.x, look.mud), look.snow, paint.y);
}

// What lies on hair takes its shine, and snow scatters light on; water sharpens the highlights and joins hairs, so that
// noise breaks them up no more.
inline HairLook PaintedHair(const HairLook& hair, const glm::vec4& paint) {
  const float bare = (1.0f - 0.9f * paint.x) * (1.0f - 0.8f * paint.y);
  const float shine = bare * (1.0f - 0.8f * paint.w), wet = paint.z * bare;
  HairLook out = hair;
  out.primary = hair.primary * shine * (1.0f + 3.0f * wet);
  out.primary_exponent = hair.primary_exponent * (1.0f + wet);
  out.secondary = hair.secondary * shine * (1.0f + wet);
  out.secondary_exponent = hair.secondary_exponent * (1.0f + wet);
  out.noise = hair.noise * (1.0f - 0.8f * wet);
  out.backlight = hair.backlight * bare;
  out.scatter = glm::mix(hair.scatter, 1.0f, 0.8f * paint.y);
  return out;
}

}  // namespace pelt
