// Friction of a modal chain on colliders, Coulomb's: what a contact pushes a point out with, times the
// coefficient, is the most that holds it back across the normal; within that it stays where it is on
// the collider.
//
// The idea: it is done as the contact itself (modal_touch.hpp), with three directions for each point
// instead of one, in the same two steps. A force that is constant over the substep keeps the point
// from slipping since the substep's start, or is as large as it may be and against the slip: a strand
// that rests on a slope lies still, and one that slides is slowed down by exactly mu times its weight
// on it. Then an impulse takes the speed across the normal, again so far that force and impulse
// together are within mu times what pushed in the whole substep: a force that stops a point turns its
// speed round.
//
// A point that comes from outside slips only from where it touches: the share of its way that it did
// before is not held against it.
//
// The points act on each other through the links, so they are solved one after the other, in sweeps.
//
// Invariants: as modal_touch.hpp's; surface and max_distance rub nothing.
#pragma once

#include "core/kernels/modal_lever.hpp"
#include "core/kernels/modal_obstacle.hpp"

namespace pelt::modal {

// Times that contacts and lengths are solved in turn, and sweeps over the contacts in each. With two
// rounds and one that pushes out alone, what should be held creeps a hundred times as fast.
inline constexpr int kRubRounds = 3, kRubSweeps = 8;
// A point that was this share of its depth from the collider lay on it.
inline constexpr float kNearlyThere = 0.1f;

// A contact's normal and two directions across; all 0 where there is none.
template <class W>
struct ContactFrame {
  Vec3<W> axis[3];

  PELT_INLINE void Make(Vec3<W> n) {
    const W none = W(0.0f), one = W(1.0f);
    const Vec3<W> zero = {none, none, none}, z = {none, none, one};
    const typename W::Mask any = Dot(n, n) > none;
    const Vec3<W> normal = Select<W>(any, n, z);
    const Vec3<W> across = UnitAcross(normal, {none, one, none});
    const Vec3<W> other = Cross(normal, across);
    axis[0] = n;
    axis[1] = Select<W>(any, across, zero);
    axis[2] = Select<W>(any, other, zero);
  }
  PELT_INLINE Vec3<W> Out(W normal, W first, W second) const {
    return Combine(axis[0], normal, axis[1], first, axis[2], second);
  }
};

// What contacts are to do, and what they may: components are along the axes of their frames.
template <class W, uint32_t N>
struct Rub {
  W wanted[N][3];
  W least[N];      // of the normal's push
  W pressed[N];    // what pushes along it already
  W rubbed[N][2];  // and across it
  W mu[N];
  W push[N][3];  // the result
};

// As Levers, for pushes in three directions at each point.
template <class W, uint32_t N>
struct RubLevers {
  static constexpr uint32_t kPushes = 3 * N;
  W give[N][N];                          // [point][link]: without the lengths
  W hold[kPushes][N];                    // [push][link]: multipliers that keep the lengths
  W lower[kPushes * (kPushes + 1) / 2];  // of a symmetric matrix, row by row

  PELT_INLINE void Make(const float (&response)[N][N], const Vec3<W> (&along)[N],
                        const NewtonMatrix<W, N>& lengths, const ContactFrame<W> (&frame)[N],
                        const W (&on)[N], float share) {
    W b[kPushes][N];
    for (uint32_t q = 0; q < N; ++q) {
      for (uint32_t i = 0; i < N; ++i) {
        float above = 0.0f;
        for (uint32_t j = 0; j < q; ++j) above = above + response[i][j];
        const W own = W(response[i][q]) * on[q];
        give[q][i] = W(above) + own;
      }
      for (uint32_t k = 0; k < 3; ++k) {
        const uint32_t p = 3 * q + k;
        for (uint32_t i = 0; i < N; ++i) {
          b[p][i] = Dot(frame[q].axis[k], along[i]) * give[q][i];
          hold[p][i] = W(0.0f) - b[p][i];
        }
        SolveFactored<W, N>(lengths.lower, lengths.inverse, hold[p]);
      }
    }
    for (uint32_t r = 0; r < N; ++r)
      for (uint32_t q = 0; q <= r; ++q) {
        W bare = give[q][r] * on[r];
        for (uint32_t i = 0; i < r; ++i) bare = bare + give[q][i];
        for (uint32_t k = 0; k < 3; ++k)
          for (uint32_t l = 0; l < 3; ++l) Fill(3 * r + k, 3 * q + l, bare, b, frame, share);
        // A point can hardly be pushed along its links.
        if (r == q)
          for (uint32_t k = 0; k < 3; ++k) {
            W& own = At(3 * q + k, 3 * q + k);
            const W least = bare * W(kLeastGive);
            own = k == 0 ? Max(own, least) : own + least;
          }
      }
  }

