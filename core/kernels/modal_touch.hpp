// Contact of a modal chain within a substep: a constraint like the lengths, in the same metric.
//
// The idea: where the free motion, its lengths brought back, leaves points inside an obstacle, a
// force along the obstacle's normal pushes each of them for the whole substep, as large as it takes
// to end on the surface while the lengths stay. What force j does to point i is known from the
// table's response: with A the lengths' matrix, b^q_i = (n_q . w_i) u^q_i and u^q_i what a unit
// force at point q does to link i,
//
//   kappa^q = -A^-1 b^q,   C_rq = n_r . n_q sum over i <= r of u^q_i + 1/2 b^r . kappa^q,
//   C mu = depth,   mu >= 0.
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

#include "core/kernels/modal_friction.hpp"
#include "core/kernels/modal_impulse.hpp"
#include "core/kernels/modal_notes.hpp"

namespace pelt::modal {

// Times the lengths and the contacts are solved in turn. The first goes by a direction of the
// lengths' force that knows nothing of the contact.
inline constexpr int kTouchRounds = 2;

// What a group's chains can touch this frame, and what they touched in the present substep.
template <class W, uint32_t N>
struct Touches {
  using Mask = typename W::Mask;

  bool use = false;  // false: nothing below is set
  Surroundings<W, N> around;
  W slow;

  bool any = false;
  Vec3<W> normal[N];  // of points that were pushed; else 0
  W arrival[N];       // speed into the obstacle before, links/s; only where a bounce is wanted
  Obstacle<W> obstacle[N];
  Friction<W, N> friction;  // only where the layer has it
  W overlap[N];             // what the first substep left inside, links

  // `slow`: links/s, below which nothing bounces, or a resting strand would never rest.
  PELT_INLINE void Load(const ModalTable<N>& t, const LayerBlock& layer,
                        const SimulateParams& params, Vec3<W> last_surface,
                        const chain::Group<W, N>& g) {
    use = true;
    around.Load(t, layer, params, last_surface, g);
    slow = W(chain::SlowContact(layer, params.dt) * t.euler_speed) * around.per_length;
  }

  // Pushes what is inside out, from motion's y; true where some lane's y, p, w, z or lambda
  // changed.
  template <bool kBest>
  PELT_INLINE bool Resolve(const ModalTable<N>& t, uint32_t substep, Motion<W, N>& motion) {
    any = false;
    if (!use) return false;
    if (substep == 0)
      for (W& depth : overlap) depth = W(0.0f);
    around.Advance(t, substep, motion);
    Vec3<W> at[N];
    PlaceEnds(motion, at);
    const Mask inside = around.IsInside(at);
    if (!Any(inside)) return false;
    ResolveInside<kBest>(t, substep, inside, motion);
    return true;
  }

  // After the substep: speeds of the points that were pushed.
  PELT_INLINE void Settle(const ModalTable<N>& t, uint32_t substep, Motion<W, N>& motion) const {
    if (any) SettleTouched(t, substep, motion);
  }

  // How deep the last substep left each point inside what it leaves slowly, links: of what it was in
  // when the frame began. What a substep could not solve is no overlap from before.
  PELT_INLINE void Left(W (&depth)[N]) const {
    PELT_UNROLL
    for (uint32_t q = 0; q < N; ++q) depth[q] = any ? Min(obstacle[q].left, overlap[q]) : W(0.0f);
  }

  // Lanes that something pushed in the last substep.
  PELT_INLINE Mask Touched() const {
    Mask touched = W(1.0f) < W(0.0f);
    if (any)
      for (const Vec3<W>& n : normal) touched = touched | (Dot(n, n) > W(0.0f));
    return touched;
  }

