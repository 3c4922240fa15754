// Simulate, modal: chains of stiff links moved by their own bending modes, accurate at any frame
// rate. The mathematics is in modal_step.hpp; this file is a chunk's frame around it: ports, what
// the root did, who starts afresh, who falls back, strength, contacts, rest, and the report to
// `activate`.
//
// The fallback (modal_fallback.hpp), the contacts and the special lanes are branches over whole
// groups that only skip work: a lane's bits never depend on its neighbours.
//
// Invariants, as chain.hpp's:
//  - From finite input comes finite output; links keep their length.
//  - A lane without strength, a new lane and every lane of a chunk that restarts lie exactly on the
//    groom and move with the root.
//  - A lane whose root and wind did not change and that was still for a quarter of its slowest
//    swing keeps all its bits, so a still scene reaches a state that a step leaves as it was.
//  - state_changed is 0 only if every live lane kept the bits of its points and of its state.
#pragma once

#include <string_view>

#include "core/kernels/chain_step.hpp"
#include "core/kernels/modal_contact.hpp"
#include "core/kernels/modal_fallback.hpp"
#include "core/kernels/modal_ports.hpp"

namespace pelt {

namespace modal {

// Radians a frame below which a link is still: a few roundings of its direction. What a link is
// pressed against multiplies them.
inline constexpr float kStillTurn = 1.0e-6f, kStillTouching = 1.0e-5f;

}  // namespace modal

template <class V, uint32_t kPoints, bool kVertexChains>
struct SimulateModal {
  static constexpr std::string_view kName = kVertexChains  ? "simulate_modal_vertex"
                                            : kPoints == 4 ? "simulate_modal_4"
                                                           : "simulate_modal_5";
  static constexpr uint32_t N = kPoints - 1;
  using Params = SimulateParams;
  using Ports = modal::Ports<kPoints, kVertexChains>;
  using Controls = chain::ControlRecords<V, N>;

  static void Run(const Params& params, const Ports& ports) {
    if (ports.table->use_slope != 0)
      RunAs<true>(params, ports);
    else
      RunAs<false>(params, ports);
  }

 private:
  template <bool kBest>
  PELT_INLINE static void RunAs(const Params& params, const Ports& ports) {
    chain::RunChunk<V, N, kVertexChains>(
        ports, [&]<class W>(uint32_t lane, uint32_t live, const Controls* controls) {
          return Lanes<W>::template RunGroup<kBest>(params, ports, lane, live, controls);
        });
  }

  // A group's frame on W: V or Unrolled<V>.
  template <class W>
  struct Lanes {
    using Group = chain::Group<W, N>;
    using Motion = modal::Motion<W, N>;
    using Touches = modal::Touches<W, N>;
    using Mask = typename W::Mask;

    static PELT_INLINE bool HasWind(const Ports& ports) {
      return (ports.layer->flags & kLayerWind) != 0;
    }

    // Wind that has stopped still goes down to nothing over this frame.
    static PELT_INLINE bool WindChanges(const Ports& ports) {
      return (ports.layer->flags & (kLayerWind | kLayerWindEnds)) != 0;
    }

    static PELT_INLINE W LoadWind(const Ports& ports, uint32_t axis, uint32_t lane) {
      return HasWind(ports) ? W::Load(ports.wind->acceleration[axis] + lane) : W(0.0f);
    }

    // Rest directions and root of this frame.
    static PELT_INLINE void LoadRest(const Ports& ports, uint32_t lane, Group& g,
                                     Vec3<W> (&rest)[N], W& per_length) {
      chain::LoadGroom<W, kPoints>(*ports.rest, *ports.roots, 0.0f, lane, g);
      per_length = W(1.0f) / g.length;
      rest[0] = g.rest[0] * per_length;
      for (uint32_t i = 1; i < N; ++i) rest[i] = (g.rest[i] - g.rest[i - 1]) * per_length;
    }

    static PELT_INLINE W Part(const Vec3<W>& v, uint32_t axis) {
      return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
    }

