// Rods by block descent: positions and orientations apart, one small energy for each.
//
// Hsu, Wang, Wu, Yuksel, "Stable Cosserat Rods", 2025. A substep minimises implicit Euler's energy
//
//     sum m_i / (2 h^2) |x_i - y_i|^2 + sum K_j / 2 |x_j - x_{j-1} - l_j e_j|^2 + bending,
//
// y_i where the point would go by itself, e_j = R(q_j) e the way segment j's frame points. A sweep
// sets every point to the minimum for that point alone (its Hessian is a number), and every
// orientation to the minimum for that segment alone: without inertia, in closed form by the
// multiplier of |q| = 1. There is no length constraint: K keeps the lengths, and with it the sweeps
// that are needed grow; `stiffness_scale` tunes it by trying, as users do.
//
// Bending is of one of two kinds:
//  - Cosserat: 4 k_j / 2 |q_j - q_{j-1} z_j|^2, z_j the rest curl: bend and twist alike, as the
//    paper has it. For a small angle a between two frames that is k_j a^2 / 2, the chain's. Its curl
//    turns with the segment above it, where the chain's (model L) turns with the root.
//  - the chain's own, k_j / 2 |(d_j - d_{j-1}) - (r_j - r_{j-1})|^2, with e_j = d_j, which has no
//    twist: the same descent without the difference of the models.
// Both damp as the chain does: beta / h times the same energy of the change over the substep.
// Kindnesses: a segment's orientation follows at once behind its point (the paper sweeps all points,
// then all orientations), and the root is on a cubic.
#pragma once

#include "bench/accuracy/comparison/point_methods.hpp"

namespace pelt::accuracy {

template <class V>
struct Quaternion {
  V w;
  Vec3<V> v;

  PELT_INLINE friend Quaternion operator+(Quaternion a, Quaternion b) {
    return {a.w + b.w, a.v + b.v};
  }
  PELT_INLINE friend Quaternion operator*(Quaternion a, V s) { return {a.w * s, a.v * s}; }
  PELT_INLINE friend Quaternion operator*(Quaternion a, Quaternion b) {
    return {a.w * b.w - Dot(a.v, b.v), b.v * a.w + a.v * b.w + Cross(a.v, b.v)};
  }
  PELT_INLINE friend V Dot(Quaternion a, Quaternion b) { return a.w * b.w + Dot(a.v, b.v); }
  PELT_INLINE friend Quaternion Conjugate(Quaternion a) { return {a.w, a.v * V(-1.0f)}; }
  PELT_INLINE friend Quaternion Normalize(Quaternion a) { return a * Rsqrt(Dot(a, a)); }
  PELT_INLINE friend Quaternion Select(typename V::Mask m, Quaternion a, Quaternion b) {
    return {Select(m, a.w, b.w), Select<V>(m, a.v, b.v)};
  }
  // Where it takes the x axis, along which segments lie.
  PELT_INLINE friend Vec3<V> TurnedX(Quaternion q) {
    const V two = V(2.0f), x = q.v.x, y = q.v.y, z = q.v.z;
    return {V(1.0f) - two * (y * y + z * z), two * (x * y + q.w * z), two * (x * z - q.w * y)};
  }
};

// Of the frame with x along `a` and y towards `b`; unit vectors, at right angles.
template <class V>
PELT_INLINE Quaternion<V> QuaternionOf(Vec3<V> a, Vec3<V> b) {
  const Vec3<V> c = Cross(a, b);
  const V one = V(1.0f);
  const V x = b.z - c.y, y = c.x - a.z, z = a.y - b.x;
  const V xy = a.y + b.x, yz = b.z + c.y, zx = c.x + a.z;
  // The one with the largest square is free of cancellation.
  Quaternion<V> best = {one + a.x + b.y + c.z, {x, y, z}};
  V largest = best.w;
  const auto take = [&](V square, Quaternion<V> q) {
    best = Select(square > largest, q, best);
    largest = Max(square, largest);
  };
  const V of_x = one + a.x - b.y - c.z, of_y = one - a.x + b.y - c.z, of_z = one - a.x - b.y + c.z;
  take(of_x, {x, {of_x, xy, zx}});
  take(of_y, {y, {xy, of_y, yz}});
  take(of_z, {z, {zx, yz, of_z}});
  return Normalize(best);
}

// ---- Bending -----------------------------------------------------------------------------------

// The chain's own: orientations are directions.
template <class V, int n>
struct ChainBends {
  using Input = LaneInput<V, n>;

