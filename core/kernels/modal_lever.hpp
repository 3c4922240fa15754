// How points of a chain, each somewhere on a link of its own, give way to pushes along given normals while its links keep their
// length: the contacts' Schur complement of the lengths (modal_touch.hpp has the formulas). For
// forces over a substep and for impulses.
#pragma once

#include "core/kernels/modal_matrix.hpp"

namespace pelt::modal {

// Sweeps over the contacts of one chain; they act on each other.
inline constexpr int kTouchSweeps = 4;
// A point can hardly be pushed along its links: this share of what it would give way without them.
inline constexpr float kLeastGive = 0.02f;

// What unit forces (impulses) along normals at the points do, the lengths kept.
template <class W, uint32_t N>
struct Levers {
  W give[N][N];    // [point][link]: without the lengths
  W hold[N][N];    // [point][link]: multipliers that keep the lengths
  W matrix[N][N];  // [point][point], symmetric

  // `on`: where on its link a point is; 1: at its end. `share` of b . kappa: 1/2 where the lengths'
  // directions are d + p, 1 where they are d.
  PELT_INLINE void Make(const float (&response)[N][N], const Vec3<W> (&along)[N],
                        const NewtonMatrix<W, N>& lengths, const Vec3<W> (&normal)[N],
                        const W (&on)[N], float share) {
    W b[N][N];
    PELT_UNROLL
    for (uint32_t q = 0; q < N; ++q) {
      PELT_UNROLL
      for (uint32_t i = 0; i < N; ++i) {
        float above = 0.0f;
        PELT_UNROLL
        for (uint32_t j = 0; j < q; ++j) above = j == 0 ? response[i][0] : above + response[i][j];
        const W own = W(response[i][q]) * on[q];
        give[q][i] = q == 0 ? own : W(above) + own;
        b[q][i] = Dot(normal[q], along[i]) * give[q][i];
        hold[q][i] = W(0.0f) - b[q][i];
      }
      SolveFactored<W, N>(lengths.lower, lengths.inverse, hold[q]);
    }
    PELT_UNROLL
    for (uint32_t r = 0; r < N; ++r) PELT_UNROLL
    for (uint32_t q = 0; q <= r; ++q) {
      W bare = give[q][0];
      PELT_UNROLL
      for (uint32_t i = 1; i < r; ++i) bare = bare + give[q][i];
      const W own = give[q][r] * on[r];
      bare = r == 0 ? own : bare + own;
      W sum = b[r][0] * hold[q][0];
      PELT_UNROLL
      for (uint32_t j = 1; j < N; ++j) sum = sum + b[r][j] * hold[q][j];
      matrix[r][q] = Dot(normal[r], normal[q]) * bare + sum * W(share);
      if (r == q) matrix[r][r] = Max(matrix[r][r], W(kLeastGive) * bare);
      matrix[q][r] = matrix[r][q];
    }
  }

  // Pushes that bring about `wanted`, each at least `least`.
  PELT_INLINE void Solve(const W (&wanted)[N], const W (&least)[N], W (&push)[N]) const {
    W inverse[N];
    PELT_UNROLL
    for (uint32_t q = 0; q < N; ++q) {
      push[q] = W(0.0f);
      inverse[q] = W(1.0f) / matrix[q][q];
    }
    PELT_NO_UNROLL
    for (int sweep = 0; sweep < kTouchSweeps; ++sweep) PELT_UNROLL
    for (uint32_t q = 0; q < N; ++q) {
      W left = wanted[q];
      PELT_UNROLL
      for (uint32_t r = 0; r < N; ++r) left = left - matrix[q][r] * push[r];
      push[q] = Max(push[q] + left * inverse[q], least[q]);
    }
  }

  // Multipliers of the lengths that go with the pushes.
  PELT_INLINE void Hold(const W (&push)[N], W (&multiplier)[N]) const {
    PELT_UNROLL
    for (uint32_t j = 0; j < N; ++j) {
      multiplier[j] = hold[0][j] * push[0];
      PELT_UNROLL
      for (uint32_t q = 1; q < N; ++q) multiplier[j] = multiplier[j] + hold[q][j] * push[q];
    }
  }
};

}  // namespace pelt::modal