    static PELT_INLINE void LoadAxis(const Ports& ports, uint32_t lane, uint32_t k, const Group& g,
                                     const Vec3<W> (&rest)[N], W per_length, modal::Axis<W, N>& a) {
      const ModalTableBlock& t = *ports.table;
      const ModalStateBlock<kPoints>& old = *ports.chain;
      W r[N];
      for (uint32_t i = 0; i < N; ++i) r[i] = Part(rest[i], k);
      if (t.parent_curl != 0 || modal::HasLimit(*ports.layer))
        for (uint32_t i = 0; i < N; ++i) a.rest[i] = r[i];
      a.root[0] = Part(g.free_motion, k) * per_length;
      a.root[1] = a.root[0] - W::Load(old.root_step[k] + lane);
      a.root[2] = a.root[1] - W::Load(old.root_turn[k] + lane);
      const W wind = LoadWind(ports, k, lane);
      const W force = (W(ports.layer->gravity[k]) + wind) * per_length;
      a.wind_step = (wind - W::Load(old.wind[k] + lane)) * per_length;
      PELT_UNROLL
      for (uint32_t m = 0; m < N; ++m) {
        a.bend[0][m] = modal::Weigh<W, N>(t.bend[m], r);
        a.bend[1][m] = a.bend[0][m] - W::Load(old.bend[m][k] + lane) + a.root[0] * W(t.bend[m][0]);
        a.bend[2][m] = a.bend[1][m] - W::Load(old.bend_step[m][k] + lane);
        a.bend[3][m] = a.bend[2][m] - W::Load(old.bend_turn[m][k] + lane);
        a.force[m] = a.bend[0][m] + force * W(t.image[m][0]);
        a.z[m] = W::Load(old.velocity[m][k] + lane);
        a.d[m] = W::Load(old.direction[m][k] + lane);
      }
    }

    // Start of a lane, or of a chunk: on the groom, moving with the root, no history but its step.
    static PELT_INLINE void StartAfresh(const ModalTableBlock& t, const Vec3<W> (&rest)[N],
                                        Mask fresh, Motion& motion) {
      const W none = W(0.0f);
      for (uint32_t k = 0; k < 3; ++k) {
        modal::Axis<W, N>& a = motion.axis[k];
        a.root[1] = Select(fresh, none, a.root[1]);
        for (uint32_t m = 0; m < N; ++m) {
          a.bend[1][m] = Select(fresh, a.root[0] * W(t.bend[m][0]), a.bend[1][m]);
          a.bend[2][m] = Select(fresh, none, a.bend[2][m]);
          a.z[m] = Select(fresh, a.root[0] * W(t.euler_speed * t.image[m][0]), a.z[m]);
          a.d[m] = Select(fresh, Part(rest[m], k), a.d[m]);
        }
      }
      for (uint32_t m = 0; m < N; ++m) motion.lambda[m] = Select(fresh, none, motion.lambda[m]);
    }

    static PELT_INLINE void TakeLanes(Mask lanes, const Motion& from, Motion& to) {
      for (uint32_t i = 0; i < N; ++i) {
        for (uint32_t k = 0; k < 3; ++k) {
          to.axis[k].d[i] = Select(lanes, from.axis[k].d[i], to.axis[k].d[i]);
          to.axis[k].z[i] = Select(lanes, from.axis[k].z[i], to.axis[k].z[i]);
        }
        to.lambda[i] = Select(lanes, from.lambda[i], to.lambda[i]);
      }
    }

    // Lanes that failed: once more with a second Newton step, if they follow, then without one that
    // could fail. Kept out of line and of the way: such lanes are rare.
    static __attribute__((noinline)) void FallBack(const Ports& ports, uint32_t lane, Mask good,
                                                   Mask follows, const Vec3<W> (&rest)[N],
                                                   W per_length, Touches& touches, Motion& motion) {
      const ModalStateBlock<kPoints>& old = *ports.chain;
      Motion safe = motion;
      W force[3];
      for (uint32_t i = 0; i < N; ++i) safe.lambda[i] = W::Load(old.multiplier[i] + lane);
      for (uint32_t k = 0; k < 3; ++k) {
        force[k] = (W(ports.layer->gravity[k]) + LoadWind(ports, k, lane)) * per_length;
        for (uint32_t i = 0; i < N; ++i) {
          safe.axis[k].d[i] = W::Load(old.direction[i][k] + lane);
          safe.axis[k].z[i] = W::Load(old.velocity[i][k] + lane);
        }
      }
      if (Any(follows & !good)) {
        Motion again = safe;
        const Mask better =
            modal::StepFrame<true>(*ports.table, WindChanges(ports), touches, again) & follows;
        TakeLanes(better & !good, again, motion);
        good = good | better;
        if (AllSet(good)) return;
      }
      modal::EulerFrame<W, N>(*ports.table, rest, {force[0], force[1], force[2]}, safe);
      TakeLanes(!good, safe, motion);
    }

