// The light and the hair that a picture has by default: a warm sun, a pale sky over a darker floor,
// a cool light behind.
#pragma once

#include "bench/shading/shading.hpp"

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

inline constexpr HairLook kDefaultHair{.primary = 0.10f,
                                       .primary_exponent = 90.0f,
                                       .primary_shift = 0.1f,
                                       .secondary = 0.55f,
                                       .secondary_exponent = 28.0f,
                                       .secondary_shift = 0.1f,
                                       .noise = 0.7f,
                                       .wrap = 0.4f,
                                       .rim_exponent = 3.0f,
                                       .rim_from = 0.8f,
                                       .backlight = 0.35f,
                                       .backlight_exponent = 6.0f,
                                       .scatter = 0.6f,
                                       .scatter_depth = 1.0f};
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
