// What a modal frame begins with and what it leaves.
//
// Begins with (FrameStart): rest directions, the roots' and the wind's course since the last frames,
// and the state; who starts afresh, and who is only carried along. Leaves (FrameEnd): state and
// points, but for lanes at rest, which keep their bits.
#pragma once

#include <type_traits>

#include "core/kernels/modal_history.hpp"
#include "core/kernels/modal_motion.hpp"
#include "core/kernels/modal_obstacle.hpp"
#include "core/kernels/modal_ports.hpp"

namespace pelt::modal {

// A frame that is too long to be stepped (a level loads, a window is dragged): strands are carried
// along by their roots.
//
// The idea: substeps of more than 1/80 s follow nothing that a strand does, and what they make of a
// root that was away for a while looks worse than a strand that does nothing. So a strand keeps its
// shape, turned as its first node's rest tangent turned, and starts anew from there: at rest
// towards its root, which is taken to have come here at an even speed.
//
// Last frame's rest directions are in its pull, r = K^-1 M Phi T. A strand without stiffness has
// none; it keeps its directions, as it hangs from gravity and not from its root.
//
// Invariant: unit directions in, unit directions out.

// The rest tangent of the first node one frame ago; shorter than a half where it is not known.
template <class W, uint32_t N>
PELT_INLINE Vec3<W> LastRest(const ModalTableBlock& t, const Motion<W, N>& motion) {
  W rest[3];
  for (uint32_t k = 0; k < 3; ++k) {
    const Axis<W, N>& a = motion.axis[k];
    W pull[N];
    // The newest pull less its first difference, the root's place set aside.
    for (uint32_t m = 0; m < N; ++m)
      pull[m] = a.bend[0][m] - a.bend[1][m] + a.root[0] * W(t.bend_root[m]);
    rest[k] = Weigh<W, N>(t.rest_of_bend[0], pull);
  }
  return {rest[0], rest[1], rest[2]};
}

// The same of this frame, with what holds it up.
template <class W, uint32_t N>
PELT_INLINE Vec3<W> NowRest(const ModalTableBlock& t, const Motion<W, N>& motion) {
  return {Weigh<W, N>(t.rest_of_bend[0], motion.axis[0].bend[0]),
          Weigh<W, N>(t.rest_of_bend[0], motion.axis[1].bend[0]),
          Weigh<W, N>(t.rest_of_bend[0], motion.axis[2].bend[0])};
}

// Directions `d` at the end of the frame, from motion's at its start.
template <class W, uint32_t N>
PELT_INLINE void CarryFrame(const ModalTableBlock& t, Vec3<W> rest, const Motion<W, N>& motion,
                            Vec3<W> (&d)[N]) {
  const Vec3<W> last = LastRest(t, motion);
  const typename W::Mask known = Dot(last, last) > W(0.25f);
  const Vec3<W> from = NormalizeOr(last, rest);
  for (uint32_t i = 0; i < N; ++i) {
    const Vec3<W> before = Row(motion, &Axis<W, N>::d, i);
    const Vec3<W> turned = TurnLeast(from, rest, before);
    d[i] = Select<W>(known, NormalizeOr(turned, before), before);
  }
}

// Of a group of chains on W, at lanes `at` (core/simd/records.hpp).
template <class W, uint32_t kPoints, class Ports>
struct FrameStart {
  static constexpr uint32_t N = NodesOf(kPoints), kParts = kPoints - 1;
  using Group = chain::Group<W, kParts>;
  using Motion = modal::Motion<W, N>;
  using Mask = typename W::Mask;

  static PELT_INLINE bool HasWind(const Ports& ports) {
    return (ports.layer->flags & kLayerWind) != 0;
  }

  // Wind that has stopped still goes down to nothing over this frame.
  static PELT_INLINE bool WindChanges(const Ports& ports) {
    return (ports.layer->flags & (kLayerWind | kLayerWindEnds)) != 0;
  }

  template <class At>
  static PELT_INLINE W LoadWind(const Ports& ports, uint32_t axis, const At& at) {
    return HasWind(ports) ? LoadLanes<W>(ports.wind->acceleration[axis], at) : W(0.0f);
  }

  // What a strand feels of its root's motion. `unit`: the units of `motion` in a metre.
  static PELT_INLINE Vec3<W> Felt(const LayerBlock& layer, Vec3<W> motion, W unit) {
    if (layer.motion_follow > 0.0f) motion = motion * W(1.0f - layer.motion_follow);
    if (layer.modal.fastest_felt > 0.0f) {
      const W most = unit * W(layer.modal.fastest_felt);
      const W most2 = most * most;
      const W far2 = Max(Dot(motion, motion), most2);
      motion = motion * Min(most * Rsqrt(far2), W(1.0f));
    }
    return motion;
  }

