// Follow-the-leader, PBD and XPBD: the methods that keep points and velocities.
//
// Points are relative to the root of the present substep: when the root moves by m, every point is
// moved by -m first, and velocities stay those of the world.
//
// Follow-the-leader sets each link's length by moving its lower point only, and gives a share of
// each correction back to the velocity of the point above. PBD sweeps bending and length
// constraints; its bending aims at last link's direction plus the rest curl, and its share is
// tuned. XPBD solves the exact bending energy with compliance 1/k and damping beta, and hard
// lengths.
#pragma once

#include "bench/accuracy/comparison/lane_input.hpp"
#include "bench/accuracy/comparison/tables.hpp"

namespace pelt::accuracy {

template <class V, int n>
struct PointState {
  LaneInput<V, n> last;
  Vec3<V> point[n];
  Vec3<V> rate[n];  // velocity, m/s; PBD: displacement of the last substep, m

  PELT_INLINE void Start(const StepTable& t, const LaneInput<V, n>& input,
                         const Vec3<V> (&direction)[n]) {
    last = input;
    for (int i = 0; i < n; ++i) {
      point[i] = direction[i] * V(t.length[i]);
      if (i > 0) point[i] = point[i] + point[i - 1];
      rate[i] = {V(0.0f), V(0.0f), V(0.0f)};
    }
  }
  // Relative to the root.
  PELT_INLINE Vec3<V> Point(const StepTable&, int i) const { return point[i]; }
};

// Where link j is to lie, given the direction of the link above.
template <class V, int n>
PELT_INLINE Vec3<V> RestTarget(const LaneInput<V, n>& now, int j, Vec3<V> above) {
  if (j == 0) return now.rest[0];
  return Normalize(above + (now.rest[j] - now.rest[j - 1]));
}

// Of methods that know of a substep what holds at its end.
template <class V, int n, class Method>
struct ByEnds {
  using Table = PointTable;
  using State = PointState<V, n>;
  using Input = LaneInput<V, n>;

  PELT_INLINE static void Step(const Table& t, const Input& next, State& state) {
    OverSubsteps(state.last, next, t.step.substeps,
                 [&](const Input&, const Input& now) { Method::Substep(t, now, state); });
  }
};

template <class V, int n>
struct FollowTheLeader : ByEnds<V, n, FollowTheLeader<V, n>> {
  PELT_INLINE static Vec3<V> Velocity(const PointTable&, const PointState<V, n>& state, int i) {
    return state.rate[i];
  }

  PELT_INLINE static void Substep(const PointTable& t, const LaneInput<V, n>& now,
                                  PointState<V, n>& state) {
    const V h = V(t.step.step);
    const Vec3<V> fall = SplatRow<V>(t.step.gravity) * h, push = now.wind * V(t.step.take);
    Vec3<V> old[n], correction[n], upper = {V(0.0f), V(0.0f), V(0.0f)}, above = upper;
    for (int j = 0; j < n; ++j) {
      old[j] = state.point[j] - now.motion;
      Vec3<V> p = old[j] + ((state.rate[j] + fall) * V(t.step.keep) + push) * h;
      const V length = V(t.step.length[j]);
      p = p + (upper + RestTarget(now, j, above) * length - p) * V(t.share[j]);
      above = Normalize(p - upper);
      const Vec3<V> led = upper + above * length;
      correction[j] = led - p;
      upper = state.point[j] = led;
    }
    const V rate = V(t.step.step_inverse);
    for (int j = 0; j < n; ++j) {
      Vec3<V> moved = state.point[j] - old[j];
      if (j + 1 < n) moved = moved - correction[j + 1] * V(t.correction);
      state.rate[j] = moved * rate;
    }
  }
};

template <class V, int n>
struct Pbd : ByEnds<V, n, Pbd<V, n>> {
  PELT_INLINE static Vec3<V> Velocity(const PointTable& t, const PointState<V, n>& state, int i) {
    return state.rate[i] * V(t.step.step_inverse);
  }

