// Curl that turns with the strand: the difference between two models of a rod that rests bent, as a force.
//
// The modes know a rod whose rest bend turns with the root (model L): B/2 |t' - r'|^2. A curl that keeps its
// shape when the strand swings turns with the strand's own tangent (model F): B/2 |t' - R r'|^2, R the smallest
// rotation that takes the rest tangent r to t. The modes go on with L, exactly; what F pulls otherwise is a
// force that is constant over the substep, taken where the strand will be in its middle. With u the tangents
// there, in the root's frame of that time V the rest bend across r, and D the curve's bend from its tangents,
//
//     s = r + u,  q = 1 / (1 + r . u),  x = q u . V,  a = -s x        R V = V + a
//     g = D (u - r) - a,  y = q s . g                                 what is bent otherwise
//     force = K D^-1 a + w (r x y - g x - V y)
//
// The second part is the torque of a bend that its own tangent turns: without it twice as much is wrong.
// A strand that rests bent by more than kMostCurl is not followed whole: an explicit force of that size would
// not let it settle.
//
// Invariant: finite in, finite out; a tangent turned right round against its rest direction, where R is not
// defined, feels a bounded force.
//
// Source: smallest rotations as in Bergou et al., Discrete Elastic Rods, 2008 (parallel transport); the form at
// nodes, and what was tried beside it, is measured by `pelt accuracy --features`.
#pragma once

#include "core/modal/modal_block.hpp"
#include "core/simd.hpp"