  // Rest directions and root of this frame.
  template <class At>
  static PELT_INLINE void LoadRest(const Ports& ports, const At& at, Group& g, Vec3<W> (&rest)[N],
                                   W& per_length) {
    const LayerBlock& layer = *ports.layer;
    chain::LoadGroom<W, kPoints>(*ports.rest, *ports.roots, 0.0f, layer.scale, at, g);
    g.free_motion = Felt(layer, g.free_motion, W(1.0f));
    per_length = W(1.0f) / g.length;
    RestTangents(*ports.table, g, per_length, rest);
  }

  static PELT_INLINE W Part(const Vec3<W>& v, uint32_t axis) {
    return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
  }

  // What holds a sag-free strand where it was groomed, a force on each tangent that turns with the root:
  // against the weight that it bears in the rest pose, but for what of that stretches it. So a
  // strand that was groomed to hang still swings as one that hangs, and none is groomed so that it
  // would fall: what is left of the weight there never pushes it together.
  template <class At>
  static __attribute__((noinline)) void LoadHold(const Ports& ports, const DownBlock& down,
                                                 const At& at, const Vec3<W> (&rest)[N],
                                                 W per_length, Vec3<W> (&hold)[N]) {
    const Vec3<W> normal = Load3<W>(ports.roots->normal, at);
    const Vec3<W> tangent = Load3<W>(ports.roots->tangent, at);
    const Vec3<W> bitangent = Cross(normal, tangent), local = Load3<W>(down.down, at);
    const W gravity = per_length * W(ports.layer->modal.rest_gravity);
    const Vec3<W> pull = chain::Turn(tangent, bitangent, normal, local) * gravity;
    for (uint32_t i = 0; i < N; ++i) {
      const W stretch = Max(Dot(pull, rest[i]), W(0.0f));
      hold[i] = (rest[i] * stretch - pull) * W(ports.table->pull[i]);
    }
  }

  // `hold`: null where nothing is held up; `own`: null where all lanes weigh what the layer does.
  template <class At>
  static PELT_INLINE void LoadAxis(const Ports& ports, const TraitBlock* own, const At& at,
                                   uint32_t k, const Group& g, const Vec3<W> (&rest)[N],
                                   const Vec3<W>* hold, W per_length, Axis<W, N>& a) {
    const ModalTableBlock& t = *ports.table;
    const ModalStateBlock<NodesOf(kPoints)>& old = *ports.chain;
    W r[N];
    for (uint32_t i = 0; i < N; ++i) r[i] = Part(rest[i], k);
    if (t.parent_curl != 0 || HasLimit(*ports.layer))
      for (uint32_t i = 0; i < N; ++i) a.rest[i] = r[i];
    a.root[0] = Part(g.free_motion, k) * per_length;
    a.root[1] = a.root[0] - LoadLanes<W>(old.root_step[k], at);
    a.root[2] = a.root[1] - LoadLanes<W>(old.root_turn[k], at);
    const W wind = LoadWind(ports, k, at);
    const W force = (traits::Weigh(own, at, W(ports.layer->gravity[k])) + wind) * per_length;
    W h[N];
    if (hold)
      for (uint32_t i = 0; i < N; ++i) h[i] = Part(hold[i], k);
    a.wind_step = (wind - LoadLanes<W>(old.wind[k], at)) * per_length;
    PELT_UNROLL
    for (uint32_t m = 0; m < N; ++m) {
      a.bend[0][m] = Weigh<W, N>(t.bend[m], r);
      if (hold) a.bend[0][m] = a.bend[0][m] + WeighColumn<W, N>(t.shape, m, h);
      a.bend[1][m] =
          a.bend[0][m] - LoadLanes<W>(old.bend[m][k], at) + a.root[0] * W(t.bend_root[m]);
      a.bend[2][m] = a.bend[1][m] - LoadLanes<W>(old.bend_step[m][k], at);
      a.bend[3][m] = a.bend[2][m] - LoadLanes<W>(old.bend_turn[m][k], at);
      a.force[m] = a.bend[0][m] + force * W(t.pull_mode[m]);
      a.z[m] = LoadLanes<W>(old.velocity[m][k], at);
      a.d[m] = LoadLanes<W>(old.direction[m][k], at);
    }
  }

