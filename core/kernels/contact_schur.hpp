// How places of a strand give way to pushes while its tangents keep their length, and the pushes that bring about
// what is wanted: the contacts' Schur complement of the lengths (modal_touch.hpp has the formulas). For forces over
// a substep and for impulses.
//
// The idea: the lengths' L D L^T, solved halfway for each place, gives the complement by N products for each two of them.
// With that a place's push is at once taken from what every other one lacks: a place waits for the one before it by
// three operations, and not by a solve.
#pragma once

#include "core/kernels/modal_matrix.hpp"
#include "core/kernels/modal_motion.hpp"

namespace pelt::modal {

// Sweeps over the contacts of one strand; they act on each other. Two change the errors of ground and colliders by under
// a tenth, but do not hold strands of 4 nodes within `max_distance`: the reference is then 14 % off itself.
inline constexpr int kTouchSweeps = 4;
// A point can hardly be pushed along its strand: this share of what it would give way without lengths.
inline constexpr float kLeastGive = 0.02f;

// Those of Q places that something pushes in some lane of a group, in order. The others would be pushed by nothing.
template <uint32_t Q>
struct PushedPlaces {
  uint32_t count = 0, place[Q];

  PELT_INLINE void Add(uint32_t q) { place[count++] = q; }
  PELT_INLINE const uint32_t* begin() const { return place; }
  PELT_INLINE const uint32_t* end() const { return place + count; }
};

// How a point between a place and the one before it goes with each tangent, `share` of the way to the place; and
// what a push on it is on each of them.
template <class W, uint32_t N>
PELT_INLINE void LeverOf(const ModalTableBlock& t, uint32_t place, W share, W (&lever)[N]) {
  PELT_UNROLL
  for (uint32_t i = 0; i < N; ++i) {
    const float to = t.place[place][i], from = place == 0 ? 0.0f : t.place[place - 1][i];
    lever[i] = W(from) + W(to - from) * share;
  }
}

// What pushes work against: how tangents give way without their lengths, which way those point, the lengths'
// matrix, and the share of it that counts (1/2 where their directions are d + p, 1 where they are d).
template <class W, uint32_t N>
struct PushMetric {
  float response[N][N];
  Vec3<W> along[N];
  const NewtonMatrix<W, N>* lengths;
  float share;
};

// What all pushes together do.
template <class W, uint32_t N>
struct Pushed {
  Vec3<W> moved[N];  // tangents, their lengths left aside
  W pulled[N];       // along the tangents
  W held[N];         // multipliers that keep the lengths

  PELT_INLINE void Clear() {
    const W none = W(0.0f);
    for (uint32_t i = 0; i < N; ++i) {
      moved[i] = {none, none, none};
      pulled[i] = held[i] = none;
    }
  }
  // What pushes of those sizes along the normals do.
  template <uint32_t Q>
  PELT_INLINE void Take(const PushMetric<W, N>& metric, const PushedPlaces<Q>& places,
                        const Vec3<W> (&normal)[Q], const W (&lever)[Q][N], const W (&push)[Q]) {
    const W none = W(0.0f);
    Vec3<W> force[N];
    for (Vec3<W>& on_node : force) on_node = {none, none, none};
    for (const uint32_t q : places)
      for (uint32_t i = 0; i < N; ++i) force[i] = force[i] + normal[q] * (push[q] * lever[q][i]);
    for (uint32_t i = 0; i < N; ++i) {
      moved[i] = force[0] * W(metric.response[i][0]);
      PELT_UNROLL
      for (uint32_t j = 1; j < N; ++j) moved[i] = moved[i] + force[j] * W(metric.response[i][j]);
      pulled[i] = Dot(moved[i], metric.along[i]);
    }
    Hold(*metric.lengths);
  }
  PELT_INLINE void Scale(W share) {
    for (uint32_t i = 0; i < N; ++i) {
      moved[i] = moved[i] * share;
      held[i] = held[i] * share;
    }
  }
  PELT_INLINE void Hold(const NewtonMatrix<W, N>& lengths) {
    PELT_UNROLL
    for (uint32_t i = 0; i < N; ++i) held[i] = W(0.0f) - pulled[i];
    SolveFactored<W, N>(lengths.lower, lengths.inverse, held);
  }
};

// A push along `axis` of unit size on a point with that lever.
template <class W, uint32_t N>
struct UnitPush {
  W pull[N];  // along each tangent
  W own;      // how far the point gives way, the lengths kept
  W bare;     // and without them

