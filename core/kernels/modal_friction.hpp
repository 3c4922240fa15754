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
// before does not count as slip.
//
// The points act on each other through the strand, so they are solved one after the other, in sweeps.
//
// Invariants: as modal_touch.hpp's; surface and max_distance rub nothing.
#pragma once

#include "core/kernels/contact_schur.hpp"
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
template <class W, uint32_t Q>
struct Rub {
  W wanted[Q][3];
  W least[Q];      // of the normal's push
  W pressed[Q];    // what pushes along it already
  W rubbed[Q][2];  // and across it
  W mu[Q];
  W push[Q][3];  // the result
};

// How a point gives way to pushes along the axes of its frame.
template <class W, uint32_t N>
struct RubPoint {
  W give[N];
  UnitPush<W, N> way[3];
  W cross;  // of the two across: how far one moves it along the other

  PELT_INLINE void Make(const PushMetric<W, N>& metric, const ContactFrame<W>& frame,
                        const W (&lever)[N]) {
    GiveOf(metric, lever, give);
    W held[N];
    for (uint32_t k = 0; k < 3; ++k) {
      way[k].Make(metric, frame.axis[k], lever, give, held);
      // A point can hardly be pushed along its strand.
      const W least = way[k].bare * W(kLeastGive);
      way[k].own = k == 0 ? Max(way[k].own, least) : way[k].own + least;
    }
    W sum = way[1].pull[0] * held[0];
    for (uint32_t i = 1; i < N; ++i) sum = sum + way[1].pull[i] * held[i];
    cross = Dot(frame.axis[1], frame.axis[2]) * way[2].bare + sum * W(metric.share);
  }
};

// Pushes out of the contacts, then back along them, in sweeps.
template <class W, uint32_t N, uint32_t Q>
struct RubSweeps {
  const PushMetric<W, N>& metric;
  const ContactFrame<W> (&frame)[Q];
  const W (&lever)[Q][N];
  const PushedPlaces<Q>& places;
  RubPoint<W, N> point[Q];

  PELT_INLINE RubSweeps(const PushMetric<W, N>& pushes, const ContactFrame<W> (&frames)[Q],
                        const W (&levers)[Q][N], const PushedPlaces<Q>& at)
      : metric(pushes), frame(frames), lever(levers), places(at) {
    for (const uint32_t q : places) point[q].Make(metric, frame[q], lever[q]);
  }

  PELT_INLINE void Solve(Rub<W, Q>& rub, Pushed<W, N>& all) const {
    for (const uint32_t q : places)
      for (uint32_t k = 0; k < 3; ++k) rub.push[q][k] = W(0.0f);
    all.Clear();
    PELT_NO_UNROLL
    for (int sweep = 0; sweep < kRubSweeps; ++sweep)
      for (const uint32_t q : places) SolvePoint(q, rub, all);
    all.Hold(*metric.lengths);
  }

 private:
  PELT_INLINE W Missing(uint32_t q, uint32_t k, const Rub<W, Q>& rub,
                        const Pushed<W, N>& all) const {
    return rub.wanted[q][k] -
           GoneAlong(metric, all, frame[q].axis[k], lever[q], point[q].way[k].pull);
  }
  PELT_INLINE void Push(uint32_t q, uint32_t k, W to, Rub<W, Q>& rub, Pushed<W, N>& all) const {
    AddPush(frame[q].axis[k], to - rub.push[q][k], point[q].give, point[q].way[k].pull, all);
    rub.push[q][k] = to;
  }
  PELT_INLINE void SolvePoint(uint32_t q, Rub<W, Q>& rub, Pushed<W, N>& all) const {
    const W none = W(0.0f), tiny = W(1.0e-30f);
    const UnitPush<W, N>(&way)[3] = point[q].way;
    all.Hold(*metric.lengths);
    const W out = Missing(q, 0, rub, all) / way[0].own;
    Push(q, 0, Max(rub.push[q][0] + out, rub.least[q]), rub, all);
    all.Hold(*metric.lengths);
    const W limit = Max(rub.pressed[q] + rub.push[q][0], none) * rub.mu[q];
    const W first = Missing(q, 1, rub, all), second = Missing(q, 2, rub, all);
    const W a = way[1].own, b = point[q].cross, c = way[2].own;
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
    Push(q, 1, one - rub.rubbed[q][0], rub, all);
    Push(q, 2, two - rub.rubbed[q][1], rub, all);
  }
};

// A chain's friction in one substep.
template <class W, uint32_t N, uint32_t Q>
struct Friction {
  typename W::Mask known[Q];  // points whose contact was found
  W pressed[Q];               // force along the normal
  Vec3<W> rubbed[Q];          // and across it
  Vec3<W> before[Q];          // how far each went along its collider before it touched, parts

  PELT_INLINE void Clear() {
    const W none = W(0.0f);
    for (uint32_t q = 0; q < Q; ++q) {
      known[q] = W(1.0f) < none;
      pressed[q] = none;
      rubbed[q] = before[q] = {none, none, none};
    }
  }

