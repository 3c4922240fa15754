// Decides, for one chunk, how many strands live this frame and what has to be done for them.
//
// Every skip here is exact: what is not done would have written the bits that are already there.
//
// - Skin, anchors and roots are functions of the matrices of the chunk's joints; the motion they
//   also write is this frame's position minus last frame's. So they can be left out when no joint
//   of the chunk moved this frame (same matrices, same positions) nor last frame (the motion stored
//   is already zero), no lane is new and last frame's values exist (no restart).
// - A simulation step is a function of the chain state, roots, wind, the layer's parameters, the
//   frame's inputs (dt, ground, spheres) and which lanes are new. When last frame's step gave back
//   the state it was given, bit for bit, and every one of those is as it was then, this frame's
//   step would give it back again: the chunk sleeps. By induction over the frames asleep the state
//   stays. "As it was then" needs care in three places: a step that started lanes from the groom
//   was not given the stored state, so whether state_changed is 0 says nothing after a restart or
//   after new lanes; a changed live count moves the border of lanes that restart; wind varies with
//   time, so a chunk in wind never sleeps. A layer without kLayerSimulate lies on its groom
//   whatever the wind, dt, ground and spheres do: its chunks sleep as soon as their roots rest.
// - Fit is a function of roots, chain state, layer parameters and the LOD fade. It can be left out
//   when none of those was written or changed.
// - Sort keys are a function of fit's inputs and of the view.
//
// Invariant: the fields simulate, sort_key and fit report by (state_changed, keys_changed,
// records_changed) are last frame's when this kernel starts and 0 when it ends, so a stage that
// does not run has reported "unchanged". records_changed is known here and set here.
//
// Lanes from live_strands up to a multiple of kLaneGroup are worked on, and thrown away, by vector
// kernels. live_vertices therefore counts the vertices of those lanes too: nothing reads a vertex
// that was not skinned. Such lanes start from the groom every frame (they are not below
// first_new_strand), so what lies in them is the same whether a chunk slept or not.
//
// What breaks if ignored: digests with and without the skips differ (tests/kernels/
// activate_test.cpp holds the truth table against a brute-force model).
#pragma once

#include "core/chunk.hpp"
#include "core/kernel.hpp"
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

// Vertices used by every lane a vector kernel touches for `live` strands.
PELT_INLINE uint32_t CountVertices(const StrandBlock& strands, uint32_t live) {
  uint32_t last = RoundUpToLaneGroups(live);
  if (last > strands.strand_count) last = strands.strand_count;
  const uint32_t vertices = uint32_t(strands.vertex_prefix[last - 1]) + 1;
  return vertices < strands.vertex_count ? vertices : strands.vertex_count;
}

PELT_INLINE bool HasMoved(const PaletteBlock& palette, const StrandBlock& strands) {
  uint32_t moved = 0;
  for (uint32_t w = 0; w < kJointsPerCharacter / 32; ++w)
    moved |= palette.moved[w] & strands.joint_mask[w];
  return moved != 0;
}

}  // namespace activate_detail

template <class V>
struct Activate {
  static constexpr std::string_view kName = "activate";
  using Params = ActivateParams;
  struct Ports {
    Shared<&Streams::palette> palette;
    Shared<&Streams::layers> layer;
    Shared<&Streams::lod> lod;
    In<&Streams::strands> strands;
    InOut<&Streams::chunk_state> state;
  };

  // What of last frame's block the rules need.
  struct LastFrame {
    bool visible, stepped_from_stored_state, state_changed, moved;
    uint32_t live_strands, live_vertices;
    float live_exact, fade_count;
  };

  static PELT_INLINE LastFrame ReadLastFrame(const ChunkStateBlock& s) {
    const bool no_new_lanes =
        s.first_new_strand >= s.live_strands && s.first_new_vertex >= s.live_vertices;
    return {(s.flags & kChunkVisible) != 0,
            no_new_lanes,  // and so no restart
            s.state_changed != 0,
            s.moved != 0,
            s.live_strands,
            s.live_vertices,
            s.live_exact,
            s.fade_count};
  }

