// Implicit Euler and the trapezoid on the links' directions: constant matrices, inverted once, and
// a small Newton solve for the multipliers that keep the lengths.
//
// Implicit Euler takes the constraint force along the new directions and is iterated until it no
// longer changes: the limit of XPBD with a direct solver ("stiff rods"). Lanes where Newton's
// method has not come to length one take the minimum of the step's energy by block descent, link
// after link: slower, and it cannot fail. The trapezoid (which has no energy to descend on, and is
// left bare) takes it along the mean of old and new, then projects the velocities in the metric of
// M; the root's polynomial jumps in velocity at each frame's begin, which is an impulse on the
// first link.
#pragma once

#include "bench/accuracy/comparison/lane_input.hpp"
#include "bench/accuracy/comparison/tables.hpp"

namespace pelt::accuracy {

template <class V, int n>
struct DirectState {
  LaneInput<V, n> sample[4];  // newest first; motion: of the frame that ended there
  Vec3<V> direction[n], rate[n];
  V multiplier[n];
  Vec3<V> root_rate;  // velocity of the root at the end of the last frame (substep), m/s

  PELT_INLINE void Start(const StepTable&, const LaneInput<V, n>& input,
                         const Vec3<V> (&start)[n]) {
    for (auto& s : sample) s = input;
    root_rate = {V(0.0f), V(0.0f), V(0.0f)};
    for (int i = 0; i < n; ++i) {
      direction[i] = start[i];
      rate[i] = root_rate;
      multiplier[i] = V(0.0f);
    }
  }
  PELT_INLINE Vec3<V> Point(const StepTable& t, int i) const {
    Vec3<V> p = direction[0] * V(t.length[0]);
    for (int k = 1; k <= i; ++k) p = p + direction[k] * V(t.length[k]);
    return p;
  }
  PELT_INLINE Vec3<V> Velocity(const StepTable& t, int i) const {
    Vec3<V> v = root_rate;
    for (int k = 0; k <= i; ++k) v = v + rate[k] * V(t.length[k]);
    return v;
  }
  PELT_INLINE void Push(const LaneInput<V, n>& next) {
    sample[3] = sample[2];
    sample[2] = sample[1];
    sample[1] = sample[0];
    sample[0] = next;
  }
};

namespace direct {

template <class V, int n>
PELT_INLINE void AddProduct(const float (&a)[kMaxTableLinks][kMaxTableLinks], const Vec3<V> (&x)[n],
                            Vec3<V> (&sum)[n]) {
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) sum[i] = sum[i] + x[j] * V(a[i][j]);
}

// out = p + response (lambda along).
template <class V, int n>
PELT_INLINE void Respond(const DirectTable& t, const Vec3<V> (&p)[n], const V (&lambda)[n],
                         const Vec3<V> (&along)[n], Vec3<V> (&out)[n]) {
  for (int i = 0; i < n; ++i) {
    out[i] = p[i];
    for (int j = 0; j < n; ++j) out[i] = out[i] + along[j] * (lambda[j] * V(t.response[i][j]));
  }
}

// One Newton step on |out_i| = 1.
template <class V, int n>
PELT_INLINE void Newton(const DirectTable& t, const Vec3<V> (&p)[n], const Vec3<V> (&along)[n],
                        V (&lambda)[n], Vec3<V> (&out)[n]) {
  Respond(t, p, lambda, along, out);
  V jacobian[n][n], change[n];
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) jacobian[i][j] = Dot(out[i], along[j]) * V(t.response[i][j]);
    change[i] = V(0.5f) - V(0.5f) * Dot(out[i], out[i]);
  }
  SolveSmall(jacobian, change);
  for (int i = 0; i < n; ++i) lambda[i] = lambda[i] + change[i];
  Respond(t, p, lambda, along, out);
}

