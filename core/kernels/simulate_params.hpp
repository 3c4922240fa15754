// What every layer's solver is given about the scene this frame.
#pragma once

#include <cstdint>

#include "core/chunk.hpp"

namespace pelt {

// A ball of `radius` swept along a straight axis, in the world, m.
struct CapsuleParams {
  float from[3];
  float radius;
  float axis[3];  // unit, from the one end to the other; 0: a sphere
  float length;
};

// How a collider came to its place in this frame.
struct ColliderStep {
  float from[3];     // its way in the world, m; of a capsule, that of its first end
  float to[3];       // of a capsule's other end; else the same
  uint32_t moves;    // 0: none of it; it stands still
  uint32_t at_once;  // not 0: it moved in an unknown way: what it overlaps gets out in one substep
};

struct SimulateParams {
  float dt;              // s, > 0
  float rest_threshold;  // a chain none of whose points moved more than this share of a segment
                         // keeps its bits; 0: never
  uint32_t use_ground;
  uint32_t sphere_count;
  float ground[4];                    // world: unit normal n and d; free space is n . x + d >= 0
  float sphere[kSpheresPerScene][4];  // world: centre, radius, m
  uint32_t capsule_count;
  CapsuleParams capsule[kCapsulesPerScene];
  // Modal layers alone see these.
  ColliderStep ground_step, sphere_step[kSpheresPerScene], capsule_step[kCapsulesPerScene];
};

inline constexpr float kRestThreshold =
    2.0e-4f;  // default; see tests/kernels for the bias it costs

}  // namespace pelt