  // One push of every point that is, or was, inside something, out and back along it, as
  // Touches::Press.
  template <bool kBest>
  __attribute__((noinline)) void Press(const ModalTableBlock& t, const NewtonMatrix<W, N>& matrix,
                                       const Surroundings<W, N, Q>& around,
                                       const PushedPlaces<Q>& places,
                                       const Obstacle<W> (&obstacle)[Q], const Vec3<W> (&n)[Q],
                                       const W (&depth)[Q], const Vec3<W> (&at)[Q], W (&total)[Q],
                                       Vec3<W> (&force)[Q], Motion<W, N>& m) {
    const W none = W(0.0f), time = W(around.time);
    PushMetric<W, N> metric;
    Vec3<W> push[Q];
    ContactFrame<W> frame[Q];
    W lever[Q][N];
    Rub<W, Q> rub;
    Vec3<W> was_at[Q];
    for (const uint32_t q : places) {
      const Obstacle<W>& o = obstacle[q];
      const Vec3<W> upper = q == 0 ? Vec3<W>{none, none, none} : at[q - 1];
      const Vec3<W> start = around.StartOf(q, o), point = o.PointOf(upper, at[q]);
      const Vec3<W> slip = SlipOf(q, o, n[q], depth[q], start, point, time);
      was_at[q] = point;
      frame[q].Make(n[q]);
      rub.wanted[q][0] = depth[q];
      for (uint32_t k = 1; k < 3; ++k) rub.wanted[q][k] = none - Dot(slip, frame[q].axis[k]);
      rub.least[q] = none - total[q];
      rub.mu[q] = CoefficientOf(o, around);
      LeverOf<W, N>(t, q, o.share, lever[q]);
    }
    ForcesOf(t, matrix, m, metric);
    Pushed<W, N> all;
    Solve(metric, places, frame, lever, rub, all);
    const W share = UsefulShare(t, places, around.base, obstacle, all, m,
                                [&](uint32_t q, Vec3<W> point, W& first, W& last) {
                                  Vec3<W> unused;
                                  W left;
                                  obstacle[q].Look(point, unused, left);
                                  first = first + rub.push[q][0] * depth[q];
                                  last = last + rub.push[q][0] * left;
                                  for (uint32_t k = 1; k < 3; ++k) {
                                    const W gone = Dot(point - was_at[q], frame[q].axis[k]);
                                    const W wanted = rub.wanted[q][k];
                                    first = first + rub.push[q][k] * wanted;
                                    last = last + rub.push[q][k] * (wanted - gone);
                                  }
                                });
    all.Scale(share);
    Take(places, frame, share, rub, push);
    for (const uint32_t q : places) {
      total[q] = total[q] + rub.push[q][0] * share;
      force[q] = force[q] + push[q];
    }
    TakePushes<kBest>(t, all, m);
  }

  // After the substep: impulses that bring about `wanted` along the normals, and take from what is
  // pressed how fast it slips.
  __attribute__((noinline)) void Settle(const PushMetric<W, N>& metric, const W (&lever)[Q][N],
                                        const Surroundings<W, N, Q>& around,
                                        const PushedPlaces<Q>& places,
                                        const Obstacle<W> (&obstacle)[Q],
                                        const Vec3<W> (&normal)[Q], const W (&wanted)[Q],
                                        const Vec3<W> (&slip)[Q], Pushed<W, N>& all,
                                        Vec3<W> (&impulse)[Q]) const {
    const W none = W(0.0f), time = W(around.time);
    ContactFrame<W> frame[Q];
    Rub<W, Q> rub;
    Friction done;  // by the forces, as impulses
    for (const uint32_t q : places) {
      frame[q].Make(normal[q]);
      rub.wanted[q][0] = wanted[q];
      for (uint32_t k = 1; k < 3; ++k) rub.wanted[q][k] = none - Dot(slip[q], frame[q].axis[k]);
      rub.least[q] = W(-1.0e30f);
      rub.mu[q] = CoefficientOf(obstacle[q], around);
      done.pressed[q] = pressed[q] * time;
      done.rubbed[q] = rubbed[q] * time;
    }
    done.Solve(metric, places, frame, lever, rub, all);
    done.Take(places, frame, W(1.0f), rub, impulse);
  }

 private:
  static PELT_INLINE W CoefficientOf(const Obstacle<W>& o, const Surroundings<W, N, Q>& around) {
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

  // Pushes for depths along frames' normals and slips across them, beside what is pressed and rubbed.
  PELT_INLINE void Solve(const PushMetric<W, N>& metric, const PushedPlaces<Q>& places,
                         const ContactFrame<W> (&frame)[Q], const W (&lever)[Q][N], Rub<W, Q>& rub,
                         Pushed<W, N>& all) const {
    for (const uint32_t q : places) {
      rub.pressed[q] = pressed[q];
      for (uint32_t k = 0; k < 2; ++k) rub.rubbed[q][k] = Dot(rubbed[q], frame[q].axis[k + 1]);
    }
    const RubSweeps<W, N, Q> sweeps(metric, frame, lever, places);
    sweeps.Solve(rub, all);
  }

  // Adds a share of the pushes to what is pressed and rubbed; `force`: each point's.
  PELT_INLINE void Take(const PushedPlaces<Q>& places, const ContactFrame<W> (&frame)[Q], W share,
                        const Rub<W, Q>& rub, Vec3<W> (&force)[Q]) {
    for (const uint32_t q : places) {
      const W out = rub.push[q][0] * share, first = rub.push[q][1] * share;
      const W second = rub.push[q][2] * share;
      force[q] = frame[q].Out(out, first, second);
      pressed[q] = pressed[q] + out;
      rubbed[q] = rubbed[q] + force[q] - frame[q].axis[0] * out;
    }
  }
};

}  // namespace pelt::modal
