// How far a place is from a layer's bounding box: what level of detail, shells and the modal
// solver's quality go by.
#pragma once

#include "core/float_rules.hpp"
#include "core/layer.hpp"
#include "core/simd.hpp"

namespace pelt {

// Square of the distance from a place to a box, m^2; 0 inside.
PELT_INLINE float SquaredDistance(const float (&place)[3], const BoundsBlock& box) {
  float sum = 0.0f;
  for (int axis = 0; axis < 3; ++axis) {
    const float below = box.low[axis] - place[axis], above = place[axis] - box.high[axis];
    const float gap = below > 0.0f ? below : above > 0.0f ? above : 0.0f;
    sum = sum + gap * gap;
  }
  return sum;
}

}  // namespace pelt
