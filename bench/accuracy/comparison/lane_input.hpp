// What a comparison solver reads of a frame, for one group of lanes, and the state every one of
// them keeps about the root.
//
// Between frames the root and the rest directions are not known; each method fills them in as its
// users do. The position-based ones and implicit Euler move them linearly from sample to sample
// (OverSubsteps below); the trapezoid puts a cubic through the last four samples.
#pragma once

#include "core/simd/maths.hpp"

namespace pelt::accuracy {

template <class V, int n>
struct LaneInput {
  Vec3<V> motion;   // of the root since the last frame, m
  Vec3<V> rest[n];  // unit
  Vec3<V> wind;     // m/s
};

template <class V>
PELT_INLINE Vec3<V> SplatRow(const float (&v)[3]) {
  return {V(v[0]), V(v[1]), V(v[2])};
}

// The input at the end of substep s of `substeps`, on the straight line from the last frame's.
template <class V, int n>
PELT_INLINE void Halfway(const LaneInput<V, n>& last, const LaneInput<V, n>& next, int s,
                         int substeps, LaneInput<V, n>& now) {
  const V share = V(float(s + 1) / float(substeps));
  now.motion = next.motion * V(1.0f / float(substeps));
  now.wind = last.wind + (next.wind - last.wind) * share;
  for (int i = 0; i < n; ++i) now.rest[i] = last.rest[i] + (next.rest[i] - last.rest[i]) * share;
}

// Calls substep(before, now) with the input at both ends of each substep of a frame; `last` becomes
// `next`.
template <class V, int n, class Substep>
PELT_INLINE void OverSubsteps(LaneInput<V, n>& last, const LaneInput<V, n>& next, int substeps,
                              Substep&& substep) {
  LaneInput<V, n> before = last;
  for (int s = 0; s < substeps; ++s) {
    LaneInput<V, n> now;
    Halfway(last, next, s, substeps, now);
    substep(before, now);
    before = now;
  }
  last = next;
}

// Solves a x = b for n x n without pivots; a is destroyed, b becomes x.
template <class V, int n>
PELT_INLINE void SolveSmall(V (&a)[n][n], V (&b)[n]) {
  for (int i = 0; i < n; ++i) {
    const V inverse = V(1.0f) / a[i][i];
    for (int r = i + 1; r < n; ++r) {
      const V f = a[r][i] * inverse;
      for (int j = i + 1; j < n; ++j) a[r][j] = a[r][j] - f * a[i][j];
      b[r] = b[r] - f * b[i];
    }
    a[i][i] = inverse;
  }
  for (int i = n - 1; i >= 0; --i) {
    for (int j = i + 1; j < n; ++j) b[i] = b[i] - a[i][j] * b[j];
    b[i] = b[i] * a[i][i];
  }
}

}  // namespace pelt::accuracy
