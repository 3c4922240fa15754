// Impulses on points of a strand while its tangents keep their length: what a contact does to speeds.
#pragma once

#include "core/kernels/contact_schur.hpp"
#include "core/kernels/modal_motion.hpp"

namespace pelt::modal {

// How rates answer to impulses, M^-1, and the lengths' matrix of directions `d` in it.
template <class W, uint32_t N>
struct ImpulseMetric : PushMetric<W, N> {
  NewtonMatrix<W, N> matrix;

  PELT_INLINE ImpulseMetric(const ModalTableBlock& t, const Vec3<W> (&d)[N]) {
    PELT_UNROLL
    for (uint32_t i = 0; i < N; ++i) {
      this->along[i] = d[i];
      PELT_UNROLL
      for (uint32_t j = 0; j < N; ++j) this->response[i][j] = t.inverse_mass[i][j];
      PELT_UNROLL
      for (uint32_t j = 0; j <= i; ++j)
        matrix.lower[i][j] = Dot(d[i], d[j]) * W(t.inverse_mass[i][j]);
    }
    Factor<W, N>(matrix.lower, matrix.inverse);
    this->lengths = &matrix;
    this->share = 1.0f;
  }
};

// Gives lanes the impulses on points with those levers; `hold`: multipliers that keep the lengths of
// tangents `d`.
template <class W, uint32_t N, uint32_t Q>
PELT_INLINE void AddImpulses(const ModalTableBlock& t, const PushedPlaces<Q>& places,
                             const Vec3<W> (&impulse)[Q], const W (&lever)[Q][N],
                             const Vec3<W> (&d)[N], const W (&hold)[N], typename W::Mask lanes,
                             Motion<W, N>& motion) {
  for (uint32_t k = 0; k < 3; ++k) {
    Axis<W, N>& a = motion.axis[k];
    W pull[N];
    PELT_UNROLL
    for (uint32_t i = 0; i < N; ++i) {
      // From 0, so that it is never -0, and a place more that nothing pushes changes nothing.
      pull[i] = W(0.0f) + Component(d[i], k) * hold[i];
      for (const uint32_t q : places) pull[i] = pull[i] + Component(impulse[q], k) * lever[q][i];
    }
    PELT_UNROLL
    for (uint32_t m = 0; m < N; ++m)
      a.z[m] = Select(lanes, a.z[m] + WeighColumn<W, N>(t.shape, m, pull), a.z[m]);
  }
}

}  // namespace pelt::modal
