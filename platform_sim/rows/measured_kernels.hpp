// Kernels that were measured on a console and whose source is known, written on the vector type:
// the work of the rows in kernel_rows.hpp, from what is published of it. Nothing here knows what
// was measured.
//
// Each is written as its source says, statement by statement, because the order of the source is
// one end of its price.
#pragma once

#include <cstdint>
#include <type_traits>

#include "core/simd/maths.hpp"
#include "core/simd/records.hpp"
#include "core/simd/words.hpp"

namespace pelt {

// What code for a console uses and Pelt's own kernels do not, for any vector value V: estimates
// without a Newton step, and a number of memory on all lanes.
//
// A type that records takes each as one operation (recording_vec.hpp); others compute it exactly,
// so a kernel written with these can be run anywhere.

template <class V>
V ReciprocalEstimate(V a) {
  if constexpr (requires { V::ReciprocalEstimate(a); })
    return V::ReciprocalEstimate(a);
  else
    return V(1.0f) / a;
}
template <class V>
V ReciprocalRootEstimate(V a) {
  if constexpr (requires { V::ReciprocalRootEstimate(a); })
    return V::ReciprocalRootEstimate(a);
  else
    return Rsqrt(a);
}

// base[index] on all lanes; the index is a word of V or a plain number.
template <class V, class Index>
V LoadSplat(const float* base, Index index) {
  if constexpr (requires { V::LoadSplat(base, index); })
    return V::LoadSplat(base, index);
  else
    return V(base[index]);
}

// ---- N-body ----------------------------------------------------------------------------------

inline constexpr uint32_t kBodies = 4080;
struct alignas(128) Bodies {
  float x[kBodies], y[kBodies], z[kBodies], mass[kBodies];
};
struct alignas(128) Pulls {
  float lanes[3][16];
};

// What all bodies pull on one, one iteration per vector of them; sums stay in lanes.
template <class V>
void PullOnBody(const Bodies& bodies, uint32_t body, Pulls& out) {
  const V x = LoadSplat<V>(bodies.x, body), y = LoadSplat<V>(bodies.y, body),
          z = LoadSplat<V>(bodies.z, body);
  V sum_x(0.0f), sum_y(0.0f), sum_z(0.0f);
  for (uint32_t j = 0; j < kBodies; j += uint32_t(V::kLanes)) {
    const V dx = V::Load(bodies.x + j) - x;
    const V dy = V::Load(bodies.y + j) - y;
    const V dz = V::Load(bodies.z + j) - z;
    V squared = V(1e-4f);
    squared = dx * dx + squared;
    squared = dy * dy + squared;
    squared = dz * dz + squared;
    const V inverse = ReciprocalRootEstimate(squared);
    const V inverse_squared = inverse * inverse;
    const V pull = V::Load(bodies.mass + j) * inverse_squared * inverse;
    sum_x = pull * dx + sum_x;
    sum_y = pull * dy + sum_y;
    sum_z = pull * dz + sum_z;
  }
  sum_x.Store(out.lanes[0]);
  sum_y.Store(out.lanes[1]);
  sum_z.Store(out.lanes[2]);
}

// ---- FFT -------------------------------------------------------------------------------------

// 1,024 points, radix 2, four transforms side by side in the lanes.
inline constexpr uint32_t kFftPoints = 1024;
struct alignas(128) FftData {
  float re[kFftPoints][4], im[kFftPoints][4];
};
struct alignas(128) FftTables {
  float cosine[kFftPoints / 2], sine[kFftPoints / 2];
  uint32_t reversed[kFftPoints];
  uint32_t zero;
};

// One iteration per butterfly.
template <class V>
void FftButterflies(const FftTables& tables, FftData& data) {
  static_assert(V::kLanes == 4);
  for (uint32_t size = 2; size <= kFftPoints; size *= 2)
    for (uint32_t first = 0; first < kFftPoints; first += size) {
      auto place = LoadWord<V>(&tables.zero, 0u);  // of the twiddle factor
      for (uint32_t a = first; a < first + size / 2; ++a) {
        const uint32_t b = a + size / 2;
        const V cosine = LoadSplat<V>(tables.cosine, place);
        const V sine = LoadSplat<V>(tables.sine, place);
        const V a_re = V::Load(data.re[a]), a_im = V::Load(data.im[a]);
        const V b_re = V::Load(data.re[b]), b_im = V::Load(data.im[b]);
        const V sine_im = sine * b_im;
        const V sine_re = sine * b_re;
        const V turned_re = cosine * b_re - sine_im;
        const V turned_im = cosine * b_im + sine_re;
        (a_re + turned_re).Store(data.re[a]);
        (a_im + turned_im).Store(data.im[a]);
        (a_re - turned_re).Store(data.re[b]);
        (a_im - turned_im).Store(data.im[b]);
        place += kFftPoints / size;
      }
    }
}

// One iteration per swap. Points that stay are a scalar compare and a branch each: not seen.
template <class V>
uint32_t FftReversal(const FftTables& tables, FftData& data) {
  uint32_t swaps = 0;
  for (uint32_t i = 0; i < kFftPoints; ++i) {
    const uint32_t j = tables.reversed[i];
    if (j <= i) continue;
    for (auto* points : {data.re, data.im}) {
      const auto mine = LoadRecordAs<V>(points[i]);
      const auto other = LoadRecordAs<V>(points[j]);
      StoreRecordAs<V>(points[i], other);
      StoreRecordAs<V>(points[j], mine);
    }
    ++swaps;
  }
  return swaps;
}

// ---- Newton steps ----------------------------------------------------------------------------

// Row C5: x becomes a half of 1 / sqrt(|x|), corrected, plus 1 / x; six chains, a step each in
// turn, eight times.
inline constexpr uint32_t kNewtonChains = 6, kNewtonSteps = 8;

template <class V>
void NewtonIterations(V (&x)[kNewtonChains], uint32_t iterations) {
  const V one(1.0f), half(0.5f);
  const auto each = [](auto step) {
    for (uint32_t c = 0; c < kNewtonChains; ++c) step(c);
  };
  for (uint32_t n = 0; n < iterations * kNewtonSteps; ++n) {
    V inverse[kNewtonChains], error[kNewtonChains], root[kNewtonChains], part[kNewtonChains];
    each([&](uint32_t c) { inverse[c] = ReciprocalEstimate(x[c]); });
    each([&](uint32_t c) { error[c] = one - x[c] * inverse[c]; });
    each([&](uint32_t c) { inverse[c] = error[c] * inverse[c] + inverse[c]; });
    each([&](uint32_t c) { root[c] = ReciprocalRootEstimate(Abs(x[c])); });
    each([&](uint32_t c) { part[c] = root[c] * half; });
    each([&](uint32_t c) { error[c] = one - part[c] * root[c]; });
    each([&](uint32_t c) { part[c] = root[c] * error[c]; });
    each([&](uint32_t c) { x[c] = part[c] * half + inverse[c]; });
  }
}

// ---- Matrix product --------------------------------------------------------------------------

// Row C13: C -= A * B, 64 x 64 each. The row's source is not published; this is the plain blocking
// of a machine with 128 registers: 4 x 16 of C in registers, one iteration for every four k.
inline constexpr uint32_t kMatrixSide = 64, kBlockRows = 4, kBlockColumns = 4,
                          kStepsPerIteration = 4;
inline constexpr uint32_t kMatrixIterations = kMatrixSide / kBlockRows *
                                              (kMatrixSide / (4 * kBlockColumns)) *
                                              (kMatrixSide / kStepsPerIteration);
struct alignas(128) Matrix {
  float row[kMatrixSide][kMatrixSide];
};

template <class V>
void SubtractProduct(const Matrix& a, const Matrix& b, Matrix& c) {
  static_assert(V::kLanes == 4);
  for (uint32_t i = 0; i < kMatrixSide; i += kBlockRows)
    for (uint32_t j = 0; j < kMatrixSide; j += 4 * kBlockColumns) {
      V sum[kBlockRows][kBlockColumns];
      for (uint32_t r = 0; r < kBlockRows; ++r)
        for (uint32_t s = 0; s < kBlockColumns; ++s) sum[r][s] = V::Load(&c.row[i + r][j + 4 * s]);
      for (uint32_t k = 0; k < kMatrixSide; k += kStepsPerIteration) {
        V four[kBlockRows];
        for (uint32_t r = 0; r < kBlockRows; ++r) four[r] = V::Load(&a.row[i + r][k]);
        const auto step = [&]<int kLane>(std::integral_constant<int, kLane>) {
          V row[kBlockColumns];
          for (uint32_t s = 0; s < kBlockColumns; ++s)
            row[s] = V::Load(&b.row[k + kLane][j + 4 * s]);
          for (uint32_t r = 0; r < kBlockRows; ++r) {
            const V spread = SplatInFours<kLane>(four[r]);
            for (uint32_t s = 0; s < kBlockColumns; ++s) sum[r][s] = sum[r][s] - spread * row[s];
          }
        };
        step(std::integral_constant<int, 0>());
        step(std::integral_constant<int, 1>());
        step(std::integral_constant<int, 2>());
        step(std::integral_constant<int, 3>());
      }
      for (uint32_t r = 0; r < kBlockRows; ++r)
        for (uint32_t s = 0; s < kBlockColumns; ++s) sum[r][s].Store(&c.row[i + r][j + 4 * s]);
    }
}

}  // namespace pelt