    template <bool kBest>
    static PELT_INLINE bool RunGroup(const Params& params, const Ports& ports, uint32_t lane,
                                     uint32_t live, const Controls* controls) {
      const LayerBlock& layer = *ports.layer;
      const ModalTableBlock& t = *ports.table;
      const ChunkStateBlock& state = *ports.state;
      const auto lanes = W::Int::Iota(int32_t(lane));
      const Mask alive = lanes < typename W::Int(int32_t(live));
      const uint32_t first_new = kVertexChains ? state.first_new_vertex : state.first_new_strand;
      const bool restart = (state.flags & kChunkRestart) || !(layer.flags & kLayerSimulate);
      const W strength = W::Load(ports.rest->strength + lane);
      const Mask fresh =
          (!(lanes < typename W::Int(restart ? 0 : int32_t(first_new)))) | (strength <= W(0.0f));

      Group g;
      Motion motion;
      Vec3<W> rest[N], d[N];
      W per_length;
      LoadRest(ports, lane, g, rest, per_length);
      PELT_NO_UNROLL
      for (uint32_t k = 0; k < 3; ++k)
        LoadAxis(ports, lane, k, g, rest, per_length, motion.axis[k]);
      for (uint32_t i = 0; i < N; ++i)
        motion.lambda[i] = W::Load(ports.chain->multiplier[i] + lane);
      // In a statement of its own: it branches, and what a console's price is must not depend on
      // which operand a compiler takes first.
      const Mask calm = IsCalm(motion);
      const Mask quiet = calm & !fresh;

      Mask touched = W(1.0f) < W(0.0f);
      if (!restart) {
        Touches touches;
        if (HasObstacles(params, ports)) LoadTouches(params, ports, lane, g, touches);
        const Mask follows = modal::FollowsWeight<kBest, W, N>(t, layer.gravity, per_length);
        Mask good = fresh;
        if (Any(follows))
          good = good | (modal::StepFrame<kBest>(t, WindChanges(ports), touches, motion) & follows);
        touched = touches.Touched() & good;
        if (!AllSet(good)) FallBack(ports, lane, good, follows, rest, per_length, touches, motion);
      }
      modal::Directions(motion, d);
      modal::PlacePoints(d, g);
      if (!restart) {
        if (HasObstacles(params, ports)) PushOut(params, ports, g, motion);
        const Mask full = strength >= W(1.0f);
        if (controls || !AllSet(full))
          Shape(params, ports, lane, controls, full, strength, rest, motion, g);
      }
      if (Any(fresh)) {
        StartAfresh(t, rest, fresh, motion);
        for (uint32_t i = 0; i < N; ++i) g.point[i] = Select<W>(fresh, g.rest[i], g.point[i]);
      }
      const W still = Select(touched, W(modal::kStillTouching), W(modal::kStillTurn));
      return Any(Store(params, ports, lane, g, fresh, quiet, still, controls != nullptr, motion) &
                 alive);
    }

    static PELT_INLINE bool HasObstacles(const Params& params, const Ports& ports) {
      return chain::HasSurface(*ports.layer) || modal::HasLimit(*ports.layer) ||
             Colliders<W>::HasAny(params);
    }

    static PELT_INLINE void LoadTouches(const Params& params, const Ports& ports, uint32_t lane,
                                        const Group& g, Touches& touches) {
      const Vec3<W> last =
          chain::HasSurface(*ports.layer) ? Load3<W>(ports.chain->normal, lane) : g.normal;
      touches.Load(*ports.table, *ports.layer, params, last, g);
    }

    static __attribute__((noinline)) void PushOut(const Params& params, const Ports& ports,
                                                  Group& g, Motion& motion) {
      modal::PushOut(*ports.table, *ports.layer, params, g, motion);
    }

    // What is seen of the chain: the points, not the state. Lanes at full strength that follow
    // nobody keep theirs.
    static __attribute__((noinline)) void Shape(const Params& params, const Ports& ports,
                                                uint32_t lane, const Controls* controls, Mask full,
                                                W strength, const Vec3<W> (&rest)[N],
                                                const Motion& motion, Group& g) {
      const LayerBlock& layer = *ports.layer;
      Vec3<W> d[N];
      modal::Directions(motion, d);
      modal::Weaken(full, strength, rest, d);
      modal::PlacePoints(d, g);
      Mask shaped = !full;
      if constexpr (!kVertexChains)
        if (controls) {
          shaped = shaped | full;
          Vec3<W> control[N];
          for (uint32_t i = 0; i < N; ++i)
            control[i] = controls->template Gather<W>(ports.strands->control + lane, i) - g.root;
          modal::Gather(layer.clump, control, g, d);
        }
      if (HasObstacles(params, ports)) modal::KeepOut(layer, params, shaped, g, d);
    }

