// Where the lanes of a group stand in a chunk's rows: side by side from a first one on, or picked
// one by one, so that the few lanes of many groups that need more work make full groups.
//
// Code that is to run on both takes the place as a parameter `at` of its own type: a uint32_t, the
// first lane, or PickedLanes<V>.
//
// Invariant: only data moves here; a lane's bits do not depend on where it stood in its group.
#pragma once

#include <cstdint>

#include "core/simd/maths.hpp"
#include "core/simd/records.hpp"
#include "core/simd/vec.hpp"

namespace pelt {

// A lane may be there twice: both are the same, and so is what is stored of them.
template <class V>
struct PickedLanes {
  alignas(64) int32_t lane[V::kLanes];
};

template <class V>
PELT_INLINE V LoadLanes(const float* row, uint32_t first) {
  return V::Load(row + first);
}
template <class V>
PELT_INLINE V LoadLanes(const float* row, const PickedLanes<V>& at) {
  if constexpr (requires { V::LoadPicked(row, at.lane); }) return V::LoadPicked(row, at.lane);
#if defined(__AVX2__)
  const auto eight = [&](int first) __attribute__((always_inline)) {
    const void* lanes = at.lane + first;
    return _mm256_i32gather_ps(row, _mm256_load_si256(static_cast<const __m256i*>(lanes)), 4);
  };
  if constexpr (simd_detail::IsRegister<V> && V::kLanes == 8) return V(typename V::Raw(eight(0)));
  // Two halves: g++ 12 does not compile its own 512-bit gather without optimisation.
  if constexpr (simd_detail::IsRegister<V> && V::kLanes == 16) {
    const __m256 low = eight(0), high = eight(8);
    return V(typename V::Raw(
        __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15)));
  }
#endif
  alignas(64) float lanes[V::kLanes];
  for (int l = 0; l < V::kLanes; ++l) lanes[l] = row[at.lane[l]];
  return V::Load(lanes);
}

template <class V>
PELT_INLINE void StoreLanes(V a, float* row, uint32_t first) {
  a.Store(row + first);
}
template <class V>
PELT_INLINE void StoreLanes(V a, float* row, const PickedLanes<V>& at) {
  if constexpr (requires { V::StorePicked(a, row, at.lane); })
    return V::StorePicked(a, row, at.lane);
  alignas(64) float lanes[V::kLanes];
  a.Store(lanes);
  PELT_UNROLL
  for (int l = 0; l < V::kLanes; ++l) row[at.lane[l]] = lanes[l];
}

// The lanes' numbers.
template <class V>
PELT_INLINE typename V::Int NumberLanes(uint32_t first) {
  return V::Int::Iota(int32_t(first));
}
template <class V>
PELT_INLINE typename V::Int NumberLanes(const PickedLanes<V>& at) {
  return V::Int::Load(at.lane);
}

// Three rows (x, y, z) of one block.
template <class V, int S, class At>
PELT_INLINE Vec3<V> Load3(const float (&rows)[3][S], const At& at) {
  return {LoadLanes<V>(rows[0], at), LoadLanes<V>(rows[1], at), LoadLanes<V>(rows[2], at)};
}
template <class V, int S>
PELT_INLINE void Store3(float (&rows)[3][S], uint32_t lane, Vec3<V> a) {
  a.x.Store(rows[0] + lane);
  a.y.Store(rows[1] + lane);
  a.z.Store(rows[2] + lane);
}

}  // namespace pelt
