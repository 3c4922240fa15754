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
#pragma once

#include "core/kernels/modal_step.hpp"

namespace pelt::modal {

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
// wind, parts/s^2. `hold`: of sag-free strands (modal_start.hpp), or null.
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
