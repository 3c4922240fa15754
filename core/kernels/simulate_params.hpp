// What every layer's solver is told about the scene this frame.
#pragma once

#include <cstdint>

#include "core/chunk.hpp"

namespace pelt {

struct SimulateParams {
  float dt;              // s, > 0
  float rest_threshold;  // a chain none of whose points moved more than this share of a segment
                         // keeps its bits; 0: never
  uint32_t use_ground;
  uint32_t sphere_count;
  float ground[4];                    // world: unit normal n and d; free space is n . x + d >= 0
  float sphere[kSpheresPerScene][4];  // world: centre, radius, m
};

inline constexpr float kRestThreshold =
    2.0e-4f;  // default; see tests/kernels for the bias it costs

}  // namespace pelt
