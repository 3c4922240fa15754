#pragma once

#include <cstdint>

namespace pelt {

// A ball that paints the strands whose roots it holds, in every frame it is there.
struct PaintBrush {
  float centre[3] = {};   // m, world
  float radius = 0.0f;    // m
  float hardness = 0.0f;  // 0 to 1: share of the radius within which it paints all of `amount`
  uint32_t channel = 0;   // PaintChannel
  float amount = 0.0f;    // -1 to 1, of the most that a strand can have; below 0: takes away
};

}  // namespace pelt
