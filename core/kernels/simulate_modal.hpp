// Simulate, modal: strands with nodes moved by their own bending modes, accurate at any frame
// rate. The mathematics is in modal_step.hpp; this file is a chunk's frame around it: ports, what
// the root did (by its last poses, or its velocities), who starts afresh, who falls back, strength,
// contacts, rest, and the report to `activate`.
//
// A frame that is too long to be stepped only carries them (modal_frame.hpp).
//
// Few lanes of many groups touch something, and a step with contact takes several times as long as
// one without. So every lane first steps as if it were free; those that end a substep inside
// something, and those that the free step fails (modal_step.hpp), keep their state, are picked
// from all groups and take the frame once more, with contact, as full groups: those that touch something, more of
// them at once than those that may rub on it too, or that something fast strikes (in short steps, modal_strike.hpp),
// as their step takes twice as much of a stack. A lane's bits depend neither on its neighbours nor on where in a
// group it stood.
//
// Invariants, as chain.hpp's:
//  - From finite input comes finite output; no part of a strand gets longer.
//  - A lane without strength, a new lane and every lane of a chunk that restarts lie exactly on the
//    groom and move with the root.
//  - A lane whose root and wind did not change and that was still for a quarter of its slowest
//    swing keeps all its bits, so a still scene reaches a state that a step leaves as it was.
//  - state_changed is 0 only if every live lane kept the bits of its points and of its state.
#pragma once

#include <string_view>
#include <type_traits>

#include "core/kernels/chain_step.hpp"
#include "core/kernels/lane_list.hpp"
#include "core/kernels/modal_contact.hpp"
#include "core/kernels/modal_frame.hpp"
#include "core/kernels/modal_step.hpp"
#include "core/kernels/modal_strike.hpp"

namespace pelt {

template <class V, uint32_t kPoints, bool kVertexChains>
struct SimulateModal {
  static constexpr std::string_view kName =
      kVertexChains ? "simulate_modal_vertex"
                    : ByPoints<kPoints>("simulate_modal_4", "simulate_modal_5", "simulate_modal_9");
  static constexpr uint32_t N = NodesOf(kPoints), kParts = kPoints - 1, Q = PlacesOf(kPoints);
  using Params = SimulateParams;
  using Ports = modal::Ports<kPoints, kVertexChains>;
  using Extras = modal::Extras;
  using Group = chain::Group<V, kParts>;
  using Motion = modal::Motion<V, N>;
  using Lot = modal::Lot;
  template <Lot kLot>
  using Touches = modal::Touches<V, N, Q, kLot == Lot::kRare>;
  using TouchNotes = modal::TouchNotes<V, N, Q>;
  using Strikes = modal::Strikes<V, N, Q>;
  using Start = modal::FrameStart<V, kPoints, Ports>;
  using End = modal::FrameEnd<V, kPoints, Ports>;
  using Mask = typename V::Mask;

  static constexpr auto kTraits = Ports::Of::kTraits;
  static void Run(const Params& params, const Ports& ports, const TraitBlock* traits = nullptr) {
    RunWith(params, ports, {nullptr, nullptr, traits});
  }

  // Out of line: the kernels below share it.
  static __attribute__((noinline)) void RunWith(const Params& params, const Ports& ports,
                                                const Extras& extras) {
    if constexpr (!std::is_same_v<V, Free>)
      SimulateModal<Free, kPoints, kVertexChains>::RunWith(params, ports, extras);
    else
      RunAs(params, ports, extras);
  }

 private:
  using Free = typename modal::LanesOf<V>::Free;
  using Plain = typename modal::LanesOf<V>::Plain;
  using Rare = typename modal::LanesOf<V>::Rare;
  // More code is of no use where it steps no more lanes.
  static constexpr bool kHasPlain = !std::is_same_v<Plain, Rare>;
  template <class, uint32_t, bool>
  friend struct SimulateModal;

  PELT_INLINE static void RunAs(const Params& params, const Ports& ports, const Extras& extras) {
    Picks picks;
    chain::RunChunk<kVertexChains>(
        ports, [&](uint32_t begin, uint32_t end, uint32_t live, bool follows) {
          return RunRange(params, ports, extras, begin, end, live, follows, picks);
        });
  }