  // Sweeps over the contacts: out of each first, then back along it.
  PELT_INLINE void Solve(Rub<W, N>& rub) const {
    for (uint32_t q = 0; q < N; ++q)
      for (uint32_t k = 0; k < 3; ++k) rub.push[q][k] = W(0.0f);
    PELT_NO_UNROLL
    for (int sweep = 0; sweep < kRubSweeps; ++sweep)
      for (uint32_t q = 0; q < N; ++q) SolvePoint(q, rub);
  }

  // Multipliers of the lengths that go with the pushes.
  PELT_INLINE void Hold(const W (&push)[N][3], W (&multiplier)[N]) const {
    for (uint32_t j = 0; j < N; ++j) {
      multiplier[j] = W(0.0f);
      for (uint32_t q = 0; q < N; ++q)
        for (uint32_t k = 0; k < 3; ++k)
          multiplier[j] = multiplier[j] + hold[3 * q + k][j] * push[q][k];
    }
  }

 private:
  static PELT_INLINE uint32_t Place(uint32_t row, uint32_t column) {
    return row < column ? column * (column + 1) / 2 + row : row * (row + 1) / 2 + column;
  }
  PELT_INLINE W& At(uint32_t row, uint32_t column) { return lower[Place(row, column)]; }
  PELT_INLINE const W& At(uint32_t row, uint32_t column) const { return lower[Place(row, column)]; }
  PELT_INLINE void Fill(uint32_t row, uint32_t column, W bare, const W (&b)[kPushes][N],
                        const ContactFrame<W> (&frame)[N], float share) {
    W sum = b[row][0] * hold[column][0];
    for (uint32_t j = 1; j < N; ++j) sum = sum + b[row][j] * hold[column][j];
    const Vec3<W>& first = frame[row / 3].axis[row % 3];
    const Vec3<W>& second = frame[column / 3].axis[column % 3];
    const W apart = Dot(first, second) * bare, joined = sum * W(share);
    At(row, column) = apart + joined;
  }
  PELT_INLINE W Missing(uint32_t row, const Rub<W, N>& rub) const {
    W left = rub.wanted[row / 3][row % 3];
    for (uint32_t r = 0; r < N; ++r)
      for (uint32_t k = 0; k < 3; ++k) left = left - At(row, 3 * r + k) * rub.push[r][k];
    return left;
  }
  PELT_INLINE void SolvePoint(uint32_t q, Rub<W, N>& rub) const {
    const W none = W(0.0f), tiny = W(1.0e-30f);
    const uint32_t n = 3 * q, s = n + 1, t = n + 2;
    const W out = Missing(n, rub) / At(n, n);
    rub.push[q][0] = Max(rub.push[q][0] + out, rub.least[q]);
    const W limit = Max(rub.pressed[q] + rub.push[q][0], none) * rub.mu[q];
    const W first = Missing(s, rub), second = Missing(t, rub);
    const W a = At(s, s), b = At(s, t), c = At(t, t);
    const W before = rub.rubbed[q][0] + rub.push[q][1], beside = rub.rubbed[q][1] + rub.push[q][2];
    // What holds it, if it may be that much.
    const W squares = a * c, cross = b * b;
    const W inverse = W(1.0f) / Max(squares - cross, tiny);
    const W first_c = first * c, second_b = second * b, second_a = second * a, first_b = first * b;
    const W hold_first = before + (first_c - second_b) * inverse;
    const W hold_second = beside + (second_a - first_b) * inverse;
    const W held2 = hold_first * hold_first + hold_second * hold_second;
    const auto sticks = held2 <= limit * limit;
    // Else against where it slips: a step of the same size along both.
    const W step = W(1.0f) / Max(Max(a, c), tiny);
    const W slide_first = before + first * step, slide_second = beside + second * step;
    const W slid2 = slide_first * slide_first + slide_second * slide_second;
    const W shorter = Min(limit * Rsqrt(Max(slid2, tiny)), W(1.0f));
    const W one = Select(sticks, hold_first, slide_first * shorter);
    const W two = Select(sticks, hold_second, slide_second * shorter);
    rub.push[q][1] = one - rub.rubbed[q][0];
    rub.push[q][2] = two - rub.rubbed[q][1];
  }
};

// A chain's friction in one substep.
template <class W, uint32_t N>
struct Friction {
  typename W::Mask known[N];  // points whose contact was found
  W pressed[N];               // force along the normal
  Vec3<W> rubbed[N];          // and across it
  Vec3<W> before[N];          // how far each went along its collider before it touched, links