  static PELT_INLINE void WriteCulled(ChunkStateBlock& s, uint32_t first_place) {
    s.flags = 0;
    s.live_strands = s.live_vertices = 0;
    s.first_new_strand = s.first_new_vertex = 0;
    s.live_exact = s.fade_count = 0.0f;
    s.moved = s.was_moved = 0;
    s.state_changed = s.keys_changed = s.records_changed = 0;
    s.first_place = first_place;
    s.visible_strands = 0;
  }

  // The live prefix, and from where on its lanes have no last frame.
  static PELT_INLINE void WriteLive(const Ports& ports, const LastFrame& last, bool restart) {
    using namespace activate_detail;
    const StrandBlock& strands = *ports.strands;
    ChunkStateBlock& s = *ports.state;
    s.live_exact = ports.lod->fraction * float(strands.strand_count);
    s.fade_count = ports.lod->fade * float(strands.strand_count);
    s.live_strands = CountLive(s.live_exact, strands.strand_count);
    s.live_vertices = CountVertices(strands, s.live_strands);
    const uint32_t old_strands = restart ? 0 : last.live_strands;
    const uint32_t old_vertices = restart ? 0 : last.live_vertices;
    s.first_new_strand = old_strands < s.live_strands ? old_strands : s.live_strands;
    s.first_new_vertex = old_vertices < s.live_vertices ? old_vertices : s.live_vertices;
  }

  static PELT_INLINE uint32_t DecideStages(const Params& p, const Ports& ports,
                                           const LastFrame& last, bool restart) {
    const LayerBlock& layer = *ports.layer;
    const ChunkStateBlock& s = *ports.state;
    const bool grew = s.first_new_strand < s.live_strands || s.first_new_vertex < s.live_vertices;
    const bool live_changed =
        s.live_strands != last.live_strands || s.live_vertices != last.live_vertices;
    const bool fade_changed =
        s.fade_count != last.fade_count || (s.fade_count > 0.0f && s.live_exact != last.live_exact);
    const bool roots_changed = restart || grew || s.moved != 0 || s.was_moved != 0;
    // A layer that is not simulated lies on its groom and feels none of the frame's inputs.
    const bool forced = (layer.flags & kLayerSimulate) &&
                        ((layer.flags & kLayerWind) || p.frame_inputs_changed != 0);
    const bool settled =
        last.stepped_from_stored_state && !roots_changed && !live_changed && layer.changed == 0;
    const bool may_sleep = settled && !forced && !last.state_changed;
    // Of nothing that may be left out, as what follows from it is part of the bits.
    const bool steady = settled && !(layer.flags & kLayerBlows) && p.frame_inputs_changed == 0;

    const bool skin = roots_changed || !(p.switches & kSwitchSkipUnmoved);
    const bool simulate = !may_sleep || !(p.switches & kSwitchSleep);
    const bool fit = simulate || fade_changed;
    const bool keys = fit || p.view_changed != 0 || !(p.switches & kSwitchSkipSort);
    return (skin ? kChunkSkin : 0u) | (simulate ? kChunkSimulate : 0u) | (fit ? kChunkFit : 0u) |
           (keys ? kChunkKeys : 0u) | (steady ? kChunkSteady : 0u);
  }

  static void Run(const Params& p, const Ports& ports) {
    const StrandBlock& strands = *ports.strands;
    ChunkStateBlock& s = *ports.state;
    const bool visible = ports.lod->visible != 0 && (ports.layer->flags & kLayerEnabled) &&
                         ports.lod->fraction > 0.0f && strands.strand_count > 0;
    if (!visible) {
      WriteCulled(s, strands.first_strand);
      return;
    }
    const LastFrame last = ReadLastFrame(s);
    const bool restart = p.first_frame != 0 || !last.visible || ports.palette->teleported != 0;
    s.was_moved = last.moved ? 1u : 0u;
    s.moved = activate_detail::HasMoved(*ports.palette, strands) ? 1u : 0u;
    WriteLive(ports, last, restart);
    const uint32_t stages = DecideStages(p, ports, last, restart);
    s.flags = kChunkVisible | stages | (restart ? kChunkRestart : 0u);
    s.state_changed = 0;
    s.keys_changed = 0;
    s.records_changed = (stages & kChunkFit) ? 1u : 0u;
    s.first_place = strands.first_strand;
    if (restart) s.visible_strands = 0;
  }
};

}  // namespace pelt
