// One frame of a patch's or chunk's chains, for any solver: ports, order of the groups, who starts
// afresh, and the report to `activate`. A solver adds only its iterations (simulate_pbd.hpp,
// simulate_verlet.hpp).
//
// Invariants:
//  - Control strands are the first lanes, a whole number of kLaneGroups; they are solved first and
//    never clump. A follower therefore reads control points of this frame, for any lane count.
//  - state_changed is 0 only if position and previous of every live lane kept all their bits.
//  - Ports that a layer does not use (wind, strands) are not read.
#pragma once

#include "core/kernel.hpp"
#include "core/kernels/chain.hpp"
#include "core/kernels/prefetch.hpp"
#include "core/streams.hpp"

namespace pelt::chain {

template <uint32_t kPoints, bool kVertexChains>
struct Ports {
  using Of = ChainStreams<kPoints, kVertexChains>;
  Shared<&Streams::layers> layer;
  InOut<Of::kState> state;
  In<Of::kRest> rest;
  In<Of::kRoots> roots;
  In<Of::kWind> wind;  // read only where the layer has kLayerWind
  InOut<Of::kPosition> position;
  InOut<Of::kPrevious> previous;
};

template <uint32_t kPoints>
struct Ports<kPoints, false> {
  using Of = ChainStreams<kPoints, false>;
  Shared<&Streams::layers> layer;
  InOut<Of::kState> state;
  In<Of::kRest> rest;
  In<Of::kRoots> roots;
  In<Of::kWind> wind;
  In<&Streams::strands> strands;  // control strands; read only where the layer has kLayerClump
  InOut<Of::kPosition> position;
  InOut<Of::kPrevious> previous;
};

// Chains in lanes [begin, end), both multiples of kLaneGroup: two groups at once where the machine
// has registers, as a step's operations wait for each other; on arrays unrolling would only be
// more code. group.operator()<W>(lane, live, follows) solves the chains of one W, which is V or
// Unrolled<V>.
template <class V, class Group>
bool RunRange(uint32_t begin, uint32_t end, uint32_t live, bool follows, const Group& group) {
  bool changed = false;
  uint32_t lane = begin;
  if constexpr (simd_detail::IsRegister<V> || HasManyRegisters<V>)
    for (; lane + Unrolled<V>::kLanes <= end; lane += Unrolled<V>::kLanes)
      changed |= group.template operator()<Unrolled<V>>(lane, live, follows);
  if constexpr (V::kLanes == int(kLaneGroup) ||
                !(simd_detail::IsRegister<V> || HasManyRegisters<V>))
    for (; lane < end; lane += V::kLanes)
      changed |= group.template operator()<V>(lane, live, follows);
  return changed;
}

// All live chains of a chunk: the control strands, then those that follow them. range(begin, end, live,
// follows) solves the chains of lanes [begin, end) and says whether a bit of a live one changed.
template <bool kVertexChains, class Ports, class Range>
PELT_INLINE void RunChunk(const Ports& ports, const Range& range) {
  ChunkStateBlock& state = *ports.state;
  const uint32_t live = kVertexChains ? state.live_chains : state.live_strands;
  const uint32_t end = RoundUpToLaneGroups(live);
  uint32_t controls = end;
  if constexpr (!kVertexChains)
    if (ports.layer->flags & kLayerClump) {
      const uint32_t count = ports.strands->control_count;
      if (count > 0 && count < end) controls = count;
    }
  bool changed = range(0u, controls, live, false);
  if constexpr (!kVertexChains)
    if (controls < end) changed |= range(controls, end, live, true);
  state.state_changed = changed ? 1 : 0;
}

// Solver<V, kPoints>::Iterate(terms, colliders, clump, clump_pull, group) moves the group's points, by the
// layer's terms or each lane's (traits.hpp). `clump_pull` is the control strand's offset from the follower's
// root times the share of the point; it is read only when `clump` is set.
template <class V, uint32_t kPoints, bool kVertexChains, class Solver>
struct Step {
  static_assert(kPoints == 4 || kPoints == 5);
  static constexpr uint32_t kFree = kPoints - 1;
  using Ports = chain::Ports<kPoints, kVertexChains>;

  template <class Traits = traits::NoTraits>
  PELT_INLINE static void Run(const SimulateParams& params, const Ports& ports,
                              const Traits& traits = {}) {
    RunChunk<kVertexChains>(ports, [&](uint32_t begin, uint32_t end, uint32_t live, bool follows) {
      return RunRange<V>(begin, end, live, follows,
                         [&]<class W>(uint32_t lane, uint32_t alive, bool clumps) {
                           return SolveGroup<W>(params, ports, traits, lane, alive, clumps);
                         });
    });
  }

 private:
  template <class W, class Traits>
  PELT_INLINE static bool SolveGroup(const SimulateParams& params, const Ports& ports,
                                     const Traits& traits, uint32_t lane, uint32_t live,
                                     bool follows) {
    const LayerBlock& layer = *ports.layer;
    const auto terms = traits.template Terms<W>(layer, lane);
    const ChunkStateBlock& state = *ports.state;
    const auto lanes = W::Int::Iota(int32_t(lane));
    const auto alive = lanes < typename W::Int(int32_t(live));
    const auto ahead = PrefetchInPieces<W::kLanes, 4>(
        lane, live, AllRows(*ports.position), AllRows(*ports.previous), AllRows(*ports.rest));
    ahead(Piece<0>());
    Group<W, kFree> g;
    LoadGroom<W, kPoints>(*ports.rest, *ports.roots, layer.motion_follow, layer.scale, lane, g);
    if ((state.flags & kChunkRestart) || !(layer.flags & kLayerSimulate))
      return Any(PlaceOnGroom<W, kPoints>(lane, g, *ports.position, *ports.previous) & alive);

    ahead(Piece<1>());
    const float dt2 = params.dt * params.dt;
    Vec3<W> fall = Splat3<W>(layer.gravity) * W(terms.Weight(dt2));
    if (layer.flags & kLayerWind) fall = fall + Load3<W>(ports.wind->acceleration, lane) * W(dt2);
    Predict<W, kPoints>(*ports.position, *ports.previous, terms.Keep(params.dt), fall, lane, g);
    ahead(Piece<2>());
    Colliders<W> colliders;
    LoadColliders(params, g, colliders);
    Bounces<W, kFree> bounces;
    if (layer.bounce > 0.0f)
      bounces.Record(*ports.position, terms.Weight(SlowContact(layer, params.dt)),
                     HasSurface(layer), lane, g, colliders);

    Vec3<W> clump_pull[kFree];
    if constexpr (!kVertexChains)
      if (follows) {
        const StrandBlock& strands = *ports.strands;
        const auto controls = ControlsOf<W>(strands.control, strands.control_count, lane);
        for (uint32_t i = 0; i < kFree; ++i)
          clump_pull[i] = (Load3<W>(ports.position->position[i], controls) - g.root) *
                          W(ClumpShare(terms.Clump(), i, kFree));
      }
    Solver::Iterate(terms, colliders, !kVertexChains && follows, clump_pull, g);

    ahead(Piece<3>());
    const uint32_t first_new = kVertexChains ? state.first_new_chain : state.first_new_strand;
    const auto fresh = !(lanes < typename W::Int(int32_t(first_new)));
    return Any(Finish<W, kPoints>(*ports.rest, params, layer.bounce, terms.Bounce(), bounces,
                                  colliders, fresh, lane, g, *ports.position, *ports.previous) &
               alive);
  }
};

}  // namespace pelt::chain
