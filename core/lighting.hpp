// What lights a scene's fur: point and sphere lights, irradiance samples, a sun and a rim light.
// Plain data; no light unless one is given.
//
// Lights and samples are gathered for each layer as spherical harmonics
// (core/kernels/light_layer.hpp); sun and rim are handed on to the renderer, which shades with them
// per pixel.
#pragma once

#include <cstdint>

namespace pelt {

inline constexpr uint32_t kLightsPerScene = 8;
inline constexpr uint32_t kIrradianceSamplesPerScene = 12;

// A ball that shines; of radius 0 a point. Colours are linear. At distance D a patch that faces it
// receives rgb / D^2, inside the ball as much as on its surface.
struct SphereLight {
  float position[3] = {};  // m, world
  float radius = 0.0f;     // m
  float rgb[3] = {};       // irradiance at 1 m
  float range = 0.0f;      // m: falls to 0 there, by (1 - (D / range)^2)^2; 0: reaches everywhere
};

// What was measured, or painted, of the surroundings at one place: a sky above a ground.
struct IrradianceSample {
  float position[3] = {};            // m, world
  float falloff = 1.0f;              // m: its weight falls to 0 there
  float sky[3] = {};                 // radiance, linear
  float ground[3] = {};              // likewise
  float up[3] = {0.0f, 1.0f, 0.0f};  // unit, world
};

struct Lighting {
  uint32_t light_count = 0;   // of `light`; the rest is not looked at
  uint32_t sample_count = 0;  // of `sample`
  SphereLight light[kLightsPerScene];
  IrradianceSample sample[kIrradianceSamplesPerScene];
  float sun_direction[3] = {0.0f, 1.0f, 0.0f};  // unit, towards it
  float sun_rgb[3] = {};                        // what a white patch that faces it reflects
  float rim_direction[3] = {0.0f, 1.0f, 0.0f};  // unit, the side that has the rim
  float rim_rgb[3] = {};                        // below 0: darkens
  float rim_exponent = 3.0f;                    // of 1 - |normal . view|
};

}  // namespace pelt
