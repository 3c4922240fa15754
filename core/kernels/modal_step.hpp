// One frame of a group of modal chains: the linear part exactly, the lengths by one small Newton
// solve.
//
//   M D'' + c M D' + beta K (D' - s') + K (D - s) = b a + Lambda d,   |d_i| = 1,
//   D = d + e X, s = r + e X, e = M^-1 b: vectors and rest vectors with the root's place X on top
//
// Only |d_i| = 1 is nonlinear. So each substep lets the modes of the linear part run freely under
// the root's motion and gravity (weights from the table: exact for any step), looks where that
// leaves the tangents (p), and finds the multipliers lambda of a constraint force along (d + y) / 2
// that brings them back to length one (y). Written with X inside D the root's motion needs no force
// of its own, so its velocity does not jump where two frames' polynomials meet.
//
// Choices measured on the suite (bench/accuracy; default tier, dangly / soft / medium / stiff, %):
//  - The Newton matrix is symmetric, B_ij w_i . w_j with w = d + y, instead of B_ij y_i . w_j: half
//    the dots, no change in error (0.43 -> 0.41 / 1.9 -> 2.0 / 0.51 / 0.60).
//  - The direction of the constraint force looks a substep's pull ahead, twice (LookAhead): 0.45 /
//    2.2 / 0.50 / 0.71 -> 0.67 / 1.5 / 0.46 / 0.71 -> 0.63 / 1.5 / 0.46 / 0.71, and the heaviest
//    strand at rest is 2e-3 -> 7e-5 -> 3e-6 of its length off its balance, for 3 to 5 % of the time
//    a look. In the fast tier, whose substeps are longer, one look at half a pull: chains of 4
//    links would not converge to rest. The best tier needs one look, or short chains do.
//  - A multiplier is constant over a substep. Letting it move on from the last one's is free and
//    a quarter better on stiff chains, but some chains then do not converge to rest.
//  - Velocities are made tangent after every substep. Every second one saves 5 % of the time and
//    costs uneven dangly and soft chains a factor of five in the best tier.
//  - The best tier's second matrix serves two Newton steps, each in the direction that the last one
//    led to: the Pendulum Challenge misses by 0.8 instead of 1.2 mm, a heavy strand at rest by 6e-7
//    of its length instead of 5e-5, for a seventh of the time. With substeps of 1/160 s it is twice
//    as exact for two fifths more time, but strands that hang over a sphere then swing for ever.
//  - The slope in the default tier is worth no more than its time spent on substeps.
//
// Everything but the dots treats x, y and z alike, so the frame goes through them one axis at a
// time: a third of the values are alive at once.
//
// Invariants: lanes are independent; plus, minus, times and divide alone; a lane that does not
// pass the acceptance test is not used.
#pragma once

#include "core/kernels/modal_curl.hpp"
#include "core/kernels/modal_matrix.hpp"
#include "core/kernels/modal_motion.hpp"

