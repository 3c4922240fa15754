// What bends a modal chain, apart from how it was combed.
//
// With u = d - r what the tangents are bent by, K the stiffness and lambda the multipliers of the
// lengths, all else that acts on a chain at this moment (weight, wind, the inertia of its own motion
// and of its root's, contacts) is
//
//     F = K u - lambda d,
//
// for each node. It is what a coat's strands have in common: forces over a strand's length do not
// depend on the directions in which it was combed. So strands take over the F and lambda of the chains near
// them, and what that bends them by follows from their own rest directions (interpolate_modal.hpp).
// A state in which lambda is not the balance's (the fallback leaves 0) is as good: F and lambda belong
// together, and give a strand that lies as the chain does the chain's own bend.
//
// Of a sag-free layer the force that holds its groom has a part M s r that does not follow from the
// place, s what of the weight is along the tangent and M its lever (modal_frame.hpp); with it the
// lengths' lambda is -M s where the groom rests. Both are set aside:
//
//     F = (K + M s) u - l d,   l = lambda + M s,
//
// nothing where a strand rests as it was groomed. A node whose lambda is 0 to the bit starts afresh,
// and feels no weight yet.
//
// Invariant: the multipliers and F are nothing where a chain starts on its groom.
#pragma once

#include "core/kernels/modal_curve.hpp"

namespace pelt::modal {

inline constexpr uint32_t kVertexNodes = 3;  // of chains at mesh vertices

// M s of sag-free layers, 1/s^2; nothing of others. The weight is that of now: it is the same in
// chains and strands, which is what counts.
template <class W>
PELT_INLINE void StretchOfWeight(const LayerBlock& layer, const ModalTableBlock& t, W per_length,
                                 const Vec3<W> (&rest)[kVertexNodes], W (&stretch)[kVertexNodes]) {
  PELT_UNROLL
  for (W& s : stretch) s = W(0.0f);
  if ((layer.flags & kLayerSagFree) == 0) return;
  const Vec3<W> weight = chain::Splat3<W>(layer.gravity) * per_length;
  PELT_UNROLL
  for (uint32_t i = 0; i < kVertexNodes; ++i)
    stretch[i] = Max(Dot(weight, rest[i]), W(0.0f)) * W(t.pull[i]);
}

// Tangents with rest tangents `rest` under the loads F = `load` and multipliers l:
//
//     (K + M s - l) u = F + l r,   d = r + u, brought to length one.
//
// Eliminated from the tip. A strand that is pressed together further than it stands has no such balance: a pivot is
// let go down to kLeastPivot of what it is without l and s, so that what comes out is bent far, and finite. Without
// stiffness it is kLoosePivot, 1/s^2.
inline constexpr float kLeastPivot = 0.5f, kLoosePivot = 1.0f;

// The pivots of K alone, from the tip.
struct BarePivots {
  float pivot[kVertexNodes];
  explicit BarePivots(const ModalTableBlock& t) {
    float k[kVertexNodes][kVertexNodes];
    for (uint32_t i = 0; i < kVertexNodes; ++i)
      for (uint32_t j = 0; j < kVertexNodes; ++j) k[i][j] = t.stiffness[i][j];
    for (uint32_t i = kVertexNodes; i-- > 0;) {
      pivot[i] = k[i][i];
      const float inverse = pivot[i] > 0.0f ? 1.0f / pivot[i] : 0.0f;
      for (uint32_t r = 0; r < i; ++r)
        for (uint32_t c = 0; c < i; ++c) k[r][c] = k[r][c] - k[r][i] * inverse * k[i][c];
    }
  }
};

template <class W>
PELT_INLINE void BendUnderLoad(const ModalTableBlock& t, const BarePivots& bare,
                               const Vec3<W> (&rest)[kVertexNodes],
                               const Vec3<W> (&load)[kVertexNodes], const W (&l)[kVertexNodes],
                               const W (&stretch)[kVertexNodes], Vec3<W> (&d)[kVertexNodes]) {
  constexpr uint32_t N = kVertexNodes;
  Vec3<W> h[N];
  W a[N][N], inverse[N];
  PELT_UNROLL
  for (uint32_t i = 0; i < N; ++i) {
    h[i] = load[i] + rest[i] * l[i];
    PELT_UNROLL
    for (uint32_t j = 0; j < i; ++j) a[i][j] = W(t.stiffness[i][j]);
    a[i][i] = W(t.stiffness[i][i]) + (stretch[i] - l[i]);
  }
  PELT_UNROLL
  for (uint32_t step = 0; step < N; ++step) {
    const uint32_t i = N - 1 - step;
    const float least = bare.pivot[i] * kLeastPivot;
    inverse[i] = W(1.0f) / Max(a[i][i], W(least > kLoosePivot ? least : kLoosePivot));
    PELT_UNROLL
    for (uint32_t r = 0; r < i; ++r) {
      const W share = a[i][r] * inverse[i];
      h[r] = h[r] - h[i] * share;
      PELT_UNROLL
      for (uint32_t c = 0; c <= r; ++c) a[r][c] = a[r][c] - share * a[i][c];
    }
  }
  Vec3<W> u[N];
  PELT_UNROLL
  for (uint32_t i = 0; i < N; ++i) {
    Vec3<W> left = h[i];
    PELT_UNROLL
    for (uint32_t j = 0; j < i; ++j) left = left - u[j] * a[i][j];
    u[i] = left * inverse[i];
    d[i] = NormalizeOr(rest[i] + u[i], rest[i]);
  }
}

// F and l of tangents `d`, 1/s^2.
template <class W>
PELT_INLINE void LoadOf(const ModalTableBlock& t, const Vec3<W> (&rest)[kVertexNodes],
                        const Vec3<W> (&d)[kVertexNodes], const W (&lambda)[kVertexNodes],
                        const W (&stretch)[kVertexNodes], Vec3<W> (&load)[kVertexNodes],
                        W (&l)[kVertexNodes]) {
  constexpr uint32_t N = kVertexNodes;
  Vec3<W> u[N];
  PELT_UNROLL
  for (uint32_t i = 0; i < N; ++i) {
    u[i] = d[i] - rest[i];
    const typename W::Mask goes_on = Abs(lambda[i]) > W(0.0f);
    const W both = lambda[i] + stretch[i];
    l[i] = Select(goes_on, both, W(0.0f));
  }
  PELT_UNROLL
  for (uint32_t i = 0; i < N; ++i) {
    Vec3<W> spring = u[0] * W(t.stiffness[i][0]);
    PELT_UNROLL
    for (uint32_t j = 1; j < N; ++j) spring = spring + u[j] * W(t.stiffness[i][j]);
    const Vec3<W> held = u[i] * stretch[i], along = d[i] * l[i];
    load[i] = spring + (held - along);
  }
}

}  // namespace pelt::modal