  PELT_INLINE void Start(const Input&, const Vec3<V> (&direction)[n]) {
    for (int j = 0; j < n; ++j) direction_[j] = direction[j];
  }
  PELT_INLINE void Begin(const RodTable& t, const Input& before, const Input& now) {
    const V keep = V(t.keep_strain);
    for (int j = 0; j < n; ++j) {
      Vec3<V> strain = direction_[j] - before.rest[j], curl = now.rest[j];
      if (j > 0) {
        strain = strain - (direction_[j - 1] - before.rest[j - 1]);
        curl = curl - now.rest[j - 1];
      }
      bent_[j] = curl + strain * keep;
    }
  }
  // `pull`: what the segment's length asks for, N m along it.
  PELT_INLINE void Descend(const RodTable& t, int j, Vec3<V> pull) {
    Vec3<V> way = bent_[j];
    if (j > 0) way = way + direction_[j - 1];
    way = pull + way * V(t.bend[j]);
    if (j + 1 < n) way = way + (direction_[j + 1] - bent_[j + 1]) * V(t.bend[j + 1]);
    direction_[j] = NormalizeOr(way, direction_[j]);
  }
  PELT_INLINE Vec3<V> Director(int j) const { return direction_[j]; }

 private:
  Vec3<V> direction_[n];
  Vec3<V> bent_[n];  // what a joint's bend is drawn to in this substep
};

// The Cosserat rod's.
template <class V, int n>
struct CosseratBends {
  using Input = LaneInput<V, n>;
  using Q = Quaternion<V>;

  PELT_INLINE void Start(const Input& input, const Vec3<V> (&direction)[n]) {
    root_ = RootFrame(input);
    Vec3<V> rest = Normalize(input.rest[0]);
    Q frame = root_;
    curl_[0] = {V(1.0f), {V(0.0f), V(0.0f), V(0.0f)}};
    for (int j = 0; j < n; ++j) {
      if (j > 0) {
        const Vec3<V> next = Normalize(input.rest[j]);
        const Q bent = Normalize(Between(rest, next) * frame);
        curl_[j] = Conjugate(frame) * bent;
        frame = bent;
        rest = next;
      }
      // At rest there in the frame that is least turned from its rest.
      turn_[j] = Normalize(Between(rest, direction[j]) * frame);
    }
  }
  PELT_INLINE void Begin(const RodTable& t, const Input&, const Input& now) {
    const V keep = V(t.keep_strain), take = V(1.0f) - keep;
    for (int j = 0; j < n; ++j) {
      const Q joint = Conjugate(j > 0 ? turn_[j - 1] : root_) * turn_[j];
      // q and -q are one rotation: the nearer of the two.
      const V share = Select(Dot(joint, curl_[j]) < V(0.0f), V(0.0f) - take, take);
      bent_[j] = curl_[j] * share + joint * keep;
    }
    root_ = RootFrame(now);
    // The joint at the root was measured from the old frame's sign.
    const V side = Dot(turn_[0], root_ * bent_[0]);
    root_ = Select(side < V(0.0f), root_ * V(-1.0f), root_);
  }
  PELT_INLINE void Descend(const RodTable& t, int j, Vec3<V> pull) {
    Q aim = (j > 0 ? turn_[j - 1] : root_) * bent_[j] * V(4.0f * t.bend[j]);
    if (j + 1 < n) aim = aim + turn_[j + 1] * Conjugate(bent_[j + 1]) * V(4.0f * t.bend[j + 1]);
    // (mu - 2 T) q = aim with T q = pull q (-e): q along (mu + 2 T) aim. mu = |2 pull| + |aim| is
    // exact where the segment lies along its frame.
    const Vec3<V> twice = pull * V(2.0f);
    const V mu = Sqrt(Dot(twice, twice)) + Sqrt(Dot(aim, aim));
    const Q along = Q{V(0.0f), twice} * aim;
    const Q turned = {along.v.x, {V(0.0f) - along.w, V(0.0f) - along.v.z, along.v.y}};
    turn_[j] = Normalize(aim * mu + turned);
  }
  PELT_INLINE Vec3<V> Director(int j) const { return TurnedX(turn_[j]); }

