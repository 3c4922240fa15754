// One item of activate's kernels and what it reads: a patch, a chunk whose strands have chains of
// their own, a chunk that follows the chains at vertices.
#pragma once

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <type_traits>

#include "core/kernels/activate.hpp"
#include "tests/kernels/run_kernel.hpp"

namespace pelt::test {

inline constexpr uint32_t kAllSwitches = kSwitchSleep | kSwitchSkipUnmoved | kSwitchSkipSort;

struct World {
  Blocks<PaletteBlock> palette{1, 0};
  Blocks<LayerBlock> layer{1, 0};
  Blocks<LodBlock> lod{1, 0};
  Blocks<ChunkStateBlock> state{1, 0};
  ActivateParams params{kAllSwitches, 0, 0, 0};

  World() {
    layer[0].flags = kLayerEnabled | kLayerSimulate;
    lod[0].visible = 1;
    lod[0].fraction = 1.0f;
  }
};

inline constexpr uint32_t kJoints[] = {5, 3 * 32 + 9};

inline void AddJoint(uint32_t joint, uint32_t (&mask)[kJointsPerCharacter / 32]) {
  mask[joint / 32] |= 1u << joint % 32;
}

// Its first half is in use from the first strand on.
struct PatchWorld : World {
  Blocks<PatchBlock> patch{1, 0};

  explicit PatchWorld(uint32_t vertex_count = kVerticesPerChunk) {
    patch[0].vertex_count = vertex_count;
    for (const uint32_t joint : kJoints) AddJoint(joint, patch[0].joint_mask);
    for (uint32_t g = 0; g < kVertexGroups; ++g)
      patch[0].live_from[g] = g < kVertexGroups / 2 ? 0.0f : 0.6f;
  }
  template <class V = ArrayVec<4>>
  const ChunkStateBlock& Run() {
    RunKernel<ActivatePatch<V>>(
        params, {palette.Bind(), layer.Bind(), lod.Bind(), patch.Bind(), state.Bind()});
    return state[0];
  }
};

// Strands with chains of their own.
struct ChunkWorld : World {
  Blocks<StrandBlock> strands{1, 0};

  explicit ChunkWorld(uint32_t strand_count = kStrandsPerChunk) {
    strands[0].strand_count = strand_count;
    strands[0].vertex_count = kVerticesPerChunk / 2;
    strands[0].first_strand = 7 * kStrandsPerChunk;
    for (const uint32_t joint : kJoints) AddJoint(joint, strands[0].joint_mask);
  }
  template <class V = ArrayVec<4>>
  const ChunkStateBlock& Run() {
    RunKernel<Activate<V>>(
        params, {palette.Bind(), layer.Bind(), lod.Bind(), strands.Bind(), state.Bind()});
    return state[0];
  }
};

inline constexpr uint32_t kEverything =
    kChunkVisible | kChunkSkin | kChunkSimulate | kChunkFit | kChunkKeys;

// Strands that follow chains at the vertices of the layer's patches 2, 5 and 9, which sleep; those
// beside them do not. kFetched: the listed states lie as a local store has them, one behind the
// other, and behind them what was not fetched.
template <bool kFetched>
struct FollowerWorldOf : ChunkWorld {
  Blocks<PatchListBlock> list{1};
  Blocks<ChunkStateBlock> patches{kListedPatches + 9, 0};

  explicit FollowerWorldOf(uint32_t strand_count = kStrandsPerChunk) : ChunkWorld(strand_count) {
    constexpr uint32_t kListed[] = {2, 5, 9};
    std::copy(std::begin(kListed), std::end(kListed), list[0].patch);
    for (const uint32_t beside : {1, 3, 10}) patches[beside].flags = kEverything;
  }
  template <class V = ArrayVec<4>>
  const ChunkStateBlock& Run() {
    Blocks<ChunkStateBlock> fetched(kFetched ? std::size(list[0].patch) : 0);
    Binding states = patches.BindList(list[0].patch);
    if (kFetched) {
      for (uint32_t i = 0; i < fetched.size(); ++i)
        if (list[0].patch[i] < patches.size()) fetched[i] = patches[list[0].patch[i]];
      states = fetched.Bind();
    }
    RunKernel<ActivateFollowers<V>>(params, {palette.Bind(), layer.Bind(), lod.Bind(),
                                             strands.Bind(), list.Bind(), states, state.Bind()});
    return state[0];
  }
};
using FollowerWorld = FollowerWorldOf<false>;
using FetchedWorld = FollowerWorldOf<true>;

// Came into view some frames ago, and its last step changed nothing.
template <class W>
void Settle(W& w) {
  w.Run();
  w.state[0].state_changed = 1;
  w.Run();
  w.state[0].state_changed = 0;
}

template <class W>
constexpr bool kIsPatch = std::is_same_v<W, PatchWorld>;

}  // namespace pelt::test
