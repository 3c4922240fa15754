// What acts on a scene's fur from outside and kernels take as it was set: wind, force volumes, lights, and brushes that
// paint it. Plain data; nothing blows, pushes, shines or paints unless it is given.
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
  uint32_t kind = 0;                       // WindKind
};

// kPublished is that of Furry Scorpion, x = A + B sin(C (t + x)), z = D + E sin(F (t + z)), in m and s. A and D are
// the velocity, B and E the turbulence, C and F a turn in turbulence_scale_m; Perlin noise over gust_period_s swings
// each by up to gust_strength of it. As published t is not wrapped: with gusts the sines turn faster the later it is.
enum class WindKind : uint32_t { kGusts, kPublished };
inline constexpr uint32_t kWindKinds = 2;

// A ball or a box that pushes the strands whose roots it holds, or pulls them to its centre: what an animator has in
// place of wind where fur is to move as the story wants. It acts as wind does, on layers that do not answer to wind
// too. Free, or carried along by a joint, which may be one that moves no skin and is keyed for this alone.
enum class ForceShape : uint32_t { kBall, kBox };
enum class ForceKind : uint32_t { kPush, kPull };
inline constexpr uint32_t kForceShapes = 2, kForceKinds = 2;
struct ForceVolume {
  static constexpr uint32_t kFree = ~0u;
  float centre[3] = {};  // free: m, world; bound: in the joint's space, units of the character file
  // Along the world's axes or the joint's: the ball's radii, half the box's sides; m; from 1e-3 on.
  float half[3] = {1.0f, 1.0f, 1.0f};
  uint32_t shape = 0, kind = 0;             // ForceShape, ForceKind
  float direction[3] = {0.0f, 1.0f, 0.0f};  // of a push: unit, along the same axes
  float strength = 0.0f;                    // m/s^2; below 0: the other way
  float hardness = 0.0f;   // 0 to 1: share of the way out that has all of it; at the surface is 0
  uint32_t character = 0;  // whose joint it is; nothing to a free one
  uint32_t joint = kFree;  // as in Groom::joint_names
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
