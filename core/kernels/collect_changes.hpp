// Gathers, for one layer, what its chunks report: how many strands are drawn, whether the layer has
// to be sorted again and whether its vertices have to be written again.
//
// Runs before the sort, so that the sort and vertex generation can be left out for a layer whose
// keys and records are last frame's: the order and the vertices of last frame are still there and
// still right. What faces the camera is written again for a moved eye though no record changed.
//
// Invariant: a chunk of a layer out of view reports nothing and counts nothing (see activate.hpp),
// so such a layer has visible_count 0 and is neither sorted nor drawn; when it comes back, every
// chunk restarts and reports changed keys.
#pragma once

#include "core/chunk.hpp"
#include "core/kernel.hpp"
#include "core/kernels/activate.hpp"
#include "core/outputs.hpp"
#include "core/streams.hpp"

namespace pelt {

struct CollectChangesParams {
  uint32_t switches;      // SkipSwitch: without kSwitchSkipSort visible layers always "change"
  uint32_t view_changed;  // not 0: eye or forward differs from last frame's
};

template <class V>
struct CollectChanges {
  static constexpr std::string_view kName = "collect_changes";
  using Params = CollectChangesParams;
  struct Ports {
    In<&Streams::layers> layer;
    All<&Streams::chunk_state> chunks;
    Out<&Streams::layer_sort> sort;
  };

  static void Run(const Params& p, const Ports& ports) {
    uint32_t drawn = 0, live = 0, keys = 0, records = 0;
    for (uint32_t c = 0; c < ports.chunks.count; ++c) {
      const ChunkStateBlock& chunk = ports.chunks[c];
      drawn += chunk.visible_strands;
      live += chunk.live_strands;
      keys |= chunk.keys_changed;
      records |= chunk.records_changed;
    }
    if (live != 0 && p.view_changed != 0 && (ports.layer->flags & kEyeFacingFlags)) records = 1;
    if (live != 0 && !(p.switches & kSwitchSkipSort)) keys = records = 1;
    ports.sort->visible_count = drawn;
    ports.sort->keys_changed = keys != 0 ? 1u : 0u;
    ports.sort->records_changed = records != 0 ? 1u : 0u;
  }
};

}  // namespace pelt
