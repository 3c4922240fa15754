// What a modal frame leaves: state and points, but for lanes at rest, which keep their bits.
#pragma once

#include <type_traits>

#include "core/kernels/modal_start.hpp"

namespace pelt::modal {

// Radians a frame below which a tangent is still: a few roundings of it. What a strand is
// pressed against multiplies them.
inline constexpr float kStillTurn = 1.0e-6f, kStillTouching = 1.0e-5f;

// The share of its way that a lane goes astray, and for how long, s, before it is kept as it is.
inline constexpr float kAstray = 0.3f, kRestless_s = 0.75f;

// Of a group of chains on W, at lanes `at` (core/simd/lanes.hpp).
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
    // Nobody may be at rest: whether bits changed need not be looked at.
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
