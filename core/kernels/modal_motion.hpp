// A group of modal chains while it moves, one axis at a time, and the small products with the
// table's matrices that its steps are made of.
#pragma once

#include "core/kernels/modal_matrix.hpp"
#include "core/modal/modal_block.hpp"
#include "core/simd.hpp"

namespace pelt::modal {

// What moves and what pushes it, along one axis, in parts of the strand.
template <class W, uint32_t N>
struct Axis {
  W d[N];        // tangents at the nodes
  W z[N];        // dD/dt by mode, 1/s
  W bend[4][N];  // T = omega^2 Phi^T M r by mode, and its backward differences
  W force[N];    // T with gravity and wind: what pushes the modes all frame long, 1/s^2
  W root[3];     // the root's backward differences
  W curl[N];     // what a curl that turns with the strand adds to it over a substep; else not set
  W wind_step;   // the wind's change since last frame, parts/s^2
  W rest[N];     // rest directions; set only where the curl follows its parent or motion is limited
  // Of one substep: the free motion's tangents; d + y and (best tier) y - d, as they are expected; the
  // constrained tangents.
  W p[N], w[N], turn[N], y[N];
};

template <class W, uint32_t N>
struct Motion {
  Axis<W, N> axis[3];
  W lambda[N];  // multipliers of the lengths
};

template <class W, uint32_t N>
PELT_INLINE Vec3<W> Row(const Motion<W, N>& m, W (Axis<W, N>::*row)[N], uint32_t i) {
  return {(m.axis[0].*row)[i], (m.axis[1].*row)[i], (m.axis[2].*row)[i]};
}
template <class W>
PELT_INLINE W Component(const Vec3<W>& v, uint32_t axis) {
  return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

// What places go with the vectors `row`, from those at which they stand at rest.
template <class W, uint32_t N, uint32_t Q>
PELT_INLINE void PlaceRows(const ModalTableBlock& t, const Motion<W, N>& m, W (Axis<W, N>::*row)[N],
                           const Vec3<W> (&base)[Q], Vec3<W> (&at)[Q]) {
  PELT_UNROLL
  for (uint32_t q = 0; q < Q; ++q) {
    at[q] = base[q] + Row(m, row, 0) * W(t.place[q][0]);
    PELT_UNROLL
    for (uint32_t i = 1; i < N; ++i) at[q] = at[q] + Row(m, row, i) * W(t.place[q][i]);
  }
}
// The same of vectors a node each: one place, and all.
template <class W, uint32_t N, uint32_t Q>
PELT_INLINE Vec3<W> PlaceOf(const ModalTableBlock& t, uint32_t q, const Vec3<W> (&d)[N],
                            const Vec3<W> (&base)[Q]) {
  Vec3<W> at = base[q] + d[0] * W(t.place[q][0]);
  PELT_UNROLL
  for (uint32_t i = 1; i < N; ++i) at = at + d[i] * W(t.place[q][i]);
  return at;
}
template <class W, uint32_t N, uint32_t Q>
PELT_INLINE void PlaceVectors(const ModalTableBlock& t, const Vec3<W> (&d)[N],
                              const Vec3<W> (&base)[Q], Vec3<W> (&at)[Q]) {
  PELT_UNROLL
  for (uint32_t q = 0; q < Q; ++q) at[q] = PlaceOf(t, q, d, base);
}

// Copies of a substep what a contact reads or changes; y follows from it.
template <bool kBest, class W, uint32_t N>
PELT_INLINE void CopyStep(const Motion<W, N>& from, Motion<W, N>& to) {
  PELT_UNROLL
  for (uint32_t i = 0; i < N; ++i) {
    to.lambda[i] = from.lambda[i];
    for (uint32_t k = 0; k < 3; ++k) {
      const Axis<W, N>& a = from.axis[k];
      Axis<W, N>& b = to.axis[k];
      b.d[i] = a.d[i];
      b.p[i] = a.p[i];
      b.w[i] = a.w[i];
      if constexpr (kBest) b.turn[i] = a.turn[i];
    }
  }
}

// Takes those lanes of what a frame changes.
template <class W, uint32_t N>
PELT_INLINE void TakeLanes(typename W::Mask lanes, const Motion<W, N>& from, Motion<W, N>& to) {
  for (uint32_t i = 0; i < N; ++i) {
    for (uint32_t k = 0; k < 3; ++k) {
      to.axis[k].d[i] = Select(lanes, from.axis[k].d[i], to.axis[k].d[i]);
      to.axis[k].z[i] = Select(lanes, from.axis[k].z[i], to.axis[k].z[i]);
    }
    to.lambda[i] = Select(lanes, from.lambda[i], to.lambda[i]);
  }
}

// Row `weights` of a matrix times a column.
template <class W, uint32_t N>
PELT_INLINE W Weigh(const float (&weights)[kMaxNodes], const W (&v)[N]) {
  W sum = v[0] * W(weights[0]);
  PELT_UNROLL
  for (uint32_t j = 1; j < N; ++j) sum = sum + v[j] * W(weights[j]);
  return sum;
}

// Column `column` of a matrix times a column.
template <class W, uint32_t N>
PELT_INLINE W WeighColumn(const float (&matrix)[kMaxNodes][kMaxNodes], uint32_t column,
                          const W (&v)[N]) {
  W sum = v[0] * W(matrix[0][column]);
  PELT_UNROLL
  for (uint32_t j = 1; j < N; ++j) sum = sum + v[j] * W(matrix[j][column]);
  return sum;
}

template <class W>
PELT_INLINE W WeighRoot(const float (&weights)[kModalSamples - 1], const W (&root)[3]) {
  return root[0] * W(weights[0]) + root[1] * W(weights[1]) + root[2] * W(weights[2]);
}

}  // namespace pelt::modal
