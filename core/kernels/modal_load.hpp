// What bends a modal chain, apart from how it was combed.
//
// With u = d - r what the links are bent by, K the stiffness and lambda the multipliers of the
// lengths, whatever else acts on a chain at this moment (weight, wind, the inertia of its own motion
// and of its root's, contacts) is
//
//     F = K u - lambda d,
//
// for each link. It is what a coat's strands have in common: forces over a strand's length do not
// depend on the directions in which it was combed. So strands take over the F and lambda of the chains near
// them, and what that bends them by follows from their own rest directions (interpolate_modal.hpp).
// A state in which lambda is not the balance's (the fallback leaves 0) is as good: F and lambda belong
// together, and give a strand that lies as the chain does the chain's own bend.
//
// Of a sag-free layer the force that holds its groom has a part M s r that does not follow from the
// place, s what of the weight stretches the link and M its lever (modal_start.hpp); with it the
// lengths' lambda is -M s where the groom rests. Both are set aside:
//
//     F = (K + M s) u - l d,   l = lambda + M s,
//
// nothing where a strand rests as it was groomed. A link whose lambda is 0 to the bit starts afresh,
// and feels no weight yet.
//
// Invariant: the multipliers and F are nothing where a chain starts on its groom.
#pragma once

#include "core/kernels/chain.hpp"
#include "core/modal/modal_block.hpp"

namespace pelt::modal {

inline constexpr uint32_t kVertexLinks = 3;  // of chains at mesh vertices

// The joints' stiffness of such chains, from their matrix, root to tip; 1/s^2.
struct Joints {
  float k[kVertexLinks];
  explicit Joints(const ModalTableBlock& t)
      : k{t.stiffness[0][0] + t.stiffness[0][1], -t.stiffness[0][1], -t.stiffness[1][2]} {}
};

// Rest directions of chains on their groom.
template <class W>
PELT_INLINE void RestDirections(const chain::Group<W, kVertexLinks>& g, W per_length,
                                Vec3<W> (&rest)[kVertexLinks]) {
  rest[0] = g.rest[0] * per_length;
  PELT_UNROLL
  for (uint32_t i = 1; i < kVertexLinks; ++i) rest[i] = (g.rest[i] - g.rest[i - 1]) * per_length;
}

// M s of sag-free layers, 1/s^2; nothing of others. The weight is that of now: it is the same in
// chains and strands, which is what counts.
template <class W>
PELT_INLINE void StretchOfWeight(const LayerBlock& layer, const ModalTableBlock& t, W per_length,
                                 const Vec3<W> (&rest)[kVertexLinks], W (&stretch)[kVertexLinks]) {
  PELT_UNROLL
  for (W& s : stretch) s = W(0.0f);
  if ((layer.flags & kLayerSagFree) == 0) return;
  const Vec3<W> weight = chain::Splat3<W>(layer.gravity) * per_length;
  PELT_UNROLL
  for (uint32_t i = 0; i < kVertexLinks; ++i)
    stretch[i] = Max(Dot(weight, rest[i]), W(0.0f)) * W(t.mass[i][0]);
}

// Directions of links with rest directions `rest` under the loads F = `load` and multipliers l:
//
//     (K + M s - l) u = F + l r,   d = r + u, brought to length one.
//
// Eliminated from the tip, where without l and s the pivots are the joints' stiffness. A chain that
// is pressed together further than it stands has no such balance: a pivot is let go down to kLeast of
// it, so that what comes out is bent far, and finite. Loose joints stand on kLoose, 1/s^2.
inline constexpr float kLeastPivot = 0.5f, kLoosePivot = 1.0f;

template <class W>
PELT_INLINE void BendUnderLoad(const Joints& joints, const Vec3<W> (&rest)[kVertexLinks],
                               const Vec3<W> (&load)[kVertexLinks], const W (&l)[kVertexLinks],
                               const W (&stretch)[kVertexLinks], Vec3<W> (&d)[kVertexLinks]) {
  constexpr uint32_t N = kVertexLinks;
  Vec3<W> h[N];
  W inverse[N];
  PELT_UNROLL
  for (uint32_t i = 0; i < N; ++i) h[i] = load[i] + rest[i] * l[i];
  PELT_UNROLL
  for (uint32_t step = 0; step < N; ++step) {
    const uint32_t i = N - 1 - step;
    const float k = joints.k[i], least = k * kLeastPivot;
    W pivot = W(k) + (stretch[i] - l[i]);
    if (i + 1 < N) {
      // Of the joint below: what it adds here, less what its link gives way.
      const W below = W(joints.k[i + 1]);
      const W share = below * inverse[i + 1];
      pivot = pivot + (below - below * share);
      h[i] = h[i] + h[i + 1] * share;
    }
    inverse[i] = W(1.0f) / Max(pivot, W(least > kLoosePivot ? least : kLoosePivot));
  }
  Vec3<W> u = h[0] * inverse[0];
  d[0] = NormalizeOr(rest[0] + u, rest[0]);
  PELT_UNROLL
  for (uint32_t i = 1; i < N; ++i) {
    const Vec3<W> pull = h[i] + u * W(joints.k[i]);
    u = pull * inverse[i];
    d[i] = NormalizeOr(rest[i] + u, rest[i]);
  }
}

// F and l of links along `d`, 1/s^2.
template <class W>
PELT_INLINE void LoadOf(const Joints& joints, const Vec3<W> (&rest)[kVertexLinks],
                        const Vec3<W> (&d)[kVertexLinks], const W (&lambda)[kVertexLinks],
                        const W (&stretch)[kVertexLinks], Vec3<W> (&load)[kVertexLinks],
                        W (&l)[kVertexLinks]) {
  constexpr uint32_t N = kVertexLinks;
  Vec3<W> u[N], torque[N];  // of the joint above each link
  PELT_UNROLL
  for (uint32_t i = 0; i < N; ++i) {
    u[i] = d[i] - rest[i];
    torque[i] = (i == 0 ? u[0] : u[i] - u[i - 1]) * W(joints.k[i]);
    const typename W::Mask goes_on = Abs(lambda[i]) > W(0.0f);
    const W both = lambda[i] + stretch[i];
    l[i] = Select(goes_on, both, W(0.0f));
  }
  PELT_UNROLL
  for (uint32_t i = 0; i < N; ++i) {
    const Vec3<W> spring = i + 1 < N ? torque[i] - torque[i + 1] : torque[i];
    const Vec3<W> held = u[i] * stretch[i], along = d[i] * l[i];
    load[i] = spring + (held - along);
  }
}

}  // namespace pelt::modal
