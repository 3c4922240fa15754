// Contact of a modal chain within a substep: a constraint like the lengths, in the same metric.
//
// The idea: where the free motion, its lengths brought back, leaves points inside an obstacle, a
// force along the obstacle's normal pushes each of them for the whole substep, as large as it takes
// to end on the surface while the lengths stay. What force j does to point i is known from the
// table's response: with A the lengths' matrix, c^q_i how far point q goes with tangent i, u^q_i what a unit
// force at point q does to tangent i, and b^q_i = (n_q . w_i) u^q_i,
//
//   kappa^q = -A^-1 b^q,   C_rq = n_r . n_q c^r . u^q + 1/2 b^r . kappa^q,   C mu = depth,   mu >= 0.
//
// Points are the strand's places, closer than those that are drawn: at those alone a strand over a ball a third
// as large as it is long would lie a tenth of its length off.
//
// The force joins the free motion, the lengths are solved again about where it leads, and what
// depth is left is taken too. In balance a force that is constant over the substep gives back the
// same place at the same speed, because the linear part is exact: a strand that presses against
// something lies still. (Putting it back on the surface after the step makes it jump for ever: the
// step before did not know of the force.)
//
// A force that stops a point within the substep sends it off again with the speed that took. So
// after the substep a point that was pushed has no speed along the normal, or what a bounce gives
// back of the speed it came with; the same matrix with M^-1 for the response and directions for w.
//
// Invariants: a lane that is inside nothing keeps its bits; lanes are independent.
#pragma once

#include <type_traits>

#include "core/kernels/modal_friction.hpp"
#include "core/kernels/modal_impulse.hpp"
#include "core/kernels/modal_obstacle.hpp"

namespace pelt::modal {

// What a free step notes of what strands touch, in the place of what pushes them out.

// Which lanes end a substep inside something. What such a lane does from there on is of no use.
template <class W, uint32_t N, uint32_t Q>
struct TouchNotes : Meeting<W, N, Q> {
  using Meeting<W, N, Q>::use, Meeting<W, N, Q>::around;
  typename W::Mask inside = W(1.0f) < W(0.0f);

  template <bool kBest>
  PELT_INLINE bool Resolve(const ModalTableBlock& t, uint32_t substep, const Motion<W, N>& motion) {
    if (!use) return false;
    around.Advance(t, substep, motion);
    Vec3<W> at[Q];
    PlaceRows<W, N, Q>(t, motion, &Axis<W, N>::y, around.base, at);
    inside = inside | around.IsInside(at);
    return false;
  }
  PELT_INLINE void Settle(const ModalTableBlock&, uint32_t, const Motion<W, N>&) const {}
};

// Times the lengths and the contacts are solved in turn. The first goes by a direction of the
// lengths' force that knows nothing of the contact.
inline constexpr int kTouchRounds = 2;
// And of turning tangents out of what they are inside, without time.
inline constexpr int kFreeRounds = 3;

struct NoFriction {};

// What a group's chains can touch this frame, and what they touched in the present substep. kMayRub: on colliders,
// if the layer has friction.
template <class W, uint32_t N, uint32_t Q, bool kMayRub>
struct Touches : Meeting<W, N, Q> {
  using Meeting<W, N, Q>::use, Meeting<W, N, Q>::around, Meeting<W, N, Q>::slow;
  using Mask = typename W::Mask;

  bool any = false;
  Vec3<W> normal[Q];  // of points that were pushed; else 0
  W arrival[Q];       // speed into the obstacle before, parts/s; only where a bounce is wanted
  Obstacle<W> obstacle[Q];
  std::conditional_t<kMayRub, Friction<W, N, Q>, NoFriction>
      friction;            // only where the layer has it
  W overlap[Q];            // what the first substep left inside, parts
  PushedPlaces<Q> places;  // at which some lane found an obstacle