  PELT_INLINE static void Substep(const PointTable& t, const LaneInput<V, n>& now,
                                  PointState<V, n>& state) {
    const V h = V(t.step.step);
    const Vec3<V> forced = SplatRow<V>(t.step.gravity) * (h * h) + now.wind * (V(t.step.take) * h);
    Vec3<V> old[n];
    for (int i = 0; i < n; ++i) {
      old[i] = state.point[i] - now.motion;
      state.point[i] = old[i] + state.rate[i] * V(t.step.keep) + forced;
    }
    for (int sweep = 0; sweep < t.step.iterations; ++sweep) Sweep(t, now, state.point);
    for (int i = 0; i < n; ++i) state.rate[i] = state.point[i] - old[i];
  }

 private:
  PELT_INLINE static void Sweep(const PointTable& t, const LaneInput<V, n>& now,
                                Vec3<V> (&point)[n]) {
    const V half = V(0.5f);
    Vec3<V> above = now.rest[0];
    for (int j = 0; j < n; ++j) {
      const V length = V(t.step.length[j]);
      Vec3<V> upper = j > 0 ? point[j - 1] : Vec3<V>{V(0.0f), V(0.0f), V(0.0f)};
      const Vec3<V> turn = (upper + RestTarget(now, j, above) * length - point[j]) * V(t.share[j]);
      if (j == 0 || t.one_sided) {
        point[j] = point[j] + turn;
      } else {
        point[j] = point[j] + turn * half;
        upper = upper - turn * half;
      }
      const Vec3<V> link = point[j] - upper;
      const Vec3<V> excess = link * (V(1.0f) - length * Rsqrt(Dot(link, link)));
      if (j == 0) {
        point[j] = point[j] - excess;
      } else {
        point[j] = point[j] - excess * half;
        upper = upper + excess * half;
        point[j - 1] = upper;
      }
      above = Normalize(point[j] - upper);
    }
  }
};

template <class V, int n>
struct Xpbd {
  using Table = XpbdTable;
  using State = PointState<V, n>;
  using Input = LaneInput<V, n>;

  PELT_INLINE static void Step(const Table& t, const Input& next, State& state) {
    OverSubsteps(state.last, next, t.step.substeps,
                 [&](const Input& before, const Input& now) { Substep(t, before, now, state); });
  }

  PELT_INLINE static Vec3<V> Velocity(const Table&, const State& state, int i) {
    return state.rate[i];
  }

 protected:
  // The bending constraint of joint j: the change of the links' vectors over their lengths, less
  // that of rest.
  PELT_INLINE static Vec3<V> Bend(const Table& t, const Input& now, const Vec3<V> (&point)[n],
                                  int j) {
    if (j == 0) return point[0] * V(t.below[0]) - now.rest[0];
    Vec3<V> link = point[j - 1];
    if (j > 1) link = link - point[j - 2];
    return (point[j] - point[j - 1]) * V(t.below[j]) - link * V(t.above[j]) -
           (now.rest[j] - now.rest[j - 1]);
  }

  PELT_INLINE static void Substep(const Table& t, const Input& before, const Input& now,
                                  State& state) {
    const V h = V(t.step.step);
    const Vec3<V> fall = SplatRow<V>(t.step.gravity) * h, push = now.wind * V(t.step.take);
    Vec3<V> start[n], old[n], multiplier[n];
    if (t.damped)
      for (int j = 0; j < n; ++j) start[j] = Bend(t, before, state.point, j);
    for (int i = 0; i < n; ++i) {
      old[i] = state.point[i] - now.motion;
      state.point[i] = old[i] + ((state.rate[i] + fall) * V(t.step.keep) + push) * h;
      multiplier[i] = {V(0.0f), V(0.0f), V(0.0f)};
    }
    for (int sweep = 0; sweep < t.step.iterations; ++sweep)
      for (int j = 0; j < n; ++j) {
        if (t.bends) Unbend(t, now, start, j, sweep > 0, multiplier[j], state.point);
        SetLength(t, j, state.point);
      }
    for (int i = 0; i < n; ++i) state.rate[i] = (state.point[i] - old[i]) * V(t.step.step_inverse);
  }