  // `give`: of each tangent, to a push in any direction; `held`: the multipliers that go with it.
  PELT_INLINE void Make(const PushMetric<W, N>& metric, Vec3<W> axis, const W (&lever)[N],
                        const W (&give)[N], W (&held)[N]) {
    bare = give[0] * lever[0];
    PELT_UNROLL
    for (uint32_t i = 0; i < N; ++i) {
      pull[i] = Dot(axis, metric.along[i]) * give[i];
      held[i] = W(0.0f) - pull[i];
      if (i > 0) bare = bare + give[i] * lever[i];
    }
    SolveFactored<W, N>(metric.lengths->lower, metric.lengths->inverse, held);
    W sum = pull[0] * held[0];
    PELT_UNROLL
    for (uint32_t i = 1; i < N; ++i) sum = sum + pull[i] * held[i];
    own = Dot(axis, axis) * bare + sum * W(metric.share);
  }
};

template <class W, uint32_t N>
PELT_INLINE void GiveOf(const PushMetric<W, N>& metric, const W (&lever)[N], W (&give)[N]) {
  PELT_UNROLL
  for (uint32_t i = 0; i < N; ++i) {
    give[i] = lever[0] * W(metric.response[i][0]);
    PELT_UNROLL
    for (uint32_t j = 1; j < N; ++j) give[i] = give[i] + lever[j] * W(metric.response[i][j]);
  }
}

// How far a point with that lever has gone along `axis`.
template <class W, uint32_t N>
PELT_INLINE W GoneAlong(const PushMetric<W, N>& metric, const Pushed<W, N>& all, Vec3<W> axis,
                        const W (&lever)[N], const W (&pull)[N]) {
  Vec3<W> at = all.moved[0] * lever[0];
  W held = pull[0] * all.held[0];
  PELT_UNROLL
  for (uint32_t i = 1; i < N; ++i) {
    at = at + all.moved[i] * lever[i];
    held = held + pull[i] * all.held[i];
  }
  const W free = Dot(axis, at), kept = held * W(metric.share);
  return free + kept;
}

template <class W, uint32_t N>
PELT_INLINE void AddPush(Vec3<W> axis, W size, const W (&give)[N], const W (&pull)[N],
                         Pushed<W, N>& all) {
  const Vec3<W> push = axis * size;
  PELT_UNROLL
  for (uint32_t i = 0; i < N; ++i) {
    all.moved[i] = all.moved[i] + push * give[i];
    all.pulled[i] = all.pulled[i] + pull[i] * size;
  }
}

// How pushed places go with each other's pushes, the lengths kept: the Schur complement, by their order in the list.
template <class W, uint32_t N, uint32_t Q>
struct ContactSchur {
  W between[Q][Q];
  W inverse[Q];  // of how far each gives way to its own push