  // Pushes what is inside out, from motion's y; true where some lane's y, p, w, z or lambda
  // changed.
  template <bool kBest>
  PELT_INLINE bool Resolve(const ModalTableBlock& t, uint32_t substep, Motion<W, N>& motion) {
    any = false;
    if (!use) return false;
    if (substep == 0)
      for (W& depth : overlap) depth = W(0.0f);
    around.Advance(t, substep, motion);
    Vec3<W> at[Q];
    PlaceRows<W, N, Q>(t, motion, &Axis<W, N>::y, around.base, at);
    const Mask inside = around.IsInside(at);
    if (!Any(inside)) return false;
    ResolveInside<kBest>(t, substep, inside, motion);
    return true;
  }

  // After the substep: speeds of the points that were pushed.
  PELT_INLINE void Settle(const ModalTableBlock& t, uint32_t substep, Motion<W, N>& motion) const {
    if (any) SettleTouched(t, substep, motion);
  }

  // Turns tangents of lanes whose step has failed so that no place is inside anything: the step that cannot fail
  // (modal_step.hpp) knows of nothing in its way, and what it leaves inside would count as an overlap from before.
  __attribute__((noinline)) void FreeAtOnce(const ModalTableBlock& t, Mask lanes,
                                            Motion<W, N>& motion) {
    const W none = W(0.0f);
    around.Advance(t, t.substeps - 1, motion);  // where no lane took a step, no substep did
    for (int round = 0; round < kFreeRounds; ++round) {
      Vec3<W> d[N], at[Q], away[Q];
      W depth[Q], least[Q], push[Q], lever[Q][N];
      PushedPlaces<Q> inside;
      Mask turned = W(1.0f) < none;
      for (uint32_t i = 0; i < N; ++i) d[i] = Row(motion, &Axis<W, N>::d, i);
      PlaceVectors(t, d, around.base, at);
      for (uint32_t q = 0; q < Q; ++q) {
        const Vec3<W> from = q == 0 ? Vec3<W>{none, none, none} : at[q - 1];
        Obstacle<W> found;
        around.Find(q, from, at[q], found);
        if (!Any(found.any)) continue;
        inside.Add(q);
        turned = turned | (found.any & lanes);
        found.KeepWithinReach((W(float(q)) + found.share) * W(around.spacing * kReach));
        found.Look(found.PointOf(from, at[q]), away[q], depth[q]);
        LeverOf<W, N>(t, q, found.share, lever[q]);
        least[q] = none;
      }
      if (inside.count == 0) return;
      const ImpulseMetric<W, N> metric(t, d);
      Pushed<W, N> all;
      SolvePushes(metric, inside, away, lever, depth, least, push, all);
      for (uint32_t i = 0; i < N; ++i) {
        Vec3<W> to = d[i] + all.moved[i];
        for (uint32_t j = 0; j < N; ++j) to = to + d[j] * (all.held[j] * W(t.inverse_mass[i][j]));
        to = Select<W>(turned, NormalizeOr(to, d[i]), d[i]);
        motion.axis[0].d[i] = to.x, motion.axis[1].d[i] = to.y, motion.axis[2].d[i] = to.z;
      }
    }
  }

  // How deep the last substep left each point inside what it leaves slowly, parts: of what it was in
  // when the frame began. What a substep could not solve is no overlap from before.
  PELT_INLINE void Left(W (&depth)[Q]) const {
    PELT_UNROLL
    for (uint32_t q = 0; q < Q; ++q) depth[q] = any ? Min(obstacle[q].left, overlap[q]) : W(0.0f);
  }

  // Lanes that something pushed in the last substep.
  PELT_INLINE Mask Touched() const {
    Mask touched = W(1.0f) < W(0.0f);
    if (any)
      for (const Vec3<W>& n : normal) touched = touched | (Dot(n, n) > W(0.0f));
    return touched;
  }