  // A group has lanes of one kind, as it steps by what any of them may do (modal_touch.hpp). Struck lanes are a
  // kind only where most that touch something have a code of their own.
  enum Kind : uint32_t { kTouches, kRubs, kStruck, kKinds };

  // Lanes of a range that take the frame once more, and a group of them. One for the whole kernel.
  struct Picks {
    PickedLanes<Plain> plain;
    PickedLanes<Rare> rare;
    LaneList<V> of[kKinds];
  };

  // One group after the other: two at once, as the other solvers have them (chain_step.hpp), fit
  // only the registers of machines with many. Groups without a live lane are left out: chunks of mesh vertices are so
  // short that they are a tenth of all groups of eight in `monster`. Each lot is out of line, so that their frames are
  // not on the stack together.
  PELT_INLINE static bool RunRange(const Params& params, const Ports& ports, const Extras& extras,
                                   uint32_t begin, uint32_t end, uint32_t live, bool follows,
                                   Picks& picks) {
    for (LaneList<V>& list : picks.of) list.count = 0;
    const uint32_t last = end < live ? end : live;
    bool changed = RunFree(params, ports, extras, begin, last, live, follows, picks);
    uint32_t left = kTouches;
    if constexpr (kHasPlain)
      if (picks.of[left++].count > 0)
        changed |= SimulateModal<Plain, kPoints, kVertexChains>::template RunPicked<Lot::kPlain>(
            params, ports, extras, live, follows, picks, picks.plain, kTouches, left);
    uint32_t rest = 0;
    for (uint32_t kind = left; kind < kKinds; ++kind) rest += picks.of[kind].count;
    if (rest > 0)
      changed |= SimulateModal<Rare, kPoints, kVertexChains>::template RunPicked<Lot::kRare>(
          params, ports, extras, live, follows, picks, picks.rare, left, kKinds);
    return changed;
  }

  static __attribute__((noinline)) bool RunFree(const Params& params, const Ports& ports,
                                                const Extras& extras, uint32_t begin, uint32_t end,
                                                uint32_t live, bool follows, Picks& picks) {
    bool changed = false;
    for (uint32_t first = begin; first < end; first += uint32_t(V::kLanes))
      changed |= RunGroup<Lot::kFree>(params, ports, extras, first, live, follows, &picks);
    return changed;
  }

  // The kinds from `begin` to `end` of what a kernel on other lanes has picked, of which `group` holds one.
  template <Lot kLot, class OtherPicks>
  static __attribute__((noinline)) bool RunPicked(const Params& params, const Ports& ports,
                                                  const Extras& extras, uint32_t live, bool follows,
                                                  OtherPicks& picks, PickedLanes<V>& group,
                                                  uint32_t begin, uint32_t end) {
    bool changed = false;
    for (uint32_t kind = begin; kind < end; ++kind)
      for (uint32_t i = 0; i < picks.of[kind].count; i += uint32_t(V::kLanes))
        changed |= RunGroup<kLot>(params, ports, extras, picks.of[kind].Group(i, group), live,
                                  follows, static_cast<Picks*>(nullptr));
    return changed;
  }

  // Lanes that failed: once more with a second Newton step, if they follow, then without one that
  // could fail. Kept out of line and of the way: such lanes are rare. Each by itself, as stacks are
  // small (jobs/README.md).
  template <class At, class Touches>
  static PELT_INLINE void FallBack(const Ports& ports, const Extras& extras, const At& at,
                                   Mask good, Mask follows, const Vec3<V> (&rest)[N],
                                   const Vec3<V>* hold, V per_length, Touches& touches,
                                   Motion& motion) {
    if (Any(follows & !good)) {
      good = good | StepAgain(ports, at, follows & !good, rest, touches, motion);
      if (AllSet(good)) return;
    }
    StepSafely(ports, extras, at, !good, rest, hold, per_length, motion);
    if (touches.use) touches.FreeAtOnce(*ports.table, !good, motion);
  }

  // Returns which of the lanes it could.
  template <class At, class Touches>
  static __attribute__((noinline)) Mask StepAgain(const Ports& ports, const At& at, Mask lanes,
                                                  const Vec3<V> (&rest)[N], Touches& touches,
                                                  Motion& motion) {
    Motion again = motion;
    TakeState(ports, at, rest, again);
    const Mask better =
        modal::StepFrame<true>(*ports.table, Start::WindChanges(ports), touches, again) & lanes;
    TakeLanes(better, again, motion);
    return better;
  }