namespace pelt::modal {

// The modes' free motion over one substep that starts with the root at `place`: p and z.
template <class W, uint32_t N>
PELT_INLINE void RunModes(const ModalTableBlock& t, const ModalSubstep& s, bool wind, W place,
                          Axis<W, N>& a) {
  W q[N];
  PELT_UNROLL
  for (uint32_t m = 0; m < N; ++m) {
    const W from = Weigh<W, N>(t.image[m], a.d) + place * W(t.pull_mode[m]), z0 = a.z[m];
    W push = a.force[m];
    if (t.parent_curl != 0) push = push + a.curl[m];
    W q1 = from * W(t.y_of_y[m]) + z0 * W(t.y_of_v[m]) + push * W(t.y_of_force[m]);
    W z1 = from * W(t.v_of_y[m]) + z0 * W(t.v_of_v[m]) + push * W(t.v_of_force[m]);
    PELT_UNROLL
    for (uint32_t k = 1; k < kModalSamples; ++k) {
      q1 = q1 + a.bend[k][m] * W(s.bend_q[k - 1][m]);
      z1 = z1 + a.bend[k][m] * W(s.bend_z[k - 1][m]);
    }
    q[m] = q1;
    a.z[m] = z1;
  }
  if (wind) {
    PELT_UNROLL
    for (uint32_t m = 0; m < N; ++m) {
      q[m] = q[m] + a.wind_step * W(s.wind_q[m]);
      a.z[m] = a.z[m] + a.wind_step * W(s.wind_z[m]);
    }
  }
  PELT_UNROLL
  for (uint32_t i = 0; i < N; ++i) a.p[i] = Weigh<W, N>(t.shape[i], q);
  if (s.root_place[0] != 0.0f) {
    const W root = WeighRoot(s.root_place, a.root);
    PELT_UNROLL
    for (uint32_t i = 0; i < N; ++i) a.p[i] = a.p[i] - root * W(t.root[i]);
  }
}

// A pull that moves the tangents by more than this in a substep, in sum, is not looked ahead whole:
// looks at it do not converge.
inline constexpr float kMostPull = 0.5f;
// Where the weight at each node alone pulls by more than this, strands swing on it faster than
// the substeps follow: of chains of 0.3 to 40 mm, 0.3 to 12 Hz, at three frame rates, some never
// settle above 1.6, in the best tier 0.95.
inline constexpr float kMostWeight = 1.25f, kMostWeightBest = 0.75f;

// Lanes whose swings the substeps follow. The others are too short for them, and
// take the step that settles. `per_length`: parts a metre.
template <class W, uint32_t N>
PELT_INLINE typename W::Mask FollowsWeight(const ModalTableBlock& t, const float (&gravity)[3],
                                           W per_length) {
  float pull = 0.0f, square = 0.0f;
  for (uint32_t i = 0; i < N; ++i) pull += t.pull[i] * t.response[i][i];
  for (const float g : gravity) square += g * g;
  const float most = t.use_slope != 0 ? kMostWeightBest : kMostWeight;
  const W weight = per_length * W(pull);
  return weight * weight * W(square) <= W(most * most);
}

// The share of the last multipliers that LookAhead takes.
template <class W, uint32_t N>
PELT_INLINE W LookShare(const ModalTableBlock& t, const W (&lambda)[N]) {
  W pull = Abs(lambda[0]) * W(t.response[0][0]);
  PELT_UNROLL
  for (uint32_t i = 1; i < N; ++i) pull = pull + Abs(lambda[i]) * W(t.response[i][i]);
  return W(t.look_share * kMostPull) / Max(pull, W(kMostPull));
}

// w from d + p to where `share` of the last multipliers takes it: at rest, where they are right, w
// is then 2 d, y - d is nothing, and the force keeps exactly the balance. Each look is a step of
// w = d + p + response(w): its miss is a substep's pull smaller than the last one's.
template <bool kBest, class W, uint32_t N>
PELT_INLINE void LookAhead(const ModalTableBlock& t, W share, const W (&lambda)[N], Axis<W, N>& a) {
  W free[N];
  PELT_UNROLL
  for (uint32_t i = 0; i < N; ++i) a.w[i] = free[i] = a.d[i] + a.p[i];
  PELT_NO_UNROLL
  for (uint32_t look = 0; look < t.looks; ++look) {
    W pull[N];
    PELT_UNROLL
    for (uint32_t j = 0; j < N; ++j) pull[j] = a.w[j] * (lambda[j] * share);
    PELT_UNROLL
    for (uint32_t i = 0; i < N; ++i) a.w[i] = free[i] + Weigh<W, N>(t.response[i], pull);
  }
  if constexpr (kBest) {
    PELT_UNROLL
    for (uint32_t i = 0; i < N; ++i) a.turn[i] = a.w[i] - (a.d[i] + a.d[i]);
  }
}

// The same where a Newton step has led to y.
template <class W, uint32_t N>
PELT_INLINE void LookAgain(Axis<W, N>& a) {
  PELT_UNROLL
  for (uint32_t i = 0; i < N; ++i) {
    a.w[i] = a.d[i] + a.y[i];
    a.turn[i] = a.y[i] - a.d[i];
  }
}

// y = p + response of the multipliers; adds up |y|^2 and w_i . w_j.
template <bool kBest, class W, uint32_t N>
PELT_INLINE void Respond(const ModalTableBlock& t, const W (&lambda)[N], Axis<W, N>& a,
                         W (&square)[N], W (&gram)[N][N]) {
  W pull[N], twist[N];
  PELT_UNROLL
  for (uint32_t j = 0; j < N; ++j) {
    pull[j] = a.w[j] * lambda[j];
    if constexpr (kBest) twist[j] = a.turn[j] * lambda[j];
  }
  PELT_UNROLL
  for (uint32_t i = 0; i < N; ++i) {
    W y = a.p[i] + Weigh<W, N>(t.response[i], pull);
    if constexpr (kBest) y = y + Weigh<W, N>(t.slope[i], twist);
    a.y[i] = y;
    square[i] = square[i] + y * y;
    PELT_UNROLL
    for (uint32_t j = 0; j <= i; ++j) gram[i][j] = gram[i][j] + a.w[i] * a.w[j];
  }
}

// 1 / sqrt(a) for a near 1: relative error 2e-6 at 0.75 and 1.25, below 1e-7 within 4 % of 1.
template <class W>
PELT_INLINE W RsqrtNearOne(W a) {
  const W e = W(1.0f) - a;
  const W y = W(1.0f) + e * (W(0.5f) + e * (W(0.375f) + e * W(0.3125f)));
  return y * (W(1.5f) - W(0.5f) * a * (y * y));
}

// One Newton step on the multipliers: from y and |y|^2 to y and |y|^2. d|y|^2/dlambda is
// 2 y . dy/dlambda, and w / 2 stands here for y.
template <bool kBest, class W, uint32_t N>
PELT_INLINE void NewtonStep(const ModalTableBlock& t, const NewtonMatrix<W, N>& matrix,
                            Motion<W, N>& motion, W (&square)[N]) {
  W change[N];
  PELT_UNROLL
  for (uint32_t i = 0; i < N; ++i) {
    change[i] = W(1.0f) - square[i];
    square[i] = W(0.0f);
  }
  SolveFactored<W, N>(matrix.lower, matrix.inverse, change);
  PELT_NO_UNROLL
  for (Axis<W, N>& a : motion.axis) {
    W pull[N], twist[N];
    PELT_UNROLL
    for (uint32_t j = 0; j < N; ++j) {
      pull[j] = a.w[j] * change[j];
      if constexpr (kBest) twist[j] = a.turn[j] * change[j];
    }
    PELT_UNROLL
    for (uint32_t i = 0; i < N; ++i) {
      W y = a.y[i] + Weigh<W, N>(t.response[i], pull);
      if constexpr (kBest) y = y + Weigh<W, N>(t.slope[i], twist);
      a.y[i] = y;
      square[i] = square[i] + y * y;
    }
  }
  PELT_UNROLL
  for (uint32_t i = 0; i < N; ++i) motion.lambda[i] = motion.lambda[i] + change[i];
}

template <class W, uint32_t N>
PELT_INLINE void MakeMatrix(const ModalTableBlock& t, const W (&gram)[N][N],
                            NewtonMatrix<W, N>& matrix) {
  PELT_UNROLL
  for (uint32_t i = 0; i < N; ++i) {
    PELT_UNROLL
    for (uint32_t j = 0; j <= i; ++j) matrix.lower[i][j] = gram[i][j] * W(t.response[i][j]);
  }
  Factor<W, N>(matrix.lower, matrix.inverse);
}

// Lanes whose tangents are neither flipped against the free motion nor turned by more than 120
// degrees.
template <class W, uint32_t N>
PELT_INLINE typename W::Mask IsUpright(const Motion<W, N>& motion) {
  W onward[N], back[N];
  PELT_UNROLL
  for (uint32_t i = 0; i < N; ++i) onward[i] = back[i] = W(0.0f);
  PELT_NO_UNROLL
  for (const Axis<W, N>& a : motion.axis) {
    PELT_UNROLL
    for (uint32_t i = 0; i < N; ++i) {
      onward[i] = onward[i] + a.y[i] * a.p[i];
      back[i] = back[i] + a.y[i] * a.d[i];
    }
  }
  typename W::Mask good = W(0.0f) < W(1.0f);
  PELT_UNROLL
  for (uint32_t i = 0; i < N; ++i) good = good & (onward[i] > W(0.0f)) & (back[i] > W(-0.5f));
  return good;
}

// The free motion of a substep, and the lengths brought back. Returns the lanes whose result can
// be trusted. `touches`: what the chain may not enter (modal_touch.hpp).
template <bool kBest, class W, uint32_t N, class Touches>
PELT_INLINE typename W::Mask RunSubstep(const ModalTableBlock& t, uint32_t substep, bool wind,
                                        Touches& touches, Motion<W, N>& motion) {
  const ModalSubstep& s = t.substep[substep];
  W square[N], gram[N][N];
  const auto clear = [&]() __attribute__((always_inline)) {
    for (uint32_t i = 0; i < N; ++i) {
      square[i] = W(0.0f);
      for (uint32_t j = 0; j <= i; ++j) gram[i][j] = W(0.0f);
    }
  };
  const W share = LookShare<W, N>(t, motion.lambda);
  const auto look = [&](Axis<W, N> & a) __attribute__((always_inline)) {
    LookAhead<kBest>(t, share, motion.lambda, a);
    Respond<kBest>(t, motion.lambda, a, square, gram);
  };
  clear();
  if (t.parent_curl != 0) AddCurl<W, N>(t, substep, motion);
  PELT_NO_UNROLL
  for (Axis<W, N>& a : motion.axis) {
    const W place =
        substep == 0 ? a.root[0] * W(-1.0f) : WeighRoot(t.substep[substep - 1].root_place, a.root);
    RunModes(t, s, wind, place, a);
    look(a);
  }
  NewtonMatrix<W, N> matrix;
  MakeMatrix(t, gram, matrix);
  NewtonStep<kBest>(t, matrix, motion, square);
  if constexpr (kBest) {
    const auto look_again = [&]() __attribute__((always_inline)) {
      clear();
      PELT_NO_UNROLL
      for (Axis<W, N>& a : motion.axis) {
        LookAgain(a);
        Respond<true>(t, motion.lambda, a, square, gram);
      }
    };
    look_again();
    MakeMatrix(t, gram, matrix);
    NewtonStep<true>(t, matrix, motion, square);
    look_again();
    NewtonStep<true>(t, matrix, motion, square);
  }
  if (touches.template Resolve<kBest>(t, substep, motion)) {
    clear();
    for (const Axis<W, N>& a : motion.axis)
      for (uint32_t i = 0; i < N; ++i) square[i] = square[i] + a.y[i] * a.y[i];
  }
  typename W::Mask good = substep + 1 == t.substeps ? IsUpright(motion) : W(0.0f) < W(1.0f);
  PELT_UNROLL
  for (uint32_t i = 0; i < N; ++i) {
    good = good & (Abs(square[i] - W(1.0f)) < W(0.25f));
    square[i] = RsqrtNearOne(square[i]);
  }
  PELT_NO_UNROLL
  for (Axis<W, N>& a : motion.axis) {
    W push[N], twist[N];
    PELT_UNROLL
    for (uint32_t i = 0; i < N; ++i) {
      push[i] = a.w[i] * motion.lambda[i];
      if constexpr (kBest) twist[i] = a.turn[i] * motion.lambda[i];
      a.d[i] = a.y[i] * square[i];
    }
    PELT_UNROLL
    for (uint32_t m = 0; m < N; ++m) {
      a.z[m] = a.z[m] + WeighColumn<W, N>(t.shape, m, push) * W(t.impulse[m]);
      if constexpr (kBest)
        a.z[m] = a.z[m] + WeighColumn<W, N>(t.shape, m, twist) * W(t.impulse_slope[m]);
    }
  }
  return good;
}

// What of the vectors' rates is the root's.
template <class W, uint32_t N>
PELT_INLINE W NodeRate(const ModalTableBlock& t, uint32_t i, const W (&z)[N], W root_speed) {
  return Weigh<W, N>(t.shape[i], z) - root_speed * W(t.root[i]);
}

// Takes away what of the tangents' rates would stretch them, in the metric of the masses:
// (M^-1 o d d^T) mu = -d . v.
template <class W, uint32_t N>
PELT_INLINE void MakeTangent(const ModalTableBlock& t, const float (&root_speed)[kModalSamples - 1],
                             Motion<W, N>& motion) {
  NewtonMatrix<W, N> matrix;
  W mu[N];
  PELT_UNROLL
  for (uint32_t i = 0; i < N; ++i) {
    mu[i] = W(0.0f);
    PELT_UNROLL
    for (uint32_t j = 0; j < i; ++j) matrix.lower[i][j] = W(0.0f);
    matrix.lower[i][i] = W(t.inverse_mass[i][i]);
  }
  PELT_NO_UNROLL
  for (Axis<W, N>& a : motion.axis) {
    const W root = WeighRoot(root_speed, a.root);
    PELT_UNROLL
    for (uint32_t i = 0; i < N; ++i) {
      mu[i] = mu[i] - a.d[i] * NodeRate<W, N>(t, i, a.z, root);
      PELT_UNROLL
      for (uint32_t j = 0; j < i; ++j) matrix.lower[i][j] = matrix.lower[i][j] + a.d[i] * a.d[j];
    }
  }
  PELT_UNROLL
  for (uint32_t i = 0; i < N; ++i) {
    PELT_UNROLL
    for (uint32_t j = 0; j < i; ++j)
      matrix.lower[i][j] = matrix.lower[i][j] * W(t.inverse_mass[i][j]);
  }
  Factor<W, N>(matrix.lower, matrix.inverse);
  SolveFactored<W, N>(matrix.lower, matrix.inverse, mu);
  PELT_NO_UNROLL
  for (Axis<W, N>& a : motion.axis) {
    W push[N];
    PELT_UNROLL
    for (uint32_t i = 0; i < N; ++i) push[i] = a.d[i] * mu[i];
    PELT_UNROLL
    for (uint32_t m = 0; m < N; ++m) a.z[m] = a.z[m] + WeighColumn<W, N>(t.shape, m, push);
  }
}

// The whole frame. Lanes that are not in the result keep nothing useful. Out of line: chains at
// vertices, chains of strands and the fallback share it, and compiling it takes half a minute.
template <bool kBest, class W, uint32_t N, class Touches>
__attribute__((noinline)) typename W::Mask StepFrame(const ModalTableBlock& t, bool wind,
                                                     Touches& touches, Motion<W, N>& motion) {
  typename W::Mask good = W(0.0f) < W(1.0f);
  for (uint32_t k = 0; k < t.substeps; ++k) {
    good = good & RunSubstep<kBest>(t, k, wind, touches, motion);
    MakeTangent(t, t.substep[k].root_speed, motion);
    touches.Settle(t, k, motion);
  }
  return good;
}

// By the table's quality.
template <class W, uint32_t N, class Touches>
PELT_INLINE typename W::Mask StepFrame(const ModalTableBlock& t, bool wind, Touches& touches,
                                       Motion<W, N>& motion) {
  return t.use_slope != 0 ? StepFrame<true>(t, wind, touches, motion)
                          : StepFrame<false>(t, wind, touches, motion);
}

// The step that cannot fail: implicit Euler over the whole frame, for the lanes whose Newton solve
// went astray, and those that outpace their substeps (FollowsWeight).
//
// The idea: implicit Euler on vectors of length one is the minimum of 1/2 d^T A d - g . d over unit
// vectors. With the others held, the best direction of one is known exactly: along
// g_i - sum over j of A_ij d_j. Each such move lowers the energy, so sweeping over them cannot
// diverge, cycle or leave unit length, wherever it starts. It starts where the linear system alone
// would put them: sweeps by themselves would take for ever where stiffness lets neighbours turn together
// alone. It is strongly damped, which
// is what a strand thrown across the room wants.
//
// A curl that follows its parent (modal_curl.hpp) is left out of it: for such a frame the curl
// turns with the root.
//
// Invariant: unit directions and finite velocities out for every finite input.

inline constexpr int kFallbackSweeps = 6;
// A root that moves further in a frame is treated as if it moved this far, parts.
inline constexpr float kFallbackReach = 1.0e6f;

// What is known of each tangent along one axis: g above. d, z are those before the frame.
template <class W, uint32_t N>
PELT_INLINE void GatherKnown(const ModalTableBlock& t, const W (&rest)[N], W step, Axis<W, N>& a,
                             W (&known)[N]) {
  W old_bend[N], place[N], pull[N];
  PELT_UNROLL
  for (uint32_t m = 0; m < N; ++m)
    // Last frame's pull is the newest less its first difference, the root's place set aside.
    old_bend[m] = a.bend[0][m] - a.bend[1][m] + a.root[0] * W(t.bend_root[m]);
  PELT_UNROLL
  for (uint32_t i = 0; i < N; ++i) {
    const W start = a.d[i] - step * W(t.root[i]);
    place[i] = start * W(t.euler_place) + Weigh<W, N>(t.shape[i], a.z) * W(t.euler_speed);
    pull[i] = rest[i] + (rest[i] + a.d[i]) * W(t.euler_bend);
  }
  PELT_UNROLL
  for (uint32_t i = 0; i < N; ++i)
    // K r of the last frame is M Phi T.
    known[i] = Weigh<W, N>(t.mass[i], place) + Weigh<W, N>(t.stiffness[i], pull) -
               Weigh<W, N>(t.mass_shape[i], old_bend) * W(t.euler_bend);
}

template <class W, uint32_t N>
PELT_INLINE void SweepLinks(const ModalTableBlock& t, const Vec3<W> (&known)[N], Vec3<W> (&d)[N]) {
  for (uint32_t i = 0; i < N; ++i) {
    Vec3<W> free = known[0] * W(t.euler_inverse[i][0]);
    for (uint32_t j = 1; j < N; ++j) free = free + known[j] * W(t.euler_inverse[i][j]);
    d[i] = NormalizeOr(free, d[i]);
  }
  for (int sweep = 0; sweep < kFallbackSweeps; ++sweep) {
    for (uint32_t k = 0; k < N; ++k) {
      const uint32_t i = sweep % 2 == 0 ? k : N - 1 - k;
      Vec3<W> best = known[i];
      for (uint32_t j = 0; j < N; ++j)
        if (j != i) best = best - d[j] * W(t.euler[i][j]);
      d[i] = NormalizeOr(best, d[i]);
    }
  }
}

// From the state before the frame (motion's d and z) to the one after it. `force`: gravity and
// wind, parts/s^2. `hold`: of sag-free strands (modal_frame.hpp), or null.
template <class W, uint32_t N>
PELT_INLINE void EulerFrame(const ModalTableBlock& t, const Vec3<W> (&rest)[N], const Vec3<W>* hold,
                            Vec3<W> force, Motion<W, N>& motion) {
  const W speed = W(t.euler_speed), reach = W(kFallbackReach);
  W known[3][N], step[3];
  Vec3<W> g[N], d[N];
  for (uint32_t k = 0; k < 3; ++k) {
    W r[N];
    for (uint32_t i = 0; i < N; ++i) r[i] = k == 0 ? rest[i].x : k == 1 ? rest[i].y : rest[i].z;
    step[k] = Clamp(motion.axis[k].root[0], -reach, reach);
    GatherKnown<W, N>(t, r, step[k], motion.axis[k], known[k]);
  }
  const auto& axis = motion.axis;
  for (uint32_t i = 0; i < N; ++i) {
    g[i] = Vec3<W>{known[0][i], known[1][i], known[2][i]} + force * W(t.pull[i]);
    // As the rest directions' pull is, damping included.
    if (hold) g[i] = g[i] + hold[i] * W(1.0f + t.euler_bend);
    d[i] = {axis[0].d[i], axis[1].d[i], axis[2].d[i]};
  }
  SweepLinks<W, N>(t, g, d);
  W velocity[3][N];
  for (uint32_t i = 0; i < N; ++i) {
    const Vec3<W> v = (d[i] - Vec3<W>{axis[0].d[i], axis[1].d[i], axis[2].d[i]}) * speed;
    const Vec3<W> tangent = v - d[i] * Dot(v, d[i]);
    velocity[0][i] = tangent.x, velocity[1][i] = tangent.y, velocity[2][i] = tangent.z;
    motion.axis[0].d[i] = d[i].x, motion.axis[1].d[i] = d[i].y, motion.axis[2].d[i] = d[i].z;
    motion.lambda[i] = W(0.0f);
  }
  for (uint32_t k = 0; k < 3; ++k) {
    const W root = step[k] * speed;
    for (uint32_t i = 0; i < N; ++i) velocity[k][i] = velocity[k][i] + root * W(t.root[i]);
    for (uint32_t m = 0; m < N; ++m) motion.axis[k].z[m] = Weigh<W, N>(t.image[m], velocity[k]);
  }
}

}  // namespace pelt::modal