 private:
  // The lengths' matrix and |y|^2 of motion's w and y.
  template <bool kBest>
  static PELT_INLINE void Linearise(const ModalTable<N>& t, Motion<W, N>& m, W (&square)[N],
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
  static PELT_INLINE void Press(const ModalTable<N>& t, const NewtonMatrix<W, N>& matrix,
                                const Vec3<W> (&n)[N], const W (&depth)[N],
                                const Obstacle<W> (&obstacle)[N], W (&total)[N],
                                Vec3<W> (&force)[N], Motion<W, N>& m) {
    float response[N][N];
    Vec3<W> w[N];
    W least[N], push[N], change[N], share[N];
    PELT_UNROLL
    for (uint32_t i = 0; i < N; ++i) {
      share[i] = obstacle[i].share;
      PELT_UNROLL
      for (uint32_t j = 0; j < N; ++j) response[i][j] = 2.0f * t.response[i][j];
      w[i] = Row(m, &Axis<W, N>::w, i);
      least[i] = W(0.0f) - total[i];
    }
    Levers<W, N> levers;
    levers.Make(response, w, matrix, n, share, 0.5f);
    levers.Solve(depth, least, push);
    levers.Hold(push, change);
    PELT_UNROLL
    for (uint32_t q = 0; q < N; ++q) {
      total[q] = total[q] + push[q];
      force[q] = force[q] + n[q] * push[q];
      m.lambda[q] = m.lambda[q] + change[q];
    }
    for (uint32_t k = 0; k < 3; ++k) {
      Axis<W, N>& a = m.axis[k];
      W pull[N], twist[N];
      PELT_UNROLL
      for (uint32_t j = 0; j < N; ++j) {
        pull[j] = a.w[j] * change[j];
        if constexpr (kBest) twist[j] = a.turn[j] * change[j];
      }
      PELT_UNROLL
      for (uint32_t i = 0; i < N; ++i) {
        W moved = W(0.0f);
        PELT_UNROLL
        for (uint32_t q = 0; q < N; ++q)
          moved = moved + Component(n[q], k) * (push[q] * levers.give[q][i]);
        a.p[i] = a.p[i] + moved;
        a.y[i] = a.y[i] + moved + Weigh<W, N>(t.response[i], pull);
        if constexpr (kBest) a.y[i] = a.y[i] + Weigh<W, N>(t.slope[i], twist);
      }
    }
  }

  // Speeds of the points into their obstacles, had nothing pushed them. Only planes give any back.
  PELT_INLINE void FindArrival(const ModalTable<N>& t, uint32_t substep, const Motion<W, N>& motion,
                               const Vec3<W> (&at)[N], const Vec3<W> (&n)[N]) {
    PELT_UNROLL
    for (uint32_t q = 0; q < N; ++q)
      arrival[q] = W(0.0f) - Dot(around.turn, at[q]) * W(t.euler_speed) * obstacle[q].spins;
    if (around.colliders.moves) PELT_UNROLL
    for (uint32_t q = 0; q < N; ++q) arrival[q] = arrival[q] + Dot(n[q], obstacle[q].drift);
    for (uint32_t k = 0; k < 3; ++k) {
      const Axis<W, N>& a = motion.axis[k];
      W pull[N], z[N];
      PELT_UNROLL
      for (uint32_t j = 0; j < N; ++j) pull[j] = a.w[j] * motion.lambda[j];
      PELT_UNROLL
      for (uint32_t m = 0; m < N; ++m)
        z[m] = a.z[m] + WeighColumn<W, N>(t.shape, m, pull) * W(t.impulse[m]);
      const W root = WeighRoot(t.substep[substep].root_speed, a.root);
      W v = W(0.0f);
      PELT_UNROLL
      for (uint32_t q = 0; q < N; ++q) {
        v = v + Weigh<W, N>(t.shape[q], z);
        arrival[q] = arrival[q] - Component(n[q], k) * (v - root * obstacle[q].carried);
      }
    }
  }

  template <bool kBest>
  __attribute__((noinline)) void ResolveInside(const ModalTable<N>& t, uint32_t substep, Mask lanes,
                                               Motion<W, N>& motion) {
    const W none = W(0.0f);
    Motion<W, N> m;
    CopyStep<kBest>(motion, m);
    NewtonMatrix<W, N> matrix;
    W square[N], total[N], depth[N];
    Vec3<W> force[N], n[N];
    // Of the group's lanes all may touch a collider or, with friction, none (simulate_modal.hpp).
    const bool eases = around.HasColliders();
    const W most = around.per_length * W(kLeaving * around.time);
    if (eases) around.PlaceStart(t, substep, motion);
    Linearise<kBest>(t, m, square, matrix);
    PELT_UNROLL
    for (uint32_t q = 0; q < N; ++q) {
      total[q] = none;
      force[q] = {none, none, none};
      obstacle[q].Clear();
    }
    const bool rubs = eases && around.friction > 0.0f;
    if (rubs) friction.Clear();
    const int rounds = rubs ? kRubRounds : kTouchRounds;
    for (int round = 0; round < rounds; ++round) {
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
      Vec3<W> at[N];
      PlaceEnds(m, at);
      PELT_NO_UNROLL
      for (uint32_t q = 0; q < N; ++q) {
        const Vec3<W> from = q == 0 ? Vec3<W>{none, none, none} : at[q - 1];
        Obstacle<W> found;
        around.Find(q, from, at[q], found);
        const Mask fresh = found.any & lanes & !obstacle[q].any;
        if (Any(fresh)) {
          if (eases) found.Ease(around.StartOf(q, found), W(around.time), most);
          const W along = W(float(q)) + found.share;
          if (around.colliders.moves)
            found.SlowDown(found.PointOf(from, at[q]), W(around.time), W(kFarthestHit) * along);
          found.KeepWithinReach(W(kReach * float(q)) + found.share * W(kReach));
          obstacle[q].Take(fresh, found);
        }
        obstacle[q].Look(obstacle[q].PointOf(from, at[q]), n[q], depth[q]);
      }
      if (round == 0 && around.plane_bounce > 0.0f) FindArrival(t, substep, motion, at, n);
      if (rubs)
        friction.template Press<kBest>(t, matrix, around, obstacle, n, depth, at, total, force, m);
      else
        Press<kBest>(t, matrix, n, depth, obstacle, total, force, m);
    }
    PELT_UNROLL
    for (uint32_t i = 0; i < N; ++i) square[i] = none;
    for (const Axis<W, N>& a : m.axis) PELT_UNROLL
    for (uint32_t i = 0; i < N; ++i) square[i] = square[i] + a.y[i] * a.y[i];
    NewtonStep<kBest>(t, matrix, m, square);
    PELT_UNROLL
    for (uint32_t q = 0; q < N; ++q) {
      const Mask pushed = total[q] > none;
      normal[q] = Select<W>(pushed, n[q], {none, none, none});
      motion.lambda[q] = Select(lanes, m.lambda[q], motion.lambda[q]);
    }
    any = true;
    if (substep == 0) PELT_UNROLL
    for (uint32_t q = 0; q < N; ++q) overlap[q] = obstacle[q].left;
    for (uint32_t k = 0; k < 3; ++k) {
      const Axis<W, N>& from = m.axis[k];
      Axis<W, N>& to = motion.axis[k];
      W pull[N];
      W sum = none;
      PELT_UNROLL
      for (uint32_t i = 0; i < N; ++i) {
        const uint32_t j = N - 1 - i;
        const W on_link = sum + Component(force[j], k) * obstacle[j].share;
        sum = sum + Component(force[j], k);
        pull[j] = on_link + on_link;
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

  __attribute__((noinline)) void SettleTouched(const ModalTable<N>& t, uint32_t substep,
                                               Motion<W, N>& motion) const {
    const W none = W(0.0f);
    Vec3<W> d[N], v[N];
    W wanted[N], least[N], push[N], hold[N], share[N];
    Vec3<W> slip[N], impulse[N];
    const auto& speed = t.substep[substep].root_speed;
    const Vec3<W> root = {WeighRoot(speed, motion.axis[0].root),
                          WeighRoot(speed, motion.axis[1].root),
                          WeighRoot(speed, motion.axis[2].root)};
    Mask touched = W(1.0f) < none;
    PELT_UNROLL
    for (uint32_t i = 0; i < N; ++i) {
      d[i] = Row(motion, &Axis<W, N>::d, i);
      v[i] = {Weigh<W, N>(t.shape[i], motion.axis[0].z), Weigh<W, N>(t.shape[i], motion.axis[1].z),
              Weigh<W, N>(t.shape[i], motion.axis[2].z)};
      touched = touched | (Dot(normal[i], normal[i]) > none);
    }
    const ImpulseMetric<W, N> metric(t, d);
    const Vec3<W> spin = around.turn * W(t.euler_speed);
    const bool soft = around.hardness < 1.0f;
    const W settles = soft ? SettledBySoft(around.hardness) : W(1.0f);
    Vec3<W> at = {none, none, none}, point = at;
    PELT_UNROLL
    for (uint32_t q = 0; q < N; ++q) {
      const Mask pushed = Dot(normal[q], normal[q]) > none;
      // The first link's speed has the root's in it.
      const Vec3<W> upper = q == 0 ? root : point;
      at = at + d[q];
      point = point + v[q];
      share[q] = obstacle[q].share;
      const Vec3<W> met = obstacle[q].PointOf(upper, point);
      const W carried = Select(pushed, obstacle[q].carried, none);
      const W spins = Select(pushed, obstacle[q].spins, none);
      const Vec3<W> along =
          root * carried + Select<W>(pushed, obstacle[q].drift, {none, none, none});
      slip[q] = met - along;
      wanted[q] = none - Dot(normal[q], slip[q]) - Dot(spin, at) * spins;
      if (soft) wanted[q] = Select(spins > none, wanted[q] * settles, wanted[q]);
      if (around.plane_bounce > 0.0f) {
        const Mask bounces = (arrival[q] > slow) & pushed;
        wanted[q] = wanted[q] + Select(bounces, arrival[q] * obstacle[q].bounce, none);
      }
      // May pull: pushed points that could leave one by one would never all lie still.
      least[q] = W(-1.0e30f);
    }
    if (around.friction > 0.0f && around.HasColliders()) {
      friction.Settle(metric.response, metric.lengths, around, obstacle, d, normal, wanted, slip,
                      hold, impulse);
    } else {
      Levers<W, N> levers;
      levers.Make(metric.response, d, metric.lengths, normal, share, 1.0f);
      levers.Solve(wanted, least, push);
      levers.Hold(push, hold);
      PELT_UNROLL
      for (uint32_t q = 0; q < N; ++q) impulse[q] = normal[q] * push[q];
    }
    AddImpulses(t, impulse, share, d, hold, touched, motion);
  }
};

}  // namespace pelt::modal