  template <class At>
  static __attribute__((noinline)) void StepSafely(const Ports& ports, const Extras& extras,
                                                   const At& at, Mask lanes,
                                                   const Vec3<V> (&rest)[N], const Vec3<V>* hold,
                                                   V per_length, Motion& motion) {
    Motion safe = motion;
    TakeState(ports, at, rest, safe);
    V force[3];
    for (uint32_t k = 0; k < 3; ++k)
      force[k] = (traits::Weigh(extras.traits, at, V(ports.layer->gravity[k])) +
                  Start::LoadWind(ports, k, at)) *
                 per_length;
    modal::EulerFrame<V, N>(*ports.table, rest, hold, {force[0], force[1], force[2]}, safe);
    TakeLanes(lanes, safe, motion);
  }

  // What a step changes, as it was when the frame began.
  template <class At>
  static PELT_INLINE void TakeState(const Ports& ports, const At& at, const Vec3<V> (&rest)[N],
                                    Motion& motion) {
    const ModalStateBlock<NodesOf(kPoints)>& old = *ports.chain;
    for (uint32_t i = 0; i < N; ++i) {
      motion.lambda[i] = LoadLanes<V>(old.multiplier[i], at);
      for (uint32_t k = 0; k < 3; ++k) {
        motion.axis[k].d[i] = LoadLanes<V>(old.direction[i][k], at);
        motion.axis[k].z[i] = LoadLanes<V>(old.velocity[i][k], at);
      }
    }
    if (modal::HasRootHistory(ports.layer->modal))
      modal::RootHistory<V, kPoints, Ports, At>::TakeStart(ports, at, rest[0], motion);
  }

  // A frame of lanes that may touch things. Returns whom something pushed at its end. `left`: how
  // deep points stay inside what they leave slowly, m.
  template <Lot kLot, class At>
  static PELT_INLINE Mask StepTouching(const Params& params, const Ports& ports,
                                       const Extras& extras, const At& at, Mask fresh,
                                       const Vec3<V> (&rest)[N], const Vec3<V>* hold, V per_length,
                                       const Group& g, V (&left)[kParts], Motion& motion) {
    const ModalTableBlock& t = *ports.table;
    Touches<kLot> touches;
    if (HasObstacles(params, ports)) LoadTouches(params, ports, extras, at, rest, g, touches);
    const Mask follows = Follows(ports, extras, at, per_length);
    Mask good = fresh;
    if (Any(follows))
      good = good | (modal::StepFrame(t, Start::WindChanges(ports), touches, motion) & follows);
    const Mask touched = touches.Touched() & good;
    V deep[Q];
    touches.Left(deep);
    // A lane that does not follow took no step: what it has there is made of its neighbours'.
    for (uint32_t i = 0; i < kParts; ++i)
      left[i] = Select(follows, deep[(i + 1) * (Q / kParts) - 1] * g.length, V(0.0f));
    if (!AllSet(good))
      FallBack(ports, extras, at, good, follows, rest, hold, per_length, touches, motion);
    return touched;
  }

  // A frame of lanes as if nothing were in their way. Returns those for which that is not so, or
  // that it fails. `rubs`: those that may touch a collider; set where the layer has friction. `struck`: those that
  // something fast may reach.
  static PELT_INLINE Mask StepFree(const Params& params, const Ports& ports, const Extras& extras,
                                   uint32_t first, const Vec3<V> (&rest)[N], V per_length,
                                   const Group& g, Mask& rubs, Mask& struck, Motion& motion) {
    const ModalTableBlock& t = *ports.table;
    // Of lanes that do not follow too, whoever is beside them.
    if (Colliders<V>::HasMoving(params))
      struck = modal::IsInFastWay(params, g, per_length, t.frame_s, motion);
    TouchNotes notes;
    if (HasObstacles(params, ports)) {
      LoadTouches(params, ports, extras, first, rest, g, notes);
      if (ports.layer->modal.friction > 0.0f) rubs = notes.around.colliders.any;
    }
    const Mask follows = Follows(ports, extras, first, per_length);
    if (!Any(follows)) return !follows;
    const Mask good = modal::StepFrame(t, Start::WindChanges(ports), notes, motion) & follows;
    return notes.inside | !good | struck;
  }