  PELT_INLINE static void Unbend(const Table& t, const Input& now, const Vec3<V> (&start)[n], int j,
                                 bool again, Vec3<V>& multiplier, Vec3<V> (&point)[n]) {
    const Vec3<V> bend = Bend(t, now, point, j);
    Vec3<V> residual = bend * V(-1.0f);
    if (again) residual = residual - multiplier * V(t.compliance[j]);
    if (t.damped) residual = residual - (bend - start[j]) * V(t.damping);
    const Vec3<V> change = residual * V(t.denominator[j]);
    multiplier = multiplier + change;
    point[j] = point[j] + change * V(t.inverse_mass[j + 1] * t.below[j]);
    if (j > 0) point[j - 1] = point[j - 1] + change * V(t.inverse_mass[j] * t.at[j]);
    if (j > 1) point[j - 2] = point[j - 2] + change * V(t.inverse_mass[j - 1] * t.above[j]);
  }

  PELT_INLINE static void SetLength(const Table& t, int j, Vec3<V> (&point)[n]) {
    Vec3<V> link = point[j];
    if (j > 0) link = link - point[j - 1];
    const Vec3<V> excess = link * (V(1.0f) - V(t.step.length[j]) * Rsqrt(Dot(link, link)));
    point[j] = point[j] - excess * V(t.lower_share[j]);
    if (j > 0) point[j - 1] = point[j - 1] + excess * V(1.0f - t.lower_share[j]);
  }
};

template <class V, int n>
struct CubicPointState : PointState<V, n> {
  LaneInput<V, n> sample[4];  // newest first; motion: of the frame that ended there

  PELT_INLINE void Start(const StepTable& t, const LaneInput<V, n>& input,
                         const Vec3<V> (&direction)[n]) {
    PointState<V, n>::Start(t, input, direction);
    for (auto& s : sample) s = input;
  }
};

// As OverSubsteps, the root and the rest directions on the cubic through the last four samples.
template <class V, int n, class Substep>
PELT_INLINE void OverCubic(const CubicRootTable& t, int substeps, const LaneInput<V, n>& next,
                           CubicPointState<V, n>& state, Substep&& substep) {
  for (int j = 3; j > 0; --j) state.sample[j] = state.sample[j - 1];
  state.sample[0] = next;
  // Of the samples before the newest, relative to it.
  Vec3<V> root[4];
  root[1] = next.motion * V(-1.0f);
  root[2] = root[1] - state.sample[1].motion;
  root[3] = root[2] - state.sample[2].motion;
  LaneInput<V, n> before = state.last;
  for (int s = 0; s < substeps; ++s) {
    const float(&end)[4] = t.end[s], (&change)[4] = t.change[s];
    const V share = V(float(s + 1) / float(substeps));
    LaneInput<V, n> now;
    now.motion = root[1] * V(change[1]) + root[2] * V(change[2]) + root[3] * V(change[3]);
    now.wind = state.sample[1].wind + (next.wind - state.sample[1].wind) * share;
    for (int i = 0; i < n; ++i)
      now.rest[i] = next.rest[i] * V(end[0]) + state.sample[1].rest[i] * V(end[1]) +
                    state.sample[2].rest[i] * V(end[2]) + state.sample[3].rest[i] * V(end[3]);
    substep(before, now);
    before = now;
  }
  state.last = before;
}

template <class V, int n>
struct XpbdCubic : Xpbd<V, n> {
  using Table = XpbdTable;
  using State = CubicPointState<V, n>;
  using Input = LaneInput<V, n>;

  PELT_INLINE static void Step(const Table& t, const Input& next, State& state) {
    OverCubic(t.root, t.step.substeps, next, state, [&](const Input& before, const Input& now) {
      Xpbd<V, n>::Substep(t, before, now, state);
    });
  }

  PELT_INLINE static Vec3<V> Velocity(const Table&, const State& state, int i) {
    return state.rate[i];
  }
};

}  // namespace pelt::accuracy