  PELT_INLINE ContactSchur(const PushMetric<W, N>& metric, const PushedPlaces<Q>& places,
                           const Vec3<W> (&normal)[Q], const W (&lever)[Q][N]) {
    W half[Q][N];  // L^-1 of what a place's push pulls along the tangents, of the lengths' L D L^T
    for (uint32_t a = 0; a < places.count; ++a) {
      const uint32_t q = places.place[a];
      const Vec3<W> axis = normal[q];
      W give[N], scaled[N];
      GiveOf(metric, lever[q], give);
      PELT_UNROLL
      for (uint32_t i = 0; i < N; ++i) half[a][i] = Dot(axis, metric.along[i]) * give[i];
      PELT_UNROLL
      for (uint32_t i = 0; i < N; ++i) {
        scaled[i] = half[a][i] * metric.lengths->inverse[i];
        PELT_UNROLL
        for (uint32_t r = i + 1; r < N; ++r)
          half[a][r] = half[a][r] - metric.lengths->lower[r][i] * scaled[i];
        scaled[i] = scaled[i] * W(metric.share);
      }
      W bare = W(0.0f);
      PELT_NO_UNROLL
      for (uint32_t b = 0; b <= a; ++b) {
        const uint32_t p = places.place[b];
        bare = give[0] * lever[p][0];
        W held = scaled[0] * half[b][0];
        PELT_UNROLL
        for (uint32_t i = 1; i < N; ++i) {
          bare = bare + give[i] * lever[p][i];
          held = held + scaled[i] * half[b][i];
        }
        between[a][b] = between[b][a] = Dot(axis, normal[p]) * bare - held;
      }
      inverse[a] = W(1.0f) / Max(between[a][a], W(kLeastGive) * bare);
    }
  }
};

// Pushes along normals at places, each at least `least`, that bring about `wanted`; and what they do. A point
// without a normal is not pushed.
template <class W, uint32_t N, uint32_t Q>
PELT_INLINE void SolvePushes(const PushMetric<W, N>& metric, const PushedPlaces<Q>& places,
                             const Vec3<W> (&normal)[Q], const W (&lever)[Q][N],
                             const W (&wanted)[Q], const W (&least)[Q], W (&push)[Q],
                             Pushed<W, N>& all) {
  const ContactSchur<W, N, Q> schur(metric, places, normal, lever);
  W left[Q];
  for (uint32_t a = 0; a < places.count; ++a) {
    left[a] = wanted[places.place[a]];
    push[places.place[a]] = W(0.0f);
  }
  PELT_NO_UNROLL
  for (int sweep = 0; sweep < kTouchSweeps; ++sweep)
    for (uint32_t a = 0; a < places.count; ++a) {
      const uint32_t q = places.place[a];
      const W to = Max(push[q] + left[a] * schur.inverse[a], least[q]), step = to - push[q];
      push[q] = to;
      for (uint32_t b = 0; b < places.count; ++b) left[b] = left[b] - schur.between[a][b] * step;
    }
  all.Take(metric, places, normal, lever, push);
}

// What forces over a substep work against.
template <class W, uint32_t N>
PELT_INLINE void ForcesOf(const ModalTableBlock& t, const NewtonMatrix<W, N>& lengths,
                          const Motion<W, N>& motion, PushMetric<W, N>& metric) {
  for (uint32_t i = 0; i < N; ++i) {
    metric.along[i] = Row(motion, &Axis<W, N>::w, i);
    for (uint32_t j = 0; j < N; ++j) metric.response[i][j] = 2.0f * t.response[i][j];
  }
  metric.lengths = &lengths;
  metric.share = 0.5f;
}

// The share of pushes that does what they are for. Tangents that they made longer are unit again after it, which takes
// places further: so far that the pushes do less work than nothing on what is then left to do. All of it, where they
// do not. `work`: adds a place's, before and after, given where its point is then.
template <class W, uint32_t N, uint32_t Q, class Obstacle, class Work>
PELT_INLINE W UsefulShare(const ModalTableBlock& t, const PushedPlaces<Q>& places,
                          const Vec3<W> (&base)[Q], const Obstacle (&obstacle)[Q],
                          const Pushed<W, N>& all, const Motion<W, N>& motion, const Work& work) {
  const W none = W(0.0f), one = W(1.0f);
  Vec3<W> y[N], pull[N];
  for (uint32_t i = 0; i < N; ++i) pull[i] = Row(motion, &Axis<W, N>::w, i) * all.held[i];
  for (uint32_t i = 0; i < N; ++i) {
    y[i] = Row(motion, &Axis<W, N>::y, i) + all.moved[i];
    for (uint32_t j = 0; j < N; ++j) y[i] = y[i] + pull[j] * W(t.response[i][j]);
    y[i] = y[i] * Rsqrt(Max(Dot(y[i], y[i]), W(1.0e-6f)));
  }
  W before = none, after = none;
  for (const uint32_t q : places) {
    const Vec3<W> to = PlaceOf(t, q, y, base);
    const Vec3<W> from = q == 0 ? Vec3<W>{none, none, none} : PlaceOf(t, q - 1, y, base);
    work(q, obstacle[q].PointOf(from, to), before, after);
  }
  const typename W::Mask beyond = (after < none) & (before > none);
  return Select(beyond, before / Select(beyond, before - after, one), one);
}

// Takes what forces do into the substep: p, y and the multipliers.
template <bool kBest, class W, uint32_t N>
PELT_INLINE void TakePushes(const ModalTableBlock& t, const Pushed<W, N>& all,
                            Motion<W, N>& motion) {
  for (uint32_t i = 0; i < N; ++i) motion.lambda[i] = motion.lambda[i] + all.held[i];
  for (uint32_t k = 0; k < 3; ++k) {
    Axis<W, N>& a = motion.axis[k];
    W pull[N], twist[N];
    for (uint32_t j = 0; j < N; ++j) {
      pull[j] = a.w[j] * all.held[j];
      if constexpr (kBest) twist[j] = a.turn[j] * all.held[j];
    }
    for (uint32_t i = 0; i < N; ++i) {
      const W moved = Component(all.moved[i], k);
      a.p[i] = a.p[i] + moved;
      a.y[i] = a.y[i] + moved + Weigh<W, N>(t.response[i], pull);
      if constexpr (kBest) a.y[i] = a.y[i] + Weigh<W, N>(t.slope[i], twist);
    }
  }
}

}  // namespace pelt::modal