  // The frame of lanes that something fast strikes, or has struck: returns those, for which `motion`
  // and `clock`, their quiet_s, are set.
  template <class At>
  static __attribute__((noinline)) Mask StepStruck(const Params& params, const Ports& ports,
                                                   const Extras& extras, const At& at, Mask fresh,
                                                   const Vec3<V> (&rest)[N], V per_length,
                                                   const Group& g, const Motion& start, V& clock,
                                                   Motion& motion) {
    const ModalTableBlock& t = *ports.table;
    const V none = V(0.0f), before = LoadLanes<V>(ports.chain->quiet_s, at);
    Strikes strikes;
    if (HasObstacles(params, ports)) LoadTouches(params, ports, extras, at, rest, g, strikes);
    const Mask was = (before < none) & !fresh;
    const Mask may = modal::IsInFastWay(params, g, per_length, t.frame_s, start) & !fresh;
    if (!Any(may | was)) return may;
    motion = start;
    V fastest;
    const Mask now = strikes.Step(t, Start::WindChanges(ports), motion, fastest) & may;
    const Mask taken = now | was;
    clock = Select(taken, modal::ClockOfStruck(t, before, now, fastest), none);
    return taken;
  }

  // With `picks`, lanes as if they were free: those that are not are picked and keep their state.
  // Without, lanes that were picked. Says whether a bit of a live one changed.
  template <Lot kLot, class At>
  static PELT_INLINE bool RunGroup(const Params& params, const Ports& ports, const Extras& extras,
                                   const At& at, uint32_t live, bool follows, Picks* picks) {
    constexpr bool kPicks = kLot == Lot::kFree;
    const LayerBlock& layer = *ports.layer;
    const ChunkStateBlock& state = *ports.state;
    const auto lanes = NumberLanes<V>(at);
    const Mask alive = lanes < typename V::Int(int32_t(live));
    const uint32_t first_new = kVertexChains ? state.first_new_chain : state.first_new_strand;
    const bool restart = (state.flags & kChunkRestart) || !(layer.flags & kLayerSimulate);
    const V strength = LoadLanes<V>(ports.rest->strength, at);
    const Mask fresh =
        (!(lanes < typename V::Int(restart ? 0 : int32_t(first_new)))) | (strength <= V(0.0f));

    Group g;
    Motion motion;
    Vec3<V> rest[N], d[N], held[N];
    V per_length;
    const auto ahead = modal::PrefetchPorts<V::kLanes>(ports, at, live);
    ahead(Piece<0>());
    Start::LoadRest(ports, at, g, rest, per_length);
    ahead(Piece<1>());
    const Vec3<V>* hold = nullptr;
    if (extras.down) {
      Start::LoadHold(ports, *extras.down, at, rest, per_length, held);
      hold = held;
    }
    Start::LoadAxis(ports, extras.traits, at, 0, g, rest, hold, per_length, motion.axis[0]);
    ahead(Piece<2>());
    Start::LoadAxis(ports, extras.traits, at, 1, g, rest, hold, per_length, motion.axis[1]);
    ahead(Piece<3>());
    Start::LoadAxis(ports, extras.traits, at, 2, g, rest, hold, per_length, motion.axis[2]);
    ahead(Piece<4>());
    if (modal::HasRootHistory(layer.modal))
      modal::RootHistory<V, kPoints, Ports, At>::Take(ports, at, rest[0], motion);
    if (extras.rates && ports.table->substeps > 0)
      Start::TakeRates(ports, *extras.rates, at, rest, hold, per_length, motion);
    for (uint32_t i = 0; i < N; ++i)
      motion.lambda[i] = LoadLanes<V>(ports.chain->multiplier[i], at);
    // In a statement of its own: it branches, and what a console's price is must not depend on
    // which operand a compiler takes first.
    const Mask calm = Start::IsCalm(motion);
    const Mask quiet = calm & !fresh;

    const Mask none = V(1.0f) < V(0.0f);
    Mask touched = none, picked = none, rubs = none, struck = none, kept = none;
    V left[kParts], clock = V(0.0f);
    for (V& depth : left) depth = V(0.0f);
    const bool carried = !restart && ports.table->substeps == 0;
    if (carried) {
      Start::Carry(*ports.table, rest[0], hold != nullptr, calm, motion);
    } else if (!restart) {
      ahead(Piece<5>());
      if constexpr (kPicks) {
        picked = StepFree(params, ports, extras, at, rest, per_length, g, rubs, struck, motion);
        const Mask was = LoadLanes<V>(ports.chain->quiet_s, at) < V(0.0f);
        picked = picked | was, struck = struck | was;
      } else if constexpr (kLot == Lot::kPlain) {
        touched = StepTouching<kLot>(params, ports, extras, at, fresh, rest, hold, per_length, g,
                                     left, motion);
      } else {
        Motion after;
        const Mask was = LoadLanes<V>(ports.chain->quiet_s, at) < V(0.0f);
        if (Any(was) || Colliders<V>::HasMoving(params))
          struck = StepStruck(params, ports, extras, at, fresh, rest, per_length, g, motion, clock,
                              after);
        if (!AllSet(struck))
          touched = StepTouching<kLot>(params, ports, extras, at, fresh, rest, hold, per_length, g,
                                       left, motion);
        if (Any(struck)) {
          TakeLanes(struck, after, motion);
          touched = touched & !struck;
          for (V& depth : left) depth = Select(struck, V(0.0f), depth);
        }
      }
    }
    ahead(Piece<6>());
    modal::Directions(motion, d);
    modal::DrawCurve(*ports.table, d, rest, g);
    ahead(Piece<7>());
    if (!restart) {
      if constexpr (kPicks) {
        if (HasObstacles(params, ports))
          picked = picked | modal::IsInside(modal::EndWalls(layer, params, g), g);
        picked = picked & alive & !fresh;
        Mask plain = picked;
        if constexpr (kHasPlain)
          if (Any(picked & struck)) {
            picks->of[kStruck].Add(picked & struck & !rubs, at);
            plain = plain & (rubs | !struck);
          }
        if (Any(plain) && layer.modal.friction > 0.0f) {
          picks->of[kRubs].Add(plain & rubs, at);
          picks->of[kTouches].Add(plain & !rubs, at);
        } else if (Any(plain)) {
          picks->of[kTouches].Add(plain, at);
        }
        if (AllSet(picked | !alive)) return false;
      } else if (HasObstacles(params, ports)) {
        if constexpr (modal::kHasPoints<Ports>) PushOut(params, ports, left, g);
        if (state.flags & kChunkSteady) kept = End::FindRestless(ports, at, quiet, motion, clock);
      }
      if constexpr (modal::kHasPoints<Ports>) {
        const Mask full = strength >= V(1.0f);
        if (follows || !AllSet(full))
          Shape(params, ports, extras, at, follows, full, picked, strength, left, g);
      }
    }
    if (Any(fresh)) {
      const float per_step = carried ? 1.0f / kCarriedFrame_s : ports.table->euler_speed;
      Start::StartAfresh(*ports.table, rest, per_step, fresh, motion);
      if constexpr (modal::kHasPoints<Ports>)
        for (uint32_t i = 0; i < kParts; ++i) g.point[i] = Select<V>(fresh, g.rest[i], g.point[i]);
    }
    const V still = Select(touched, V(modal::kStillTouching), V(modal::kStillTurn));
    // Lanes that do not live keep their bits too: how many of them a group has is the machine's.
    return Any(End::Store(params, ports, at, g, fresh, quiet, picked | kept | !alive, still, clock,
                          follows, motion) &
               alive);
  }

