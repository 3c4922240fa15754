// Curl that the parent link carries: the difference between two models of a bent joint, as a force.
//
// The modes know a joint whose rest bend turns with the root (model L): k/2 |(d_j - d_p) -
// (r_j - r_p)|^2, p = j - 1. A curl that keeps its shape when the strand swings is carried by the
// link above it (model F): k/2 |d_j - T d_p|^2, T d the image of r_j under the smallest rotation
// that takes r_p to d. The modes go on with L, exactly; what F pulls otherwise, -grad E_F +
// grad E_L, is a force that goes evenly over the substep from what it is at its start to what it
// will be where that and the last multipliers lead.
//
//   on d_j: k (T - r_j - d_p + r_p)      on d_p: k (dT/dd)^T (d_j - T) - k (d_j - d_p - r_j + r_p)
//
// A strand that hangs still is where F balances, whatever the step: the two ends are then one.
// (A force k (1 - d_j . T), equal at unit length, is not: it blows up.)
//
// Explicit, it is unstable where a joint rests bent far and a substep is long: of one that bends further
// than the table allows only a share follows its parent, none from 1.4 times as far.
//
// Invariant: finite in, finite out; a link turned right round against its rest direction, where T
// is not defined, feels a bounded force.
#pragma once

#include "core/modal/modal_block.hpp"
#include "core/simd.hpp"