 private:
  PELT_INLINE bool Rubs() const {
    return kMayRub && around.friction > 0.0f && around.HasColliders();
  }
  // The lengths' matrix and |y|^2 of motion's w and y.
  template <bool kBest>
  static PELT_INLINE void Linearise(const ModalTableBlock& t, Motion<W, N>& m, W (&square)[N],
                                    NewtonMatrix<W, N>& matrix) {
    W gram[N][N];
    PELT_UNROLL
    for (uint32_t i = 0; i < N; ++i) {
      square[i] = W(0.0f);
      PELT_UNROLL
      for (uint32_t j = 0; j <= i; ++j) gram[i][j] = W(0.0f);
    }
    for (Axis<W, N>& a : m.axis) Respond<kBest>(t, m.lambda, a, square, gram);
    MakeMatrix(t, gram, matrix);
  }

  // One push of every point that is, or was, inside something.
  template <bool kBest>
  PELT_INLINE void Press(const ModalTableBlock& t, const NewtonMatrix<W, N>& matrix,
                         const Vec3<W> (&n)[Q], const W (&depth)[Q], W (&total)[Q],
                         Vec3<W> (&force)[Q], Motion<W, N>& m) const {
    PushMetric<W, N> metric;
    ForcesOf(t, matrix, m, metric);
    W least[Q], push[Q], lever[Q][N];
    for (const uint32_t q : places) {
      LeverOf<W, N>(t, q, obstacle[q].share, lever[q]);
      least[q] = W(0.0f) - total[q];
    }
    Pushed<W, N> all;
    SolvePushes(metric, places, n, lever, depth, least, push, all);
    const W share = UsefulShare(t, places, around.base, obstacle, all, m,
                                [&](uint32_t q, Vec3<W> at, W& before, W& after) {
                                  Vec3<W> unused;
                                  W left;
                                  obstacle[q].Look(at, unused, left);
                                  before = before + push[q] * depth[q];
                                  after = after + push[q] * left;
                                });
    all.Scale(share);
    for (const uint32_t q : places) {
      const W size = push[q] * share;
      total[q] = total[q] + size;
      force[q] = force[q] + n[q] * size;
    }
    TakePushes<kBest>(t, all, m);
  }

  // Speeds of the points into their obstacles, had nothing pushed them. Only planes give any back.
  PELT_INLINE void FindArrival(const ModalTableBlock& t, uint32_t substep,
                               const Motion<W, N>& motion, const Vec3<W> (&at)[Q],
                               const Vec3<W> (&n)[Q]) {
    for (const uint32_t q : places)
      arrival[q] = W(0.0f) - Dot(around.turn, at[q]) * W(t.euler_speed) * obstacle[q].spins;
    if (around.colliders.moves)
      for (const uint32_t q : places) arrival[q] = arrival[q] + Dot(n[q], obstacle[q].drift);
    for (uint32_t k = 0; k < 3; ++k) {
      const Axis<W, N>& a = motion.axis[k];
      W pull[N], z[N];
      PELT_UNROLL
      for (uint32_t j = 0; j < N; ++j) pull[j] = a.w[j] * motion.lambda[j];
      PELT_UNROLL
      for (uint32_t m = 0; m < N; ++m)
        z[m] = a.z[m] + WeighColumn<W, N>(t.shape, m, pull) * W(t.impulse[m]);
      const W root = WeighRoot(t.substep[substep].root_speed, a.root);
      W rate[N];
      PELT_UNROLL
      for (uint32_t i = 0; i < N; ++i) rate[i] = NodeRate<W, N>(t, i, z, root);
      for (const uint32_t q : places) {
        const W v = root + Weigh<W, N>(t.place[q], rate);
        arrival[q] = arrival[q] - Component(n[q], k) * (v - root * obstacle[q].carried);
      }
    }
  }