  // With H the frame's length and D a row's first difference, e = H times its velocity at the
  // frame's end: what stands for its second and third difference (modal_table.hpp). The velocity
  // at the frame's start is the last frame's: e = D + D2 / 2 of what it left. (Without velocities
  // it left what this is near enough to, so that frames with and without may follow each other.)
  static PELT_INLINE void TakeRate(W first, W end, W last_first, W last_second, W ratio, W& second,
                                   W& third) {
    const W over = end - first;
    const W start = (last_first + last_second * W(0.5f)) * ratio;
    second = over + over;
    third = over + (start - first);
  }

  template <class At>
  static __attribute__((noinline)) void TakeRates(const Ports& ports, const RootRateBlock& rates,
                                                  const At& at, const Vec3<W> (&rest)[N],
                                                  const Vec3<W>* hold, W per_length,
                                                  Motion& motion) {
    const ModalTableBlock& t = *ports.table;
    const ModalStateBlock<NodesOf(kPoints)>& old = *ports.chain;
    const LayerBlock& layer = *ports.layer;
    const W frame = W(t.frame_s), ratio = W(layer.frame_ratio);
    const W scale = frame * per_length;
    Vec3<W> move = Load3<W>(rates.velocity, at) * scale;
    move = Felt(layer, move, per_length);
    Vec3<W> turn = Load3<W>(rates.spin, at) * frame;
    if (layer.modal.turn_follow > 0.0f) turn = turn * W(1.0f - layer.modal.turn_follow);
    const bool other = HasRootHistory(layer.modal);
    Vec3<W> rest_step[N], hold_step[N];
    for (uint32_t i = 0; i < N; ++i) rest_step[i] = Cross(turn, rest[i]);
    if (hold)
      for (uint32_t i = 0; i < N; ++i) hold_step[i] = Cross(turn, hold[i]);
    PELT_NO_UNROLL
    for (uint32_t k = 0; k < 3; ++k) {
      Axis<W, N>& a = motion.axis[k];
      const W root = Part(move, k);
      W r[N], h[N];
      for (uint32_t i = 0; i < N; ++i) r[i] = Part(rest_step[i], k);
      if (hold)
        for (uint32_t i = 0; i < N; ++i) h[i] = Part(hold_step[i], k);
      W root_step = LoadLanes<W>(old.root_step[k], at);
      W root_turn = LoadLanes<W>(old.root_turn[k], at);
      if (other) {
        root_step = a.root[0] - a.root[1];
        root_turn = a.root[1] - a.root[2];
      }
      TakeRate(a.root[0], root, root_step, root_turn, ratio, a.root[1], a.root[2]);
      PELT_UNROLL
      for (uint32_t m = 0; m < N; ++m) {
        W turned = Weigh<W, N>(t.bend[m], r);
        if (hold) turned = turned + WeighColumn<W, N>(t.shape, m, h);
        const W bend = turned + root * W(t.bend_root[m]);
        W step = LoadLanes<W>(old.bend_step[m][k], at);
        W curve = LoadLanes<W>(old.bend_turn[m][k], at);
        if (other) {
          step = a.bend[1][m] - a.bend[2][m];
          curve = a.bend[2][m] - a.bend[3][m];
        }
        TakeRate(a.bend[1][m], bend, step, curve, ratio, a.bend[2][m], a.bend[3][m]);
      }
    }
  }

  // Start of a lane, or of a chunk, with directions `from`, moving with the root, no history but
  // its step, which took `per_step` of a second, 1/s.
  static PELT_INLINE void StartAfresh(const ModalTableBlock& t, const Vec3<W> (&from)[N],
                                      float per_step, Mask fresh, Motion& motion) {
    const W none = W(0.0f);
    for (uint32_t k = 0; k < 3; ++k) {
      Axis<W, N>& a = motion.axis[k];
      a.root[1] = Select(fresh, none, a.root[1]);
      for (uint32_t m = 0; m < N; ++m) {
        a.bend[1][m] = Select(fresh, a.root[0] * W(t.bend_root[m]), a.bend[1][m]);
        a.bend[2][m] = Select(fresh, none, a.bend[2][m]);
        a.z[m] = Select(fresh, a.root[0] * W(per_step * t.pull_mode[m]), a.z[m]);
        a.d[m] = Select(fresh, Part(from[m], k), a.d[m]);
      }
    }
    for (uint32_t m = 0; m < N; ++m) motion.lambda[m] = Select(fresh, none, motion.lambda[m]);
  }

