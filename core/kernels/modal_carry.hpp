// A frame that is too long to be stepped (a level loads, a window is dragged): strands are carried
// along by their roots.
//
// The idea: substeps of more than 1/80 s follow nothing that a strand does, and what they make of a
// root that was away for a while looks worse than a strand that does nothing. So a strand keeps its
// shape, turned as its first node's rest tangent turned, and starts anew from there: at rest
// towards its root, which is taken to have come here at an even speed.
//
// Last frame's rest directions are in its pull, r = K^-1 M Phi T. A strand without stiffness has
// none; it keeps its directions, as it hangs from gravity and not from its root.
//
// Invariant: unit directions in, unit directions out.
#pragma once

#include "core/kernels/modal_motion.hpp"

namespace pelt::modal {

// `v` turned as the least turn that takes unit vector `from` to unit vector `to` turns it; half a
// turn is ambiguous and made about some axis.
template <class W>
PELT_INLINE Vec3<W> TurnLeast(Vec3<W> from, Vec3<W> to, Vec3<W> v) {
  constexpr float kLeastCosine = 1.0e-3f;  // and one
  const Vec3<W> axis = Cross(from, to);
  const W cosine = Dot(from, to);
  const Vec3<W> across = Cross(axis, v);
  const W along = Dot(axis, v) / Max(W(1.0f) + cosine, W(kLeastCosine));
  return v * cosine + across + axis * along;
}

// The rest tangent of the first node one frame ago; shorter than a half where it is not known.
template <class W, uint32_t N>
PELT_INLINE Vec3<W> LastRest(const ModalTableBlock& t, const Motion<W, N>& motion) {
  W rest[3];
  for (uint32_t k = 0; k < 3; ++k) {
    const Axis<W, N>& a = motion.axis[k];
    W pull[N];
    // The newest pull less its first difference, the root's place set aside.
    for (uint32_t m = 0; m < N; ++m)
      pull[m] = a.bend[0][m] - a.bend[1][m] + a.root[0] * W(t.bend_root[m]);
    rest[k] = Weigh<W, N>(t.rest_of_bend[0], pull);
  }
  return {rest[0], rest[1], rest[2]};
}

// The same of this frame, with what holds it up.
template <class W, uint32_t N>
PELT_INLINE Vec3<W> NowRest(const ModalTableBlock& t, const Motion<W, N>& motion) {
  return {Weigh<W, N>(t.rest_of_bend[0], motion.axis[0].bend[0]),
          Weigh<W, N>(t.rest_of_bend[0], motion.axis[1].bend[0]),
          Weigh<W, N>(t.rest_of_bend[0], motion.axis[2].bend[0])};
}

// Directions `d` at the end of the frame, from motion's at its start.
template <class W, uint32_t N>
PELT_INLINE void CarryFrame(const ModalTableBlock& t, Vec3<W> rest, const Motion<W, N>& motion,
                            Vec3<W> (&d)[N]) {
  const Vec3<W> last = LastRest(t, motion);
  const typename W::Mask known = Dot(last, last) > W(0.25f);
  const Vec3<W> from = NormalizeOr(last, rest);
  for (uint32_t i = 0; i < N; ++i) {
    const Vec3<W> before = Row(motion, &Axis<W, N>::d, i);
    const Vec3<W> turned = TurnLeast(from, rest, before);
    d[i] = Select<W>(known, NormalizeOr(turned, before), before);
  }
}

}  // namespace pelt::modal