 private:
  // x along the first link's rest direction, y towards the second's.
  PELT_INLINE static Q RootFrame(const Input& input) {
    const Vec3<V> a = Normalize(input.rest[0]);
    return QuaternionOf(a, UnitAcross(a, input.rest[1]));
  }
  // The smallest turn from a to b, not normalised; half a turn where they are opposite.
  PELT_INLINE static Q Between(Vec3<V> a, Vec3<V> b) {
    const V cosine = V(1.0f) + Dot(a, b);
    const Q half = {V(0.0f), UnitAcross(a, b)};
    return Select(cosine > V(1e-6f), Q{cosine, Cross(a, b)}, half);
  }

  Q root_, turn_[n], curl_[n];
  Q bent_[n];  // what a joint is drawn to in this substep
};

// ---- The descent -------------------------------------------------------------------------------

template <class V, int n, class Bends>
struct RodState : CubicPointState<V, n> {
  Bends bends;
  Vec3<V> last_rate[n];

  PELT_INLINE void Start(const StepTable& t, const LaneInput<V, n>& input,
                         const Vec3<V> (&direction)[n]) {
    CubicPointState<V, n>::Start(t, input, direction);
    bends.Start(input, direction);
    for (auto& rate : last_rate) rate = {V(0.0f), V(0.0f), V(0.0f)};
  }
};

template <class V, int n, template <class, int> class BendsOf>
struct RodDescent {
  using Table = RodTable;
  using State = RodState<V, n, BendsOf<V, n>>;
  using Input = LaneInput<V, n>;

  PELT_INLINE static void Step(const Table& t, const Input& next, State& state) {
    OverCubic(t.root, t.step.substeps, next, state,
              [&](const Input& before, const Input& now) { Substep(t, before, now, state); });
  }
  PELT_INLINE static Vec3<V> Velocity(const Table&, const State& state, int i) {
    return state.rate[i];
  }

 private:
  PELT_INLINE static void Substep(const Table& t, const Input& before, const Input& now,
                                  State& state) {
    const V h = V(t.step.step);
    const Vec3<V> gravity = SplatRow<V>(t.step.gravity);
    const Vec3<V> fall = gravity * h, push = now.wind * V(t.step.take);
    Vec3<V> old[n], aim[n];
    for (int i = 0; i < n; ++i) {
      old[i] = state.point[i] - now.motion;
      aim[i] = old[i] + ((state.rate[i] + fall) * V(t.step.keep) + push) * h;
      // Begins where its last acceleration leads it, as far as that was gravity's.
      const Vec3<V> speed_up = (state.rate[i] - state.last_rate[i]) * V(t.step.step_inverse);
      const V fell = Clamp(Dot(speed_up, gravity) * V(t.gravity_inverse_square), V(0.0f), V(1.0f));
      state.last_rate[i] = state.rate[i];
      state.point[i] = aim[i] - fall * (h * V(t.step.keep) * (V(1.0f) - fell));
    }
    state.bends.Begin(t, before, now);
    for (int sweep = 0; sweep < t.step.iterations; ++sweep)
      for (int i = 0; i < n; ++i) {
        DescendPoint(t, i, aim[i], state);
        DescendTurn(t, i, state);
      }
    for (int i = 0; i < n; ++i) state.rate[i] = (state.point[i] - old[i]) * V(t.step.step_inverse);
  }

  PELT_INLINE static void DescendPoint(const Table& t, int i, Vec3<V> aim, State& state) {
    Vec3<V> above = state.bends.Director(i) * V(t.step.length[i]);
    if (i > 0) above = above + state.point[i - 1];
    Vec3<V> sum = aim * V(t.inertia[i]) + above * V(t.stretch[i]);
    if (i + 1 < n) {
      const Vec3<V> link = state.bends.Director(i + 1) * V(t.step.length[i + 1]);
      sum = sum + (state.point[i + 1] - link) * V(t.stretch[i + 1]);
    }
    state.point[i] = sum * V(t.response[i]);
  }
  PELT_INLINE static void DescendTurn(const Table& t, int i, State& state) {
    Vec3<V> link = state.point[i];
    if (i > 0) link = link - state.point[i - 1];
    state.bends.Descend(t, i, link * V(t.stretch[i] * t.step.length[i]));
  }
};

template <class V, int n>
using CosseratRod = RodDescent<V, n, CosseratBends>;
template <class V, int n>
using ChainDescent = RodDescent<V, n, ChainBends>;

}  // namespace pelt::accuracy