  template <bool kBest>
  __attribute__((noinline)) void ResolveInside(const ModalTableBlock& t, uint32_t substep,
                                               Mask lanes, Motion<W, N>& motion) {
    const W none = W(0.0f);
    Motion<W, N> m;
    CopyStep<kBest>(motion, m);
    NewtonMatrix<W, N> matrix;
    W square[N], total[Q], depth[Q];
    Vec3<W> force[Q], n[Q];
    // Of the group's lanes all may touch a collider or, with friction, none (simulate_modal.hpp).
    const bool eases = around.HasColliders();
    const W most = around.per_length * W(kLeaving * around.time);
    if (eases) around.PlaceStart(t, substep, motion);
    Linearise<kBest>(t, m, square, matrix);
    PELT_UNROLL
    for (uint32_t q = 0; q < Q; ++q) {
      total[q] = arrival[q] = none;
      force[q] = {none, none, none};
      obstacle[q].Clear();
    }
    const bool rubs = Rubs();
    if constexpr (kMayRub)
      if (rubs) friction.Clear();
    const int rounds = rubs ? kRubRounds : kTouchRounds;
    for (int round = 0;; ++round) {
      if (round > 0) {
        const W share = LookShare<W, N>(t, m.lambda);
        for (Axis<W, N>& a : m.axis) {
          if constexpr (kBest) {
            LookAgain(a);
          } else {
            LookAhead<false>(t, share, m.lambda, a);
          }
        }
        Linearise<kBest>(t, m, square, matrix);
        NewtonStep<kBest>(t, matrix, m, square);
      }
      if (round == rounds) break;
      Vec3<W> at[Q];
      PlaceRows<W, N, Q>(t, m, &Axis<W, N>::y, around.base, at);
      places.count = 0;
      PELT_NO_UNROLL
      for (uint32_t q = 0; q < Q; ++q) {
        const Vec3<W> from = q == 0 ? Vec3<W>{none, none, none} : at[q - 1];
        Obstacle<W> found;
        around.Find(q, from, at[q], found);
        const Mask fresh = found.any & lanes & !obstacle[q].any;
        if (Any(fresh)) {
          if (eases) found.Ease(around.StartOf(q, found), W(around.time), most);
          const W along = (W(float(q)) + found.share) * W(around.spacing);
          if (around.colliders.moves)
            found.SlowDown(found.PointOf(from, at[q]), W(around.time), W(kFarthestHit) * along);
          found.KeepWithinReach(along * W(kReach));
          obstacle[q].Take(fresh, found);
        }
        if (!Any(obstacle[q].any)) continue;
        places.Add(q);
        obstacle[q].Look(obstacle[q].PointOf(from, at[q]), n[q], depth[q]);
      }
      if (round == 0 && around.plane_bounce > 0.0f) FindArrival(t, substep, motion, at, n);
      if constexpr (kMayRub)
        if (rubs) {
          friction.template Press<kBest>(t, matrix, around, places, obstacle, n, depth, at, total,
                                         force, m);
          continue;
        }
      Press<kBest>(t, matrix, n, depth, total, force, m);
    }
    W lever[Q][N];
    for (Vec3<W>& each : normal) each = {none, none, none};
    for (const uint32_t q : places) {
      const Mask pushed = total[q] > none;
      normal[q] = Select<W>(pushed, n[q], {none, none, none});
      LeverOf<W, N>(t, q, obstacle[q].share, lever[q]);
    }
    PELT_UNROLL
    for (uint32_t i = 0; i < N; ++i)
      motion.lambda[i] = Select(lanes, m.lambda[i], motion.lambda[i]);
    any = true;
    if (substep == 0) PELT_UNROLL
    for (uint32_t q = 0; q < Q; ++q) overlap[q] = obstacle[q].left;
    for (uint32_t k = 0; k < 3; ++k) {
      const Axis<W, N>& from = m.axis[k];
      Axis<W, N>& to = motion.axis[k];
      W pull[N];
      PELT_UNROLL
      for (uint32_t i = 0; i < N; ++i) {
        W on_node = none;
        for (const uint32_t q : places) on_node = on_node + Component(force[q], k) * lever[q][i];
        pull[i] = on_node + on_node;
        to.p[i] = Select(lanes, from.p[i], to.p[i]);
        to.w[i] = Select(lanes, from.w[i], to.w[i]);
        to.y[i] = Select(lanes, from.y[i], to.y[i]);
        if constexpr (kBest) to.turn[i] = Select(lanes, from.turn[i], to.turn[i]);
      }
      PELT_UNROLL
      for (uint32_t j = 0; j < N; ++j) {
        const W push = WeighColumn<W, N>(t.shape, j, pull) * W(t.impulse[j]);
        to.z[j] = Select(lanes, to.z[j] + push, to.z[j]);
      }
    }
  }

