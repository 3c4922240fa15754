// Impulses on points of a chain while its links keep their length: what a contact does to speeds.
#pragma once

#include "core/kernels/modal_lever.hpp"
#include "core/kernels/modal_motion.hpp"

namespace pelt::modal {

// How rates answer to impulses, M^-1, and the lengths' matrix of directions `d` in it.
template <class W, uint32_t N>
struct ImpulseMetric {
  float response[N][N];
  NewtonMatrix<W, N> lengths;

  PELT_INLINE ImpulseMetric(const ModalTable<N>& t, const Vec3<W> (&d)[N]) {
    PELT_UNROLL
    for (uint32_t i = 0; i < N; ++i) {
      PELT_UNROLL
      for (uint32_t j = 0; j < N; ++j)
        response[i][j] = i == j       ? t.inverse_mass[i]
                         : i == j + 1 ? t.inverse_mass_off[j]
                         : j == i + 1 ? t.inverse_mass_off[i]
                                      : 0.0f;
      PELT_UNROLL
      for (uint32_t j = 0; j <= i; ++j) lengths.lower[i][j] = Dot(d[i], d[j]) * W(response[i][j]);
    }
    Factor<W, N>(lengths.lower, lengths.inverse);
  }
};

// Gives lanes the impulses; `share`: where on its link a point is, `hold`: multipliers that keep the
// lengths of links that point along `d`.
template <class W, uint32_t N>
PELT_INLINE void AddImpulses(const ModalTable<N>& t, const Vec3<W> (&impulse)[N],
                             const W (&share)[N], const Vec3<W> (&d)[N], const W (&hold)[N],
                             typename W::Mask lanes, Motion<W, N>& motion) {
  for (uint32_t k = 0; k < 3; ++k) {
    Axis<W, N>& a = motion.axis[k];
    W pull[N];
    W sum = W(0.0f);
    PELT_UNROLL
    for (uint32_t i = 0; i < N; ++i) {
      const uint32_t j = N - 1 - i;
      const W own = Component(impulse[j], k), on_link = sum + own * share[j];
      sum = sum + own;
      pull[j] = on_link + Component(d[j], k) * hold[j];
    }
    PELT_UNROLL
    for (uint32_t m = 0; m < N; ++m)
      a.z[m] = Select(lanes, a.z[m] + WeighColumn<W, N>(t.shape, m, pull), a.z[m]);
  }
}

}  // namespace pelt::modal