    // Lanes whose root, history and wind are those of the last frame.
    static PELT_INLINE Mask IsCalm(const Motion& motion) {
      const W none = W(0.0f);
      Mask calm =
          Abs(motion.axis[0].root[0]) + Abs(motion.axis[1].root[0]) + Abs(motion.axis[2].root[0]) <=
          none;
      if (!Any(calm)) return calm;
      for (const modal::Axis<W, N>& a : motion.axis) {
        W moving = Abs(a.root[1]) + Abs(a.root[2]) + Abs(a.wind_step);
        for (uint32_t k = 1; k < 4; ++k)
          for (uint32_t m = 0; m < N; ++m) moving = moving + Abs(a.bend[k][m]);
        calm = calm & (moving <= none);
      }
      return calm;
    }

    // Calls put(row, value) for every row of the state but quiet_s, and of the points.
    template <class Put>
    static PELT_INLINE void ForEachRow(const Ports& ports, uint32_t lane, const Group& g,
                                       const Motion& motion, Put put) {
      ModalStateBlock<kPoints>& to = *ports.chain;
      PELT_UNROLL
      for (uint32_t i = 0; i < N; ++i) put(to.multiplier[i] + lane, motion.lambda[i]);
      PELT_UNROLL
      for (uint32_t k = 0; k < 3; ++k) {
        const modal::Axis<W, N>& a = motion.axis[k];
        PELT_UNROLL
        for (uint32_t i = 0; i < N; ++i) {
          put(to.direction[i][k] + lane, a.d[i]);
          put(to.velocity[i][k] + lane, a.z[i]);
          put(to.bend[i][k] + lane, a.bend[0][i]);
          put(to.bend_step[i][k] + lane, a.bend[1][i]);
          put(to.bend_turn[i][k] + lane, a.bend[2][i]);
          put(ports.position->position[i][k] + lane, Part(g.root, k) + Part(g.point[i], k));
        }
        put(to.root_step[k] + lane, a.root[0]);
        put(to.root_turn[k] + lane, a.root[1]);
        put(to.wind[k] + lane, LoadWind(ports, k, lane));
        put(to.normal[k] + lane, Part(g.normal, k));
      }
    }

    // Lanes whose points are where they were: a follower moves with its control strand.
    static PELT_INLINE Mask HoldsPoints(const Ports& ports, uint32_t lane, const Group& g) {
      W far2 = W(0.0f);
      for (uint32_t i = 0; i < N; ++i) {
        const Vec3<W> step = g.root + g.point[i] - Load3<W>(ports.position->position[i], lane);
        far2 = Max(far2, Dot(step, step));
      }
      const W size = Max(Max(Abs(g.root.x), Abs(g.root.y)), Abs(g.root.z));
      const W limit = Max(g.length * W(modal::kStillTurn), size * W(chain::kRoundingShare));
      return far2 < limit * limit;
    }

    // Writes the lanes back; returns those of which some bit changed, or the root or the wind did.
    static PELT_INLINE Mask Store(const Params& params, const Ports& ports, uint32_t lane,
                                  const Group& g, Mask fresh, Mask quiet, W still_turn,
                                  bool follows, const Motion& motion) {
      ModalStateBlock<kPoints>& to = *ports.chain;
      const bool may_rest = params.rest_threshold > 0.0f;
      const Mask moved = !(quiet | fresh);
      if (may_rest && AllSet(moved)) {
        W(0.0f).Store(to.quiet_s + lane);
        ForEachRow(
            ports, lane, g, motion,
            [](float* row, W value) __attribute__((always_inline)) { value.Store(row); });
        return moved;
      }
      W turn2 = W(0.0f);
      for (uint32_t i = 0; i < N; ++i) {
        W sum = W(0.0f);
        for (uint32_t k = 0; k < 3; ++k) {
          const W turn = motion.axis[k].d[i] - W::Load(to.direction[i][k] + lane);
          sum = sum + turn * turn;
        }
        turn2 = Max(turn2, sum);
      }
      const W limit = may_rest ? still_turn : W(0.0f);
      quiet = quiet & (turn2 < limit * limit);
      if (follows) quiet = quiet & HoldsPoints(ports, lane, g);
      const W before = W::Load(to.quiet_s + lane);
      const Mask still = quiet & (before >= W(ports.table->quiet_s));
      const W now = Select(quiet, before + W(ports.table->frame_s), W(0.0f));
      typename W::Int change = 0;
      const auto put = [&](float* row, W value) __attribute__((always_inline)) {
        const W old = W::Load(row);
        value = Select(still, old, value);
        change = change | (Bits(value) ^ Bits(old));
        value.Store(row);
      };
      put(to.quiet_s + lane, now);
      ForEachRow(ports, lane, g, motion, put);
      return moved | !(change == typename W::Int(0));
    }
  };
};

}  // namespace pelt