  // A frame too long to be stepped. Where nothing moved, nothing turns. `held`: what the strand was
  // last frame is known of rest and hold together, so that is what turns.
  static __attribute__((noinline)) void Carry(const ModalTableBlock& t, Vec3<W> rest, bool held,
                                              Mask calm, Motion& motion) {
    Vec3<W> d[N];
    const Vec3<W> to = held ? NormalizeOr(NowRest(t, motion), rest) : rest;
    CarryFrame(t, to, motion, d);
    for (uint32_t i = 0; i < N; ++i) d[i] = Select<W>(calm, Row(motion, &Axis<W, N>::d, i), d[i]);
    for (Axis<W, N>& a : motion.axis) a.root[0] = a.root[0] * W(t.euler_speed * kCarriedFrame_s);
    StartAfresh(t, d, 1.0f / kCarriedFrame_s, W(0.0f) < W(1.0f), motion);
  }

  // Lanes whose root, history and wind are those of the last frame.
  static PELT_INLINE Mask IsCalm(const Motion& motion) {
    const W none = W(0.0f);
    Mask calm =
        Abs(motion.axis[0].root[0]) + Abs(motion.axis[1].root[0]) + Abs(motion.axis[2].root[0]) <=
        none;
    if (!Any(calm)) return calm;
    for (const Axis<W, N>& a : motion.axis) {
      W moving = Abs(a.root[1]) + Abs(a.root[2]) + Abs(a.wind_step);
      for (uint32_t k = 1; k < 4; ++k)
        for (uint32_t m = 0; m < N; ++m) moving = moving + Abs(a.bend[k][m]);
      calm = calm & (moving <= none);
    }
    return calm;
  }
};

// Radians per frame below which a tangent is still: a few roundings of it. What a strand is
// pressed against multiplies them.
inline constexpr float kStillTurn = 1.0e-6f, kStillTouching = 1.0e-5f;

// The share of its way that a lane goes astray, and for how long, s, before it is kept as it is.
inline constexpr float kAstray = 0.3f, kRestless_s = 0.75f;

// Of a group of chains on W, at lanes `at` (core/simd/records.hpp).
template <class W, uint32_t kPoints, class Ports>
struct FrameEnd {
  static constexpr uint32_t N = NodesOf(kPoints), kParts = kPoints - 1;
  using Group = chain::Group<W, kParts>;
  using Motion = modal::Motion<W, N>;
  using Start = FrameStart<W, kPoints, Ports>;
  using Mask = typename W::Mask;

  // Calls put(row, value) for every row of the state but quiet_s, and of the points that are kept.
  template <class At, class Put>
  static PELT_INLINE void ForEachRow(const Ports& ports, const At& at, const Group& g,
                                     const Motion& motion, Put put) {
    ModalStateBlock<NodesOf(kPoints)>& to = *ports.chain;
    PELT_UNROLL
    for (uint32_t i = 0; i < N; ++i) put(to.multiplier[i], motion.lambda[i]);
    PELT_UNROLL
    for (uint32_t k = 0; k < 3; ++k) {
      const Axis<W, N>& a = motion.axis[k];
      PELT_UNROLL
      for (uint32_t i = 0; i < N; ++i) {
        put(to.direction[i][k], a.d[i]);
        put(to.velocity[i][k], a.z[i]);
        put(to.bend[i][k], a.bend[0][i]);
        put(to.bend_step[i][k], a.bend[1][i]);
        put(to.bend_turn[i][k], a.bend[2][i]);
      }
      if constexpr (kHasPoints<Ports>) {
        PELT_UNROLL
        for (uint32_t i = 0; i < kParts; ++i)
          put(ports.position->position[i][k], Start::Part(g.root, k) + Start::Part(g.point[i], k));
      }
      put(to.root_step[k], a.root[0]);
      put(to.root_turn[k], a.root[1]);
      put(to.wind[k], Start::LoadWind(ports, k, at));
      put(to.normal[k], Start::Part(g.normal, k));
    }
  }

  // Lanes whose points are where they were: a follower moves with its control strand.
  template <class At>
  static PELT_INLINE Mask HoldsPoints(const Ports& ports, const At& at, const Group& g) {
    W far2 = W(0.0f);
    for (uint32_t i = 0; i < kParts; ++i) {
      const Vec3<W> step = g.root + g.point[i] - Load3<W>(ports.position->position[i], at);
      far2 = Max(far2, Dot(step, step));
    }
    const W size = Max(Max(Abs(g.root.x), Abs(g.root.y)), Abs(g.root.z));
    const W limit = Max(g.length * W(kStillTurn), size * W(chain::kRoundingShare));
    return far2 < limit * limit;
  }