// Makes velocities tangent with the least kinetic energy: (M^-1 o Gram) mu = -d . v.
template <class V, int n>
PELT_INLINE void ProjectRates(const DirectTable& t, const Vec3<V> (&d)[n], Vec3<V> (&v)[n]) {
  V diagonal[n], off[n], mu[n];
  for (int i = 0; i < n; ++i) {
    diagonal[i] = V(t.mass_inverse[i][i]);
    if (i + 1 < n) off[i] = Dot(d[i], d[i + 1]) * V(t.mass_inverse[i][i + 1]);
    mu[i] = V(0.0f) - Dot(d[i], v[i]);
  }
  for (int i = 1; i < n; ++i) {
    const V f = off[i - 1] / diagonal[i - 1];
    diagonal[i] = diagonal[i] - f * off[i - 1];
    mu[i] = mu[i] - f * mu[i - 1];
  }
  mu[n - 1] = mu[n - 1] / diagonal[n - 1];
  for (int i = n - 2; i >= 0; --i) mu[i] = (mu[i] - off[i] * mu[i + 1]) / diagonal[i];
  for (int i = 0; i < n; ++i) {
    const Vec3<V> push = d[i] * mu[i];
    v[i] = v[i] + push * V(t.mass_inverse[i][i]);
    if (i > 0) v[i - 1] = v[i - 1] + push * V(t.mass_inverse[i - 1][i]);
    if (i + 1 < n) v[i + 1] = v[i + 1] + push * V(t.mass_inverse[i + 1][i]);
  }
}

}  // namespace direct

template <class V, int n>
struct ImplicitEuler {
  using Table = DirectTable;
  using State = DirectState<V, n>;
  using Input = LaneInput<V, n>;

  PELT_INLINE static void Step(const Table& t, const Input& next, State& state) {
    OverSubsteps(state.sample[0], next, t.step.substeps,
                 [&](const Input& before, const Input& now) { Substep(t, before, now, state); });
  }

  PELT_INLINE static Vec3<V> Velocity(const Table& t, const State& state, int i) {
    return state.Velocity(t.step, i);
  }

 private:
  PELT_INLINE static void Substep(const Table& t, const Input& before, const Input& now,
                                  State& state) {
    const V per_step = V(t.step.step_inverse);
    const Vec3<V> root_rate = now.motion * per_step;
    const Vec3<V> base = SplatRow<V>(t.step.gravity) + (now.wind - root_rate) * V(t.drag) -
                         (root_rate - state.root_rate) * per_step;
    state.root_rate = root_rate;
    Vec3<V> p[n], rest[n];
    for (int i = 0; i < n; ++i) {
      p[i] = base * V(t.pull[i]);
      rest[i] = now.rest[i] + (now.rest[i] - before.rest[i]) * V(t.damping_rate);
    }
    direct::AddProduct(t.to_direction, state.direction, p);
    direct::AddProduct(t.to_rate, state.rate, p);
    direct::AddProduct(t.to_rest, rest, p);
    Vec3<V> along[n], out[n];
    for (int i = 0; i < n; ++i) along[i] = state.direction[i];
    for (int k = 0; k < t.step.iterations; ++k) {
      direct::Newton(t, p, along, state.multiplier, out);
      for (int i = 0; i < n; ++i) along[i] = out[i];
    }
    Settle(t, p, state, along);
    for (int i = 0; i < n; ++i) {
      state.rate[i] = (along[i] - state.direction[i]) * per_step;
      state.direction[i] = Normalize(along[i]);
    }
  }

  // d_i <- (system p)_i - sum over j of system_ij d_j, normalised, from the old directions: each is
  // the energy's minimum for that link alone.
  PELT_INLINE static void Settle(const Table& t, const Vec3<V> (&p)[n], State& state,
                                 Vec3<V> (&along)[n]) {
    auto good = V(0.0f) < V(1.0f);
    for (int i = 0; i < n; ++i) {
      const V square = Dot(along[i], along[i]);
      good = good & (square > V(0.9f)) & (square < V(1.1f)) &
             (Dot(along[i], state.direction[i]) > V(-0.5f));
    }
    if (AllSet(good)) return;
    Vec3<V> push[n], d[n];
    for (int i = 0; i < n; ++i) {
      d[i] = state.direction[i];
      push[i] = p[0] * V(t.system[i][0]);
      for (int j = 1; j < n; ++j) push[i] = push[i] + p[j] * V(t.system[i][j]);
    }
    for (int sweep = 0; sweep < kDescentSweeps; ++sweep)
      for (int i = 0; i < n; ++i) {
        Vec3<V> sum = push[i];
        for (int j = 0; j < n; ++j)
          if (j != i) sum = sum - d[j] * V(t.system[i][j]);
        d[i] = NormalizeOr(sum, d[i]);
      }
    for (int i = 0; i < n; ++i) {
      along[i] = Select<V>(good, along[i], d[i]);
      state.multiplier[i] = Select(good, state.multiplier[i], V(0.0f));
    }
  }
  static constexpr int kDescentSweeps = 30;
};