  static PELT_INLINE bool HasObstacles(const Params& params, const Ports& ports) {
    return chain::HasSurface(*ports.layer) || modal::HasLimit(*ports.layer) ||
           Colliders<V>::HasAny(params);
  }

  // Lanes whose swings the substeps follow: what weighs more is as if it were longer.
  template <class At>
  static PELT_INLINE Mask Follows(const Ports& ports, const Extras& extras, const At& at,
                                  V per_length) {
    return modal::FollowsWeight<V, N>(*ports.table, ports.layer->gravity,
                                      traits::Weigh(extras.traits, at, per_length));
  }

  template <class At, class AnyTouches>
  static PELT_INLINE void LoadTouches(const Params& params, const Ports& ports,
                                      const Extras& extras, const At& at, const Vec3<V> (&rest)[N],
                                      const Group& g, AnyTouches& touches) {
    const Vec3<V> last =
        chain::HasSurface(*ports.layer) ? Load3<V>(ports.chain->normal, at) : g.normal;
    touches.Load(*ports.table, *ports.layer, params, last, rest, g);
    if (extras.traits) touches.Vary(*extras.traits, at);
  }

  static __attribute__((noinline)) void PushOut(const Params& params, const Ports& ports,
                                                const V (&left)[kParts], Group& g) {
    modal::PushOut(*ports.layer, params, left, g);
  }