  PELT_INLINE void Clear() {
    const W none = W(0.0f);
    for (uint32_t q = 0; q < N; ++q) {
      known[q] = W(1.0f) < none;
      pressed[q] = none;
      rubbed[q] = before[q] = {none, none, none};
    }
  }

  // One push of every point that is, or was, inside something, out and back along it, as
  // Touches::Press.
  template <bool kBest>
  __attribute__((noinline)) void Press(const ModalTable<N>& t, const NewtonMatrix<W, N>& matrix,
                                       const Surroundings<W, N>& around,
                                       const Obstacle<W> (&obstacle)[N], const Vec3<W> (&n)[N],
                                       const W (&depth)[N], const Vec3<W> (&at)[N], W (&total)[N],
                                       Vec3<W> (&force)[N], Motion<W, N>& m) {
    const W none = W(0.0f), time = W(around.time);
    float response[N][N];
    Vec3<W> w[N], push[N];
    ContactFrame<W> frame[N];
    W share[N], change[N];
    Rub<W, N> rub;
    for (uint32_t q = 0; q < N; ++q) {
      const Obstacle<W>& o = obstacle[q];
      const Vec3<W> upper = q == 0 ? Vec3<W>{none, none, none} : at[q - 1];
      const Vec3<W> start = around.StartOf(q, o), point = o.PointOf(upper, at[q]);
      const Vec3<W> slip = SlipOf(q, o, n[q], depth[q], start, point, time);
      frame[q].Make(n[q]);
      rub.wanted[q][0] = depth[q];
      for (uint32_t k = 1; k < 3; ++k) rub.wanted[q][k] = none - Dot(slip, frame[q].axis[k]);
      rub.least[q] = none - total[q];
      rub.mu[q] = CoefficientOf(o, around);
      share[q] = o.share;
      w[q] = Row(m, &Axis<W, N>::w, q);
      for (uint32_t j = 0; j < N; ++j) response[q][j] = 2.0f * t.response[q][j];
    }
    RubLevers<W, N> levers;
    levers.Make(response, w, matrix, frame, share, 0.5f);
    Solve(levers, frame, rub, change, push);
    for (uint32_t q = 0; q < N; ++q) {
      total[q] = total[q] + rub.push[q][0];
      force[q] = force[q] + push[q];
      m.lambda[q] = m.lambda[q] + change[q];
    }
    for (uint32_t k = 0; k < 3; ++k) {
      Axis<W, N>& a = m.axis[k];
      W pull[N], twist[N];
      for (uint32_t j = 0; j < N; ++j) {
        pull[j] = a.w[j] * change[j];
        if constexpr (kBest) twist[j] = a.turn[j] * change[j];
      }
      for (uint32_t i = 0; i < N; ++i) {
        W moved = none;
        for (uint32_t q = 0; q < N; ++q) moved = moved + Component(push[q], k) * levers.give[q][i];
        a.p[i] = a.p[i] + moved;
        a.y[i] = a.y[i] + moved + Weigh<W, N>(t.response[i], pull);
        if constexpr (kBest) a.y[i] = a.y[i] + Weigh<W, N>(t.slope[i], twist);
      }
    }
  }