namespace pelt::modal {

// 1 + r . d is not let below this: 169 degrees.
inline constexpr float kLeastCarry = 0.02f;

// The image T of v under the smallest rotation that takes the unit vector a to the unit vector d,
// and the pull of w . T on d.
template <class W>
struct Carried {
  Vec3<W> image, gradient;
};

template <class W>
PELT_INLINE Carried<W> Carry(Vec3<W> a, Vec3<W> d, Vec3<W> v, Vec3<W> to) {
  const W inverse = W(1.0f) / Max(W(1.0f) + Dot(a, d), W(kLeastCarry));
  const Vec3<W> sum = a + d;
  const W twice = Dot(a, v) * W(2.0f), share = Dot(sum, v) * inverse;
  Carried<W> c;
  // Operands are named: which of two a compiler computes first is open, and a price must not be.
  const Vec3<W> back = sum * share, forth = d * twice;
  c.image = v - back + forth;
  const Vec3<W> w = to - c.image;
  const W across = Dot(sum, w) * inverse;
  const W turned = twice - share, both = across * share;
  const Vec3<W> along = w * turned, aside = v * across, over = a * both;
  c.gradient = along - aside + over;
  return c;
}

// Directions of links by axis, as the motion has them.
template <class W, uint32_t N>
using Rows = W[3][N];

template <class W, uint32_t N>
PELT_INLINE Vec3<W> LinkOf(const Rows<W, N>& rows, uint32_t i) {
  return {rows[0][i], rows[1][i], rows[2][i]};
}
template <class W, uint32_t N>
PELT_INLINE void SetLink(Rows<W, N>& rows, uint32_t i, Vec3<W> link) {
  rows[0][i] = link.x;
  rows[1][i] = link.y;
  rows[2][i] = link.z;
}

// What F pulls beyond L on links that point along `d` (unit), rest directions `r`, 1/s^2.
template <class W, uint32_t N>
PELT_INLINE void PullOfCurl(const ModalTable<N>& t, const Rows<W, N>& d, const Rows<W, N>& r,
                            Rows<W, N>& force) {
  Vec3<W> above = {W(0.0f), W(0.0f), W(0.0f)};  // the force on link p
  PELT_UNROLL
  for (uint32_t j = 1; j < N; ++j) {
    const uint32_t p = j - 1;
    const Vec3<W> d_p = LinkOf<W, N>(d, p), d_j = LinkOf<W, N>(d, j);
    const Vec3<W> r_p = LinkOf<W, N>(r, p), r_j = LinkOf<W, N>(r, j);
    const Vec3<W> bend = r_j - r_p;
    const W over = Dot(bend, bend) * W(t.joint[0]);
    const W share = Clamp(W(2.0f) - over, W(0.0f), W(1.0f));
    const W k = W(t.joint[j]) * share;
    const Carried<W> c = Carry<W>(r_p, d_p, r_j, d_j);
    const Vec3<W> off = d_p - r_p;
    SetLink<W, N>(force, p, above + (c.gradient - (d_j - r_j - off)) * k);
    above = (c.image - r_j - off) * k;
  }
  SetLink<W, N>(force, N - 1, above);
}

// The rest directions at a time that `place` weighs the backward differences for.
template <class W, uint32_t N, class Motion>
PELT_INLINE void RestAt(const ModalTable<N>& t, const float (&place)[kModalSamples - 1],
                        const Motion& motion, Rows<W, N>& rest) {
  PELT_NO_UNROLL
  for (uint32_t k = 0; k < 3; ++k) {
    const auto& a = motion.axis[k];
    const W root0 = a.root[0] * W(place[0]), root1 = a.root[1] * W(place[1]);
    const W root2 = a.root[2] * W(place[2]);
    const W root = root0 + root1 + root2;
    W bend[N];  // by how much T differs from the newest, the root's place set aside
    PELT_UNROLL
    for (uint32_t m = 0; m < N; ++m) {
      const W bend1 = a.bend[1][m] * W(place[0]), bend2 = a.bend[2][m] * W(place[1]);
      const W bend3 = a.bend[3][m] * W(place[2]), own = root * W(t.bend[m][0]);
      bend[m] = bend1 + bend2 + bend3 - own;
    }
    PELT_UNROLL
    for (uint32_t i = 0; i < N; ++i) {
      W r = a.rest[i];
      PELT_UNROLL
      for (uint32_t m = 0; m < N; ++m) r = r + bend[m] * W(t.rest_of_bend[i][m]);
      rest[k][i] = r;
    }
  }
}

// Those at the substep's end. Where that is the frame's they are known.
template <class W, uint32_t N, class Motion>
PELT_INLINE void RestAtEnd(const ModalTable<N>& t, const ModalSubstep<N>& s, const Motion& motion,
                           Rows<W, N>& rest) {
  if (s.root_place[0] != 0.0f) {
    RestAt<W, N>(t, s.root_place, motion, rest);
    return;
  }
  for (uint32_t k = 0; k < 3; ++k) {
    PELT_UNROLL
    for (uint32_t i = 0; i < N; ++i) rest[k][i] = motion.axis[k].rest[i];
  }
}

// Where the links would end under the force of the substep's start and the last multipliers.
template <class W, uint32_t N, class Motion>
PELT_INLINE void PredictEnd(const ModalTable<N>& t, const Motion& motion, const Rows<W, N>& force,
                            Rows<W, N>& end) {
  PELT_NO_UNROLL
  for (uint32_t k = 0; k < 3; ++k) {
    const auto& a = motion.axis[k];
    W twice[N], free[N], pull[N];
    PELT_UNROLL
    for (uint32_t i = 0; i < N; ++i) twice[i] = force[k][i] + force[k][i];
    PELT_UNROLL
    for (uint32_t i = 0; i < N; ++i) {
      free[i] = a.p[i];
      PELT_UNROLL
      for (uint32_t j = 0; j < N; ++j) free[i] = free[i] + twice[j] * W(t.response[i][j]);
    }
    PELT_UNROLL
    for (uint32_t j = 0; j < N; ++j) pull[j] = (a.d[j] + free[j]) * motion.lambda[j];
    PELT_UNROLL
    for (uint32_t i = 0; i < N; ++i) {
      W to = free[i];
      PELT_UNROLL
      for (uint32_t j = 0; j < N; ++j) to = to + pull[j] * W(t.response[i][j]);
      end[k][i] = to;
    }
  }
}

// Adds the answer to a force that goes from `first` to `last` over the substep to p and z.
template <class W, uint32_t N, class Motion>
PELT_INLINE void AddForce(const ModalTable<N>& t, const Rows<W, N>& first, const Rows<W, N>& last,
                          Motion& motion) {
  PELT_NO_UNROLL
  for (uint32_t k = 0; k < 3; ++k) {
    auto& a = motion.axis[k];
    // The table's answers are those to half a constant force and to a change.
    W sum[N], turn[N];
    PELT_UNROLL
    for (uint32_t i = 0; i < N; ++i) {
      sum[i] = last[k][i] + first[k][i];
      turn[i] = last[k][i] - first[k][i];
    }
    PELT_UNROLL
    for (uint32_t i = 0; i < N; ++i) {
      W p = a.p[i], push = sum[0] * W(t.shape[0][i]), twist = turn[0] * W(t.shape[0][i]);
      PELT_UNROLL
      for (uint32_t j = 0; j < N; ++j) {
        const W moved = sum[j] * W(t.response[i][j]), bent = turn[j] * W(t.slope[i][j]);
        p = p + moved + bent;
      }
      PELT_UNROLL
      for (uint32_t j = 1; j < N; ++j) {
        push = push + sum[j] * W(t.shape[j][i]);
        twist = twist + turn[j] * W(t.shape[j][i]);
      }
      a.p[i] = p;
      const W pushed = push * W(t.impulse[i]), twisted = twist * W(t.impulse_slope[i]);
      a.z[i] = a.z[i] + pushed + twisted;
    }
  }
}

// Adds what the force changes to the free motion (p, z).
template <class W, uint32_t N, class Motion>
__attribute__((noinline)) void AddCurl(const ModalTable<N>& t, const ModalSubstep<N>& s,
                                       Motion& motion) {
  Rows<W, N> d, r, first, last;
  RestAt<W, N>(t, s.start_place, motion, r);
  for (uint32_t k = 0; k < 3; ++k) {
    PELT_UNROLL
    for (uint32_t i = 0; i < N; ++i) d[k][i] = motion.axis[k].d[i];
  }
  PullOfCurl<W, N>(t, d, r, first);
  PredictEnd<W, N>(t, motion, first, last);
  PELT_UNROLL
  for (uint32_t i = 0; i < N; ++i)
    SetLink<W, N>(d, i, NormalizeOr<W>(LinkOf<W, N>(last, i), LinkOf<W, N>(d, i)));
  RestAtEnd<W, N>(t, s, motion, r);
  PullOfCurl<W, N>(t, d, r, last);
  AddForce<W, N>(t, first, last, motion);
}

}  // namespace pelt::modal
