// What acts on a scene's fur from outside and kernels take as it was set: wind, lights, and brushes that paint it.
// Plain data; nothing blows, shines or paints unless it is given.
#pragma once

#include <cstdint>

namespace pelt {

// The wind of a frame, as the user sets it: mean velocity, which gusts make stronger and weaker along
// its direction, and turbulence, which it carries along. With velocity and turbulence 0 no wind
// blows. core/kernels/wind.hpp has what it does.
struct WindSetup {
  float velocity[3] = {0.0f, 0.0f, 0.0f};  // mean of the air over time, world, m/s
  float gust_strength = 0.0f;              // 0.5: gusts swing the velocity by up to half of it
  float gust_period_s = 4.0f;              // of the slowest sine; from 1e-3 on
  float turbulence = 0.0f;                 // most that an eddy adds along an axis, m/s
  float turbulence_scale_m = 1.0f;         // size of an eddy; from 1e-3 on
};

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

// What lights a scene's fur: point and sphere lights, irradiance samples, a sun and a rim light.
//
// Lights and samples are gathered for each layer as spherical harmonics
// (core/kernels/light_layer.hpp); sun and rim are handed on to the renderer, which shades with them
// per pixel.
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

// A ball that paints the strands whose roots it holds, in every frame it is there.
struct PaintBrush {
  float centre[3] = {};   // m, world
  float radius = 0.0f;    // m
  float hardness = 0.0f;  // 0 to 1: share of the radius within which it paints all of `amount`
  uint32_t channel = 0;   // PaintChannel
  float amount = 0.0f;    // -1 to 1, of the most that a strand can have; below 0: takes away
};

}  // namespace pelt