  // Lanes about which nothing changes, and that touch something, yet never come to rest: what they
  // touch leaves them nowhere to be, or friction lets them creep. They are known by that they go
  // where their speeds do not take them; what swings or slides does so in blows alone. Those of
  // `calm` lanes that did so for long are returned, to be kept as they are; of the others `clock`,
  // quiet_s of lanes that are not quiet, says for how long they have.
  template <class At>
  static __attribute__((noinline)) Mask FindRestless(const Ports& ports, const At& at, Mask calm,
                                                     const Motion& motion, W& clock) {
    const ModalTableBlock& t = *ports.table;
    const ModalStateBlock<NodesOf(kPoints)>& old = *ports.chain;
    const W none = W(0.0f), half_s = W(0.5f * t.frame_s);
    W turned2 = none, astray2 = none;
    for (uint32_t k = 0; k < 3; ++k) {
      const Axis<W, N>& a = motion.axis[k];
      W speed[N];
      for (uint32_t m = 0; m < N; ++m) speed[m] = LoadLanes<W>(old.velocity[m][k], at) + a.z[m];
      for (uint32_t i = 0; i < N; ++i) {
        const W turn = a.d[i] - LoadLanes<W>(old.direction[i][k], at);
        const W astray = turn - Weigh<W, N>(t.shape[i], speed) * half_s;
        turned2 = turned2 + turn * turn;
        astray2 = astray2 + astray * astray;
      }
    }
    const W before = LoadLanes<W>(old.quiet_s, at);
    calm = calm & (before >= none);  // those that something struck have a clock of their own
    const Mask restless = calm & (astray2 > turned2 * W(kAstray * kAstray));
    clock = Select(calm, before + Select(restless, W(t.frame_s), none), clock);
    return restless & (before >= W(kRestless_s));
  }

  // Writes the lanes back but those `picked`, which keep their bits; returns those of which some bit
  // changed, or the root or the wind did. `clock`: quiet_s of those that are not quiet.
  template <class At>
  static PELT_INLINE Mask Store(const SimulateParams& params, const Ports& ports, const At& at,
                                const Group& g, Mask fresh, Mask quiet, Mask picked, W still_turn,
                                W clock, bool follows, const Motion& motion) {
    ModalStateBlock<NodesOf(kPoints)>& to = *ports.chain;
    const bool may_rest = params.rest_threshold > 0.0f;
    const Mask moved = !(quiet | fresh | picked);
    // No lane may be at rest: whether bits changed need not be looked at.
    if (may_rest && AllSet(moved)) {
      StoreLanes(clock, to.quiet_s, at);
      ForEachRow(
          ports, at, g, motion, [&](float* row, W value) __attribute__((always_inline)) {
            StoreLanes(value, row, at);
          });
      return moved;
    }
    // Not of lanes that were picked from several groups: those that keep their bits are few, and the code is long.
    if (std::is_same_v<At, uint32_t> && may_rest && AllSet(moved | picked)) {
      const auto put = [&](float* row, W value) __attribute__((always_inline)) {
        const W old = LoadLanes<W>(row, at);
        StoreLanes(Select(picked, old, value), row, at);
      };
      put(to.quiet_s, clock);
      ForEachRow(ports, at, g, motion, put);
      return moved;
    }
    W turn2 = W(0.0f);
    for (uint32_t i = 0; i < N; ++i) {
      W sum = W(0.0f);
      for (uint32_t k = 0; k < 3; ++k) {
        const W turn = motion.axis[k].d[i] - LoadLanes<W>(to.direction[i][k], at);
        sum = sum + turn * turn;
      }
      turn2 = Max(turn2, sum);
    }
    const W limit = may_rest ? still_turn : W(0.0f);
    quiet = quiet & (turn2 < limit * limit);
    if constexpr (kHasPoints<Ports>)
      if (follows) quiet = quiet & HoldsPoints(ports, at, g);
    const W before = LoadLanes<W>(to.quiet_s, at);
    const Mask still = quiet & (before >= W(ports.table->quiet_s));
    const Mask kept = still | picked;
    const W now = Select(quiet, before + W(ports.table->frame_s), clock);
    typename W::Int change = 0;
    const auto put = [&](float* row, W value) __attribute__((always_inline)) {
      const W old = LoadLanes<W>(row, at);
      value = Select(kept, old, value);
      change = change | (Bits(value) ^ Bits(old));
      StoreLanes(value, row, at);
    };
    put(to.quiet_s, now);
    ForEachRow(ports, at, g, motion, put);
    return moved | !(change == typename W::Int(0));
  }
};

}  // namespace pelt::modal