namespace pelt::modal {

// 1 + r . u is not let below this: 169 degrees.
inline constexpr float kLeastCarry = 0.02f;
// Rest turning from the first node to the last, rad, up to which it is followed whole; none from 1.4 times that.
inline constexpr float kMostCurl = 1.2f;

// Tangents by axis, as the motion has them.
template <class W, uint32_t N>
using Rows = W[3][N];

template <class W, uint32_t N>
PELT_INLINE Vec3<W> NodeOf(const Rows<W, N>& rows, uint32_t i) {
  return {rows[0][i], rows[1][i], rows[2][i]};
}

// The rest tangents at a time that `place` weighs the backward differences for.
template <class W, uint32_t N, class Motion>
PELT_INLINE void RestAt(const ModalTableBlock& t, const float (&place)[kModalSamples - 1],
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
      const W bend3 = a.bend[3][m] * W(place[2]), own = root * W(t.bend_root[m]);
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

template <class W, uint32_t N>
PELT_INLINE Vec3<W> WeighNodes(const float (&row)[kMaxNodes], const Vec3<W> (&v)[N]) {
  Vec3<W> sum = v[0] * W(row[0]);
  PELT_UNROLL
  for (uint32_t j = 1; j < N; ++j) sum = sum + v[j] * W(row[j]);
  return sum;
}

// The tangents in the middle of the substep, as they go on from its start; unit. `root`: the way of the root
// from the start to there.
template <class W, uint32_t N, class Motion>
PELT_INLINE void GoOnToMiddle(const ModalTableBlock& t, const Motion& motion, const W (&root)[3],
                              Vec3<W> (&u)[N]) {
  PELT_UNROLL
  for (uint32_t i = 0; i < N; ++i) {
    W to[3];
    for (uint32_t k = 0; k < 3; ++k) {
      const auto& a = motion.axis[k];
      W speed = a.z[0] * W(t.shape[i][0]);
      PELT_UNROLL
      for (uint32_t m = 1; m < N; ++m) speed = speed + a.z[m] * W(t.shape[i][m]);
      const W way = speed * W(t.half_step_s), carried = root[k] * W(t.root[i]);
      to[k] = a.d[i] + (way - carried);
    }
    const Vec3<W> from = {motion.axis[0].d[i], motion.axis[1].d[i], motion.axis[2].d[i]};
    u[i] = NormalizeOr(Vec3<W>{to[0], to[1], to[2]}, from);
  }
}

// The share of it that is followed.
template <class W, uint32_t N>
PELT_INLINE W FollowedCurl(const Vec3<W> (&r)[N]) {
  W turning = W(0.0f);
  PELT_UNROLL
  for (uint32_t i = 1; i < N; ++i) {
    const Vec3<W> turn = r[i] - r[i - 1];
    turning = turning + Sqrt(Dot(turn, turn));
  }
  const W over = turning * W(1.0f / kMostCurl);
  return Clamp(W(2.0f) - over * over, W(0.0f), W(1.0f));
}

// What F pulls beyond L on tangents u that rest as r, 1/s^2.
template <class W, uint32_t N>
PELT_INLINE void PullOfCurl(const ModalTableBlock& t, const Vec3<W> (&u)[N], const Vec3<W> (&r)[N],
                            Vec3<W> (&force)[N]) {
  Vec3<W> off[N], turned[N];
  W x[N];
  PELT_UNROLL
  for (uint32_t i = 0; i < N; ++i) off[i] = u[i] - r[i];
  PELT_UNROLL
  for (uint32_t i = 0; i < N; ++i) {
    const Vec3<W> bend = WeighNodes<W, N>(t.curl_turn[i], r), sum = r[i] + u[i];
    const Vec3<W> across = bend - r[i] * Dot(r[i], bend);
    const W inverse = W(1.0f) / Max(W(1.0f) + Dot(r[i], u[i]), W(kLeastCarry));
    x[i] = Dot(u[i], across) * inverse;
    turned[i] = sum * (W(0.0f) - x[i]);
    const Vec3<W> other = WeighNodes<W, N>(t.curl_bend[i], off) - turned[i];
    const W y = Dot(sum, other) * inverse, both = x[i] * y;
    // Operands are named: which of two a compiler computes first is open, and a price must not be.
    const Vec3<W> over = r[i] * both, along = other * x[i], aside = across * y;
    force[i] = (over - along - aside) * W(t.curl_weight[i]);
  }
  PELT_UNROLL
  for (uint32_t i = 0; i < N; ++i) {
    const Vec3<W> pull = WeighNodes<W, N>(t.curl_pull[i], turned);
    force[i] = force[i] + pull;
  }
}

// Sets what the curl adds to the modes' force over a substep.
template <class W, uint32_t N, class Motion>
__attribute__((noinline)) void AddCurl(const ModalTableBlock& t, uint32_t substep, Motion& motion) {
  const auto& middle = t.substep[substep].middle_place;
  Rows<W, N> rows;
  RestAt<W, N>(t, middle, motion, rows);
  Vec3<W> r[N], u[N], force[N];
  PELT_UNROLL
  for (uint32_t i = 0; i < N; ++i) r[i] = NodeOf<W, N>(rows, i);
  W root[3];
  for (uint32_t k = 0; k < 3; ++k) {
    const auto& a = motion.axis[k];
    const auto weigh = [&](const float(&w)[kModalSamples - 1]) __attribute__((always_inline)) {
      return a.root[0] * W(w[0]) + a.root[1] * W(w[1]) + a.root[2] * W(w[2]);
    };
    const W to = weigh(middle);
    root[k] = substep == 0 ? to + a.root[0] : to - weigh(t.substep[substep - 1].root_place);
  }
  GoOnToMiddle<W, N>(t, motion, root, u);
  PullOfCurl<W, N>(t, u, r, force);
  const W share = FollowedCurl<W, N>(r);
  for (uint32_t k = 0; k < 3; ++k) {
    W push[N];
    PELT_UNROLL
    for (uint32_t i = 0; i < N; ++i)
      push[i] = (k == 0 ? force[i].x : k == 1 ? force[i].y : force[i].z) * share;
    PELT_UNROLL
    for (uint32_t m = 0; m < N; ++m) {
      W sum = push[0] * W(t.shape[0][m]);
      PELT_UNROLL
      for (uint32_t i = 1; i < N; ++i) sum = sum + push[i] * W(t.shape[i][m]);
      motion.axis[k].curl[m] = sum;
    }
  }
}

}  // namespace pelt::modal