  // After the substep: impulses that bring about `wanted` along the normals, and take from what is
  // pressed how fast it slips.
  __attribute__((noinline)) void Settle(const float (&response)[N][N],
                                        const NewtonMatrix<W, N>& matrix,
                                        const Surroundings<W, N>& around,
                                        const Obstacle<W> (&obstacle)[N], const Vec3<W> (&d)[N],
                                        const Vec3<W> (&normal)[N], const W (&wanted)[N],
                                        const Vec3<W> (&slip)[N], W (&multiplier)[N],
                                        Vec3<W> (&impulse)[N]) const {
    const W none = W(0.0f), time = W(around.time);
    ContactFrame<W> frame[N];
    W share[N];
    Rub<W, N> rub;
    Friction done;  // by the forces, as impulses
    for (uint32_t q = 0; q < N; ++q) {
      frame[q].Make(normal[q]);
      rub.wanted[q][0] = wanted[q];
      for (uint32_t k = 1; k < 3; ++k) rub.wanted[q][k] = none - Dot(slip[q], frame[q].axis[k]);
      rub.least[q] = W(-1.0e30f);
      rub.mu[q] = CoefficientOf(obstacle[q], around);
      share[q] = obstacle[q].share;
      done.pressed[q] = pressed[q] * time;
      done.rubbed[q] = rubbed[q] * time;
    }
    RubLevers<W, N> levers;
    levers.Make(response, d, matrix, frame, share, 1.0f);
    done.Solve(levers, frame, rub, multiplier, impulse);
  }

 private:
  static PELT_INLINE W CoefficientOf(const Obstacle<W>& o, const Surroundings<W, N>& around) {
    return Select(o.carried > W(0.0f), W(0.0f), W(around.friction));
  }

  // How far point q slipped on its collider since it touched, if it started the substep at `start`.
  PELT_INLINE Vec3<W> SlipOf(uint32_t q, const Obstacle<W>& o, Vec3<W> n, W depth, Vec3<W> start,
                             Vec3<W> at, W time) {
    const W none = W(0.0f);
    const Vec3<W> was = start + o.drift * time, way = at - was;
    const Vec3<W> slip = way - n * Dot(way, n);
    Vec3<W> unused;
    W deep;
    o.Look(was, unused, deep);
    const W gap = Max(none - deep - depth * W(kNearlyThere), none);
    const W outside = gap / Max(gap + depth, W(1.0e-12f));
    const typename W::Mask fresh = o.any & !known[q];
    before[q] = Select<W>(fresh, slip * outside, before[q]);
    known[q] = known[q] | fresh;
    return slip - before[q];
  }

  // Pushes for depths along frames' normals and slips across them. Adds them to what is pressed and
  // rubbed; `force`: each point's, to be added.
  PELT_INLINE void Solve(const RubLevers<W, N>& levers, const ContactFrame<W> (&frame)[N],
                         Rub<W, N>& rub, W (&multiplier)[N], Vec3<W> (&force)[N]) {
    for (uint32_t q = 0; q < N; ++q) {
      rub.pressed[q] = pressed[q];
      for (uint32_t k = 0; k < 2; ++k) rub.rubbed[q][k] = Dot(rubbed[q], frame[q].axis[k + 1]);
    }
    levers.Solve(rub);
    levers.Hold(rub.push, multiplier);
    for (uint32_t q = 0; q < N; ++q) {
      const W(&push)[3] = rub.push[q];
      force[q] = frame[q].Out(push[0], push[1], push[2]);
      pressed[q] = pressed[q] + push[0];
      rubbed[q] = rubbed[q] + force[q] - frame[q].axis[0] * push[0];
    }
  }
};

}  // namespace pelt::modal
