// Symmetric systems as small as a strand has nodes, a lane each: solved in place, without pivots,
// because the matrices are near positive definite wherever a result is accepted.
#pragma once

#include <cstdint>

#include "core/simd.hpp"

namespace pelt::modal {

// L D L^T of a symmetric matrix: L D in its lower half, 1 / D in `inverse`. No pivots: the matrix
// is near positive definite wherever the result is accepted.
template <class W, uint32_t N>
PELT_INLINE void Factor(W (&a)[N][N], W (&inverse)[N]) {
  PELT_UNROLL
  for (uint32_t i = 0; i < N; ++i) {
    inverse[i] = W(1.0f) / a[i][i];
    PELT_UNROLL
    for (uint32_t r = i + 1; r < N; ++r) {
      const W factor = a[r][i] * inverse[i];
      PELT_UNROLL
      for (uint32_t c = i + 1; c <= r; ++c) a[r][c] = a[r][c] - factor * a[c][i];
    }
  }
}

// Solves for b in place.
template <class W, uint32_t N>
PELT_INLINE void SolveFactored(const W (&a)[N][N], const W (&inverse)[N], W (&b)[N]) {
  PELT_UNROLL
  for (uint32_t i = 0; i < N; ++i) {
    b[i] = b[i] * inverse[i];
    PELT_UNROLL
    for (uint32_t r = i + 1; r < N; ++r) b[r] = b[r] - a[r][i] * b[i];
  }
  PELT_UNROLL
  for (uint32_t k = 1; k < N; ++k) {
    const uint32_t i = N - 1 - k;
    W sum = a[i + 1][i] * b[i + 1];
    PELT_UNROLL
    for (uint32_t j = i + 2; j < N; ++j) sum = sum + a[j][i] * b[j];
    b[i] = b[i] - sum * inverse[i];
  }
}

// The Newton matrix, factorised.
template <class W, uint32_t N>
struct NewtonMatrix {
  W lower[N][N], inverse[N];
};

}  // namespace pelt::modal