  // A soft surface is a spring, critically damped: the share of a speed that is gone after a
  // substep in which the spring takes the share `s` of a depth, w^2 h^2 = 2 s / (1 - s). Near
  // enough 1 - exp(-2 w h).
  static PELT_INLINE W SettledBySoft(float s) {
    const float stretch = s / (1.0f - s);
    const W square = W(8.0f * stretch), half = W(4.0f * stretch);
    const W exponent = Sqrt(square) + half;
    return exponent / (exponent + W(1.0f));
  }

  __attribute__((noinline)) void SettleTouched(const ModalTableBlock& t, uint32_t substep,
                                               Motion<W, N>& motion) const {
    const W none = W(0.0f);
    Vec3<W> d[N], v[N];
    W wanted[Q], least[Q], push[Q], lever[Q][N];
    Pushed<W, N> all;
    Vec3<W> slip[Q], impulse[Q];
    const auto& speed = t.substep[substep].root_speed;
    const Vec3<W> root = {WeighRoot(speed, motion.axis[0].root),
                          WeighRoot(speed, motion.axis[1].root),
                          WeighRoot(speed, motion.axis[2].root)};
    Mask touched = W(1.0f) < none;
    PELT_UNROLL
    for (uint32_t i = 0; i < N; ++i) {
      d[i] = Row(motion, &Axis<W, N>::d, i);
      v[i] = {NodeRate<W, N>(t, i, motion.axis[0].z, root.x),
              NodeRate<W, N>(t, i, motion.axis[1].z, root.y),
              NodeRate<W, N>(t, i, motion.axis[2].z, root.z)};
    }
    const ImpulseMetric<W, N> metric(t, d);
    const Vec3<W> spin = around.turn * W(t.euler_speed);
    const bool soft = around.hardness < 1.0f;
    const W settles = soft ? SettledBySoft(around.hardness) : W(1.0f);
    for (const uint32_t q : places) {
      const Mask pushed = Dot(normal[q], normal[q]) > none;
      touched = touched | pushed;
      LeverOf<W, N>(t, q, obstacle[q].share, lever[q]);
      Vec3<W> met = root;
      for (uint32_t i = 0; i < N; ++i) met = met + v[i] * lever[q][i];
      const W carried = Select(pushed, obstacle[q].carried, none);
      const W spins = Select(pushed, obstacle[q].spins, none);
      const Vec3<W> along =
          root * carried + Select<W>(pushed, obstacle[q].drift, {none, none, none});
      slip[q] = met - along;
      wanted[q] = none - Dot(normal[q], slip[q]) - Dot(spin, PlaceOf(t, q, d, around.base)) * spins;
      if (soft) wanted[q] = Select(spins > none, wanted[q] * settles, wanted[q]);
      if (around.plane_bounce > 0.0f) {
        const Mask bounces = (arrival[q] > slow) & pushed;
        wanted[q] = wanted[q] + Select(bounces, arrival[q] * obstacle[q].bounce, none);
      }
      // May pull: pushed points that could leave one by one would never all lie still.
      least[q] = W(-1.0e30f);
    }
    bool rubbed = false;
    if constexpr (kMayRub)
      if (Rubs()) {
        friction.Settle(metric, lever, around, places, obstacle, normal, wanted, slip, all,
                        impulse);
        rubbed = true;
      }
    if (!rubbed) {
      SolvePushes(metric, places, normal, lever, wanted, least, push, all);
      for (const uint32_t q : places) impulse[q] = normal[q] * push[q];
    }
    AddImpulses(t, places, impulse, lever, d, all.held, touched, motion);
  }
};

}  // namespace pelt::modal
