// Decides, for one patch or chunk, how many of its vertices or strands live this frame and what has to
// be done for them.
//
// Every skip here is exact: what is not done would have written the bits that are already there.
//
// - Skin, anchors and roots are functions of the matrices of the item's joints; the motion they
//   also write is this frame's position minus last frame's. So they can be left out when no joint
//   of the item moved this frame (same matrices, same positions) nor last frame (the motion stored
//   is already zero), no lane is new and last frame's values exist (no restart).
// - A simulation step is a function of the chain state, roots, wind, the layer's parameters, the
//   frame's inputs (dt, ground, spheres) and which lanes are new. When last frame's step gave back
//   the state it was given, bit for bit, and every one of those is as it was then, this frame's
//   step would give it back again: the patch or chunk sleeps. By induction over the frames asleep the state
//   stays. "As it was then" needs care in three places: a step that started lanes from the groom
//   was not given the stored state, so whether state_changed is 0 says nothing after a restart or
//   after new lanes; a changed live count moves the border of lanes that restart; wind varies with
//   time, so what is in wind never sleeps; force volumes do not, so what they hold comes to rest. A layer without
//   kLayerSimulate lies on its groom regardless of wind, dt, ground and spheres: it sleeps as soon as its roots rest.
// - Fit is a function of roots, chain state, layer parameters and the LOD fade. It can be left out
//   when none of those was written or changed. Strands that follow chains at vertices wake with the
//   patches that those lie in.
// - Sort keys are a function of fit's inputs and of the view.
//
// Invariant: the fields simulate, sort_key and fit report by (state_changed, keys_changed,
// records_changed) are last frame's when this kernel starts and 0 when it ends, so a stage that
// does not run has reported "unchanged". records_changed is known here and set here.
//
// Lanes from the last living one up to a multiple of kLaneGroup are worked on, and thrown away, by
// vector kernels. PatchBlock::live_from therefore counts the vertices of those lanes too: nothing reads
// a vertex that was not skinned. Such lanes start from the groom every frame (they are not below
// first_new_strand), so what lies in them is the same whether a chunk slept or not.
//
// What breaks if ignored: digests with and without the skips differ (tests/kernels/activate_test.cpp
// holds the truth tables, activate_layer_test.cpp what happens to a layer).
#pragma once

#include "core/chunk.hpp"
#include "core/kernel.hpp"
#include "core/layer.hpp"
#include "core/streams.hpp"

