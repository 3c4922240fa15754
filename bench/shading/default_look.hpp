// The light and the hair that a picture has by default: a warm sun, a pale sky over a darker floor,
// a cool light behind.
#pragma once

#include "bench/shading/shading.hpp"
#include "core/groom/layer_look.hpp"

namespace pelt {

inline LightSet DefaultLights() {
  LightSet light{};
  light.to_sun = glm::normalize(glm::vec3(0.45f, 0.8f, 0.55f));
  light.sun = {1.80f, 1.64f, 1.40f};
  light.to_rim = glm::normalize(glm::vec3(-0.6f, 0.45f, -0.65f));
  light.rim = {1.00f, 1.08f, 1.25f};
  const glm::vec3 sky(0.70f, 0.78f, 0.95f), floor(0.46f, 0.40f, 0.38f), up(0.0f, 1.0f, 0.0f);
  const glm::vec4 half = ShHemisphere() * ShWindow(6.0f);
  ShAddZonal(up, half, sky, light.sky);
  ShAddZonal(-up, half, floor, light.sky);
  return light;
}

// A layer's look under a light whose rim has this exponent.
constexpr HairLook HairLookOf(const LayerLook& look, float rim_exponent) {
  return {.tint = glm::vec3(look.tint[0], look.tint[1], look.tint[2]),
          .primary = look.specular,
          .primary_exponent = look.specular_exponent,
          .primary_shift = look.specular_shift,
          .secondary = look.second,
          .secondary_exponent = look.second_exponent,
          .secondary_shift = look.second_shift,
          .noise = look.specular_noise,
          .wrap = look.wrap,
          .rim = look.rim,
          .rim_exponent = rim_exponent,
          .rim_from = look.rim_from,
          .backlight = look.backlight,
          .backlight_exponent = look.backlight_exponent,
          .scatter = look.scatter,
          .scatter_depth = look.scatter_depth};
}
inline constexpr float kDefaultRimExponent = 3.0f;
inline constexpr HairLook kDefaultHair = HairLookOf({}, kDefaultRimExponent);
// Paint of a layer that has none of its own colours: nothing is darkened.
inline constexpr PaintLook kDefaultPaint{.wet_darken = 1.0f,
                                         .mud = {0.25f, 0.18f, 0.10f},
                                         .snow = {0.86f, 0.89f, 0.94f},
                                         .dust = {0.56f, 0.51f, 0.44f}};
// Light left at the skin below hair.
inline constexpr float kDefaultDepthFloor = 0.22f;

// What a coat keeps from the sun: SelfShadow's values.
struct ShadowLook {
  float bias, falloff, strength;  // m, 1/m, share
};
inline constexpr ShadowLook kDefaultShadow{.bias = 0.004f, .falloff = 45.0f, .strength = 0.9f};

struct PictureLook {
  LightSet light;
  HairLook hair;
  ShadowLook shadow;
  float depth_floor;     // light left at the skin below hair
  glm::vec3 room{1.0f};  // how bright floor and wall are, of a studio's
};
inline PictureLook DefaultLook() {
  return {DefaultLights(), kDefaultHair, kDefaultShadow, kDefaultDepthFloor, glm::vec3(1.0f)};
}

}  // namespace pelt