  // What is seen of the chain: the points, not the state. Lanes at full strength that follow
  // no control strand keep theirs; what those get that were picked is of no use.
  template <class At>
  static __attribute__((noinline)) void Shape(const Params& params, const Ports& ports,
                                              const Extras& extras, const At& at, bool follows,
                                              Mask full, Mask picked, V strength,
                                              const V (&left)[kParts], Group& g) {
    const LayerBlock& layer = *ports.layer;
    modal::Weaken(full, strength, g);
    Mask shaped = !full;
    if constexpr (!kVertexChains)
      if (follows) {
        shaped = shaped | full;
        const StrandBlock& strands = *ports.strands;
        const auto controls = chain::ControlsOf<V>(strands.control, strands.control_count, at);
        Vec3<V> control[kParts];
        for (uint32_t i = 0; i < kParts; ++i)
          control[i] = Load3<V>(ports.position->position[i], controls) - g.root;
        if (extras.traits)
          modal::Gather(traits::ShareOf<V>(layer.clump, extras.traits->clump, at), control, g);
        else
          modal::Gather(layer.clump, control, g);
      }
    if (HasObstacles(params, ports)) modal::KeepOut(layer, params, shaped & !picked, left, g);
  }
};

// What those below are: SimulateModal with more ports, of what some layers have besides.
template <class V, uint32_t kPoints, bool kVertexChains, class MorePorts>
struct SimulateModalWith {
  using Params = SimulateParams;
  using Ports = MorePorts;
  static constexpr auto kTraits = ChainStreams<kPoints, kVertexChains>::kTraits;

  static void Run(const Params& params, const Ports& ports, const TraitBlock* traits = nullptr) {
    modal::Extras extras{nullptr, nullptr, traits};
    if constexpr (requires { ports.rates; })
      if (ports.plain.layer->flags & kLayerRatesGiven) extras.rates = ports.rates.block;
    if constexpr (requires { ports.down; }) extras.down = ports.down.block;
    SimulateModal<V, kPoints, kVertexChains>::RunWith(params, ports.plain, extras);
  }
};

// With the roots' velocities, in frames that have them.
template <class V, uint32_t kPoints, bool kVertexChains>
struct SimulateModalRated
    : SimulateModalWith<V, kPoints, kVertexChains, modal::RatedPorts<kPoints, kVertexChains>> {
  static constexpr std::string_view kName =
      kVertexChains ? "simulate_modal_rated_vertex"
                    : ByPoints<kPoints>("simulate_modal_rated_4", "simulate_modal_rated_5",
                                        "simulate_modal_rated_9");
};

// Of sag-free layers.
template <class V, uint32_t kPoints, bool kVertexChains>
struct SimulateModalHeld
    : SimulateModalWith<V, kPoints, kVertexChains, modal::HeldPorts<kPoints, kVertexChains>> {
  static constexpr std::string_view kName =
      kVertexChains ? "simulate_modal_held_vertex"
                    : ByPoints<kPoints>("simulate_modal_held_4", "simulate_modal_held_5",
                                        "simulate_modal_held_9");
};

template <class V, uint32_t kPoints, bool kVertexChains>
struct SimulateModalRatedHeld
    : SimulateModalWith<V, kPoints, kVertexChains, modal::RatedHeldPorts<kPoints, kVertexChains>> {
  static constexpr std::string_view kName =
      kVertexChains
          ? "simulate_modal_rated_held_vertex"
          : ByPoints<kPoints>("simulate_modal_rated_held_4", "simulate_modal_rated_held_5",
                              "simulate_modal_rated_held_9");
};

}  // namespace pelt