namespace pelt {

// What may be left out. All off: every stage runs on every visible chunk.
enum SkipSwitch : uint32_t {
  kSwitchSleep = 1u << 0,        // simulate and fit
  kSwitchSkipUnmoved = 1u << 1,  // skin, anchors, roots
  kSwitchSkipSort = 1u << 2,     // sort keys; sort and vertex generation (collect_changes)
};

struct ActivateParams {
  uint32_t switches;              // SkipSwitch
  uint32_t frame_inputs_changed;  // not 0: dt, ground, spheres or anything else that simulate reads
                                  // besides streams differs from last frame's (wind apart)
  uint32_t view_changed;          // not 0: eye or forward differs from last frame's
  uint32_t first_frame;           // not 0: there is no last frame
};

namespace activate_detail {

// `exact` rounded up, at least 1 and at most `count`.
PELT_INLINE uint32_t CountLive(float exact, uint32_t count) {
  uint32_t live = uint32_t(exact);
  if (float(live) < exact) ++live;
  if (live < 1) live = 1;
  return live < count ? live : count;
}

// Vertices that the living strands of any chunk use.
PELT_INLINE uint32_t CountVertices(const PatchBlock& patch, float fraction) {
  uint32_t groups = 0;
  while (groups < kVertexGroups && fraction > patch.live_from[groups]) ++groups;
  const uint32_t vertices = groups * kLaneGroup;
  return vertices < patch.vertex_count ? vertices : patch.vertex_count;
}

// How many of the living vertices' chains are simulated, and from where on they have no last frame.
PELT_INLINE void WriteChains(const LodBlock& lod, uint32_t vertex_count, bool restart,
                             ChunkStateBlock& s) {
  const auto count = [&](uint32_t level) {
    const uint32_t chains = CountChains(vertex_count, level);
    return chains < s.live_vertices ? chains : s.live_vertices;
  };
  const uint32_t old = restart ? 0 : s.live_chains;
  s.live_chains = count(lod.chain_level);
  s.first_new_chain = old < s.live_chains ? old : s.live_chains;
  s.parent_share = lod.parent_share;
  s.whole_chains = lod.parent_share > 0.0f ? count(lod.chain_level + 1) : s.live_chains;
}

PELT_INLINE bool HasMoved(const PaletteBlock& palette,
                          const uint32_t (&joint_mask)[kJointsPerCharacter / 32]) {
  uint32_t moved = 0;
  for (uint32_t w = 0; w < kJointsPerCharacter / 32; ++w) moved |= palette.moved[w] & joint_mask[w];
  return moved != 0;
}

PELT_INLINE bool IsSeen(const LayerBlock& layer, const LodBlock& lod, uint32_t count) {
  return lod.visible != 0 && (layer.flags & kLayerEnabled) && lod.fraction > 0.0f && count > 0;
}

// What of last frame's block the rules need.
struct LastFrame {
  bool visible, stepped_from_stored_state, state_changed, moved;
  uint32_t live;
  float live_exact, fade_count;
};

PELT_INLINE LastFrame ReadLastFrame(const ChunkStateBlock& s, uint32_t live, uint32_t first_new) {
  return {(s.flags & kChunkVisible) != 0,
          first_new >= live,  // no new lanes, and so no restart
          s.state_changed != 0,
          s.moved != 0,
          live,
          s.live_exact,
          s.fade_count};
}

PELT_INLINE bool Restarts(const ActivateParams& p, const LastFrame& last,
                          const PaletteBlock& palette) {
  return p.first_frame != 0 || !last.visible || palette.teleported != 0;
}

// What runs of an item, and why.
struct Causes {
  bool restart, grew, live_changed, fade_changed;
  bool awake;  // what its strands follow is simulated
};

PELT_INLINE uint32_t DecideStages(const ActivateParams& p, const LayerBlock& layer,
                                  const ChunkStateBlock& s, const LastFrame& last,
                                  const Causes& causes) {
  const bool roots_changed = causes.restart || causes.grew || s.moved != 0 || s.was_moved != 0;
  // A layer that is not simulated lies on its groom and feels none of the frame's inputs.
  // Force volumes alone do not vary with time: that they change, or that a layer's box comes to one, changes the layer.
  const bool blown =
      (layer.flags & (kLayerWind | kLayerPushed)) == kLayerWind || (layer.flags & kLayerBlows);
  const bool forced = (layer.flags & kLayerSimulate) && (blown || p.frame_inputs_changed != 0);
  const bool settled = last.stepped_from_stored_state && !roots_changed && !causes.live_changed &&
                       layer.changed == 0;
  const bool may_sleep = settled && !forced && !last.state_changed && !causes.awake;
  // Of nothing that may be left out, as what follows from it is part of the bits.
  const bool steady = settled && !(layer.flags & kLayerBlows) && p.frame_inputs_changed == 0;

  const bool skin = roots_changed || !(p.switches & kSwitchSkipUnmoved);
  const bool simulate = !may_sleep || !(p.switches & kSwitchSleep);
  const bool fit = simulate || causes.fade_changed;
  const bool keys = fit || p.view_changed != 0 || !(p.switches & kSwitchSkipSort);
  return (skin ? kChunkSkin : 0u) | (simulate ? kChunkSimulate : 0u) | (fit ? kChunkFit : 0u) |
         (keys ? kChunkKeys : 0u) | (steady ? kChunkSteady : 0u);
}

}  // namespace activate_detail

// Of a patch.
template <class V>
struct ActivatePatch {
  static constexpr std::string_view kName = "activate_patch";
  using Params = ActivateParams;
  struct Ports {
    Shared<&Streams::palette> palette;
    Shared<&Streams::layers> layer;
    Shared<&Streams::lod> lod;
    In<&Streams::patches> patch;
    InOut<&Streams::patch_state> state;
  };

