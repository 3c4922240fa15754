// Lanes of a chunk that are picked from its groups, and worked on as full groups of their own: where few lanes
// of many groups need what costs most.
//
// All that goes through memory is in here: what a console's price is must not depend on where a compiler puts
// temporaries.
#pragma once

#include <cstdint>

#include "core/chunk.hpp"
#include "core/simd.hpp"

namespace pelt {

// V: the groups that lanes are picked from.
template <class V>
struct LaneList {
  alignas(64) float is_picked[V::kLanes];
  uint32_t count;
  // And one that is written in vain. Bytes: it lies on a worker's stack.
  uint8_t lane[kStrandsPerChunk + 1];
  static_assert(kStrandsPerChunk <= 256);

  // Of the lanes from `first` on.
  PELT_INLINE void Add(typename V::Mask picked, uint32_t first) {
    Select(picked, V(1.0f), V(0.0f)).Store(is_picked);
    uint32_t end = count;
    for (uint32_t l = 0; l < uint32_t(V::kLanes); ++l) {
      lane[end] = uint8_t(first + l);
      end += is_picked[l] != 0.0f ? 1 : 0;
    }
    count = end;
  }
  // Those from the list's place `first` on, in `group`, which the last one fills up.
  template <class W>
  PELT_INLINE const PickedLanes<W>& Group(uint32_t first, PickedLanes<W>& group) const {
    for (uint32_t l = 0; l < uint32_t(W::kLanes); ++l)
      group.lane[l] = lane[first + l < count ? first + l : count - 1];
    return group;
  }
};

namespace modal {

// Lanes that step by one code: all, as if they were free; of those that were picked, what touches something and
// does no more, where that has a code of its own; the others.
enum class Lot { kFree, kPlain, kRare };

// How many of them step at once, on a stack as small as a fibre's (jobs/README.md).
template <class V>
struct LanesOf {
  using Free = typename AtMostLanes<V, 16>::Type;
  using Plain = typename AtMostLanes<V, 8>::Type;
  using Rare = typename AtMostLanes<V, 4>::Type;
};

}  // namespace modal

}  // namespace pelt