template <class V, int n>
struct Trapezoid {
  using Table = DirectTable;
  using State = DirectState<V, n>;
  using Input = LaneInput<V, n>;

  PELT_INLINE static void Step(const Table& t, const Input& next, State& state) {
    state.Push(next);
    // Root positions of the last four samples, relative to the newest.
    Vec3<V> root[4];
    root[1] = state.sample[0].motion * V(-1.0f);
    root[2] = root[1] - state.sample[1].motion;
    root[3] = root[2] - state.sample[2].motion;
    state.rate[0] =
        state.rate[0] - (Mix(t.start_rate, root) - state.root_rate) * V(t.step.length_inverse[0]);
    state.root_rate = Mix(t.end_rate, root);
    for (int s = 0; s < t.step.substeps; ++s) Substep(t, s, root, state);
  }

  PELT_INLINE static Vec3<V> Velocity(const Table& t, const State& state, int i) {
    return state.Velocity(t.step, i);
  }

 private:
  PELT_INLINE static Vec3<V> Mix(const float (&w)[4], const Vec3<V> (&root)[4]) {
    return root[1] * V(w[1]) + root[2] * V(w[2]) + root[3] * V(w[3]);
  }
  PELT_INLINE static Vec3<V> MixRest(const float (&w)[4], const State& state, int i) {
    return state.sample[0].rest[i] * V(w[0]) + state.sample[1].rest[i] * V(w[1]) +
           state.sample[2].rest[i] * V(w[2]) + state.sample[3].rest[i] * V(w[3]);
  }

  PELT_INLINE static void Substep(const Table& t, int s, const Vec3<V> (&root)[4], State& state) {
    const V share = V((float(s) + 0.5f) / float(t.step.substeps));
    const Vec3<V> wind =
        state.sample[1].wind + (state.sample[0].wind - state.sample[1].wind) * share;
    const Vec3<V> base = SplatRow<V>(t.step.gravity) +
                         (wind - Mix(t.change[s], root) * V(t.step.step_inverse)) * V(t.drag) -
                         Mix(t.bend[s], root);
    Vec3<V> p[n], rest[n], out[n], along[n];
    for (int i = 0; i < n; ++i) {
      p[i] = base * V(t.pull[i]);
      rest[i] = MixRest(t.middle[s], state, i) + MixRest(t.change[s], state, i) * V(t.damping_rate);
    }
    direct::AddProduct(t.to_direction, state.direction, p);
    direct::AddProduct(t.to_rate, state.rate, p);
    direct::AddProduct(t.to_rest, rest, p);
    for (int i = 0; i < n; ++i) along[i] = (state.direction[i] + p[i]) * V(0.5f);
    for (int k = 0; k < t.step.iterations; ++k) {
      direct::Newton(t, p, along, state.multiplier, out);
      for (int i = 0; i < n; ++i) along[i] = (state.direction[i] + out[i]) * V(0.5f);
    }
    const V rate = V(2.0f * t.step.step_inverse);
    for (int i = 0; i < n; ++i) {
      state.rate[i] = (out[i] - state.direction[i]) * rate - state.rate[i];
      state.direction[i] = Normalize(out[i]);
    }
    direct::ProjectRates(t, state.direction, state.rate);
  }
};

}  // namespace pelt::accuracy