  static void Run(const Params& p, const Ports& ports) {
    using namespace activate_detail;
    const PatchBlock& patch = *ports.patch;
    ChunkStateBlock& s = *ports.state;
    if (!IsSeen(*ports.layer, *ports.lod, patch.vertex_count)) {
      s.flags = s.live_vertices = s.first_new_vertex = 0;
      s.live_chains = s.first_new_chain = s.whole_chains = 0;
      s.parent_share = 0.0f;
      s.moved = s.was_moved = s.state_changed = 0;
      return;
    }
    const LastFrame last = ReadLastFrame(s, s.live_chains, s.first_new_chain);
    const uint32_t last_vertices = s.live_vertices;
    const float last_share = s.parent_share;
    const bool restart = Restarts(p, last, *ports.palette);
    s.was_moved = last.moved ? 1u : 0u;
    s.moved = HasMoved(*ports.palette, patch.joint_mask) ? 1u : 0u;
    s.live_vertices = CountVertices(patch, ports.lod->fraction);
    const uint32_t old = restart ? 0 : last_vertices;
    s.first_new_vertex = old < s.live_vertices ? old : s.live_vertices;
    WriteChains(*ports.lod, patch.vertex_count, restart, s);
    const bool grew = s.first_new_vertex < s.live_vertices || s.first_new_chain < s.live_chains;
    const bool live_changed = s.live_vertices != last_vertices || s.live_chains != last.live ||
                              s.parent_share != last_share;
    const uint32_t stages =
        DecideStages(p, *ports.layer, s, last, {restart, grew, live_changed, false, false});
    s.flags = kChunkVisible | stages | (restart ? kChunkRestart : 0u);
    s.state_changed = 0;
  }
};

namespace activate_detail {

PELT_INLINE void WriteCulled(ChunkStateBlock& s, uint32_t first_place) {
  s.flags = 0;
  s.live_strands = s.first_new_strand = 0;
  s.live_exact = s.fade_count = 0.0f;
  s.moved = s.was_moved = 0;
  s.state_changed = s.keys_changed = s.records_changed = 0;
  s.first_place = first_place;
  s.visible_strands = 0;
}

// The live prefix, and from where on its lanes have no last frame.
PELT_INLINE void WriteLive(const LodBlock& lod, uint32_t strand_count, const LastFrame& last,
                           bool restart, ChunkStateBlock& s) {
  s.live_exact = lod.fraction * float(strand_count);
  s.fade_count = lod.fade * float(strand_count);
  s.live_strands = CountLive(s.live_exact, strand_count);
  const uint32_t old = restart ? 0 : last.live;
  s.first_new_strand = old < s.live_strands ? old : s.live_strands;
}

struct ChunkPorts {
  Shared<&Streams::palette> palette;
  Shared<&Streams::layers> layer;
  Shared<&Streams::lod> lod;
  In<&Streams::strands> strands;
};

// `awake`: some patch that the chunk's strands follow is simulated.
PELT_INLINE void RunChunk(const ActivateParams& p, const ChunkPorts& ports, ChunkStateBlock& s,
                          bool awake) {
  const StrandBlock& strands = *ports.strands;
  const LayerBlock& layer = *ports.layer;
  if (!IsSeen(layer, *ports.lod, strands.strand_count)) {
    WriteCulled(s, strands.first_strand);
    return;
  }
  const LastFrame last = ReadLastFrame(s, s.live_strands, s.first_new_strand);
  const bool restart = Restarts(p, last, *ports.palette);
  s.was_moved = last.moved ? 1u : 0u;
  s.moved = HasMoved(*ports.palette, strands.joint_mask) ? 1u : 0u;
  WriteLive(*ports.lod, strands.strand_count, last, restart, s);
  const bool grew = s.first_new_strand < s.live_strands;
  const bool fade_changed =
      s.fade_count != last.fade_count || (s.fade_count > 0.0f && s.live_exact != last.live_exact);
  const uint32_t stages = DecideStages(
      p, layer, s, last, {restart, grew, s.live_strands != last.live, fade_changed, awake});
  s.flags = kChunkVisible | stages | (restart ? kChunkRestart : 0u);
  s.state_changed = 0;
  s.keys_changed = 0;
  s.records_changed = (stages & kChunkFit) ? 1u : 0u;
  s.first_place = strands.first_strand;
  if (restart) s.visible_strands = 0;
  if (layer.flags & kLayerShells) s.visible_strands = s.live_strands;
}

}  // namespace activate_detail

// Of a chunk whose strands have chains of their own.
template <class V>
struct Activate {
  static constexpr std::string_view kName = "activate";
  using Params = ActivateParams;
  struct Ports {
    activate_detail::ChunkPorts chunk;
    InOut<&Streams::chunk_state> state;
  };

  static void Run(const Params& p, const Ports& ports) {
    activate_detail::RunChunk(p, ports.chunk, *ports.state, false);
  }
};

// Of one whose strands follow chains at vertices.
template <class V>
struct ActivateFollowers {
  static constexpr std::string_view kName = "activate_followers";
  using Params = ActivateParams;
  struct Ports {
    activate_detail::ChunkPorts chunk;
    In<&Streams::patch_list> list;
    GatherBlocks<&Streams::patch_state, &Streams::patch_list> patches;
    InOut<&Streams::chunk_state> state;
  };

  static void Run(const Params& p, const Ports& ports) {
    const uint32_t(&patch)[kListedPatches + 1] = ports.list->patch;
    bool awake = patch[kListedPatches] != ~0u;  // some are not listed
    for (uint32_t i = 0; i < kListedPatches && patch[i] != ~0u && !awake; ++i)
      awake = (ports.patches[i].flags & kChunkSimulate) != 0;
    activate_detail::RunChunk(p, ports.chunk, *ports.state, awake);
  }
};

}  // namespace pelt
