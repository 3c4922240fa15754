// What runs in a frame, in which order, and what follows from the kernels' ports.
//
// A frame is a table of stages (core/kernels/frame_table.cpp). CompilePlan derives passes from it:
// neighbouring stages of one domain run back to back on an item while it is in cache, or in local
// store. Between passes every item of the one must be done before any item of the next starts: that
// is the only synchronisation of a frame.
//
// Invariant: stages of one pass touch only what belongs to their item, except for reading blocks no
// stage of the pass writes. If that broke, items of a pass would race.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/error.hpp"
#include "core/stage.hpp"
#include "core/streams.hpp"

namespace pelt {

const char* DomainName(Domain domain);  // "chunk"

// What is in the scene and what belongs to what. Chunks of a layer, and layers of a character, are
// contiguous.
struct SceneShape {
  uint32_t character_count = 0;
  uint32_t layer_count = 0;
  uint32_t chunk_count = 0;
  std::vector<uint32_t> layer_character;
  std::vector<uint32_t> layer_first_chunk;  // layer_count + 1 entries
  std::vector<uint32_t> layer_kind;
  std::vector<uint32_t> chunk_layer;

  uint32_t ItemCount(Domain domain) const;
  uint32_t LayerChunks(uint32_t layer) const {
    return layer_first_chunk[layer + 1] - layer_first_chunk[layer];
  }
  friend bool operator==(const SceneShape&, const SceneShape&) = default;
};

// One stream as a pass uses it.
struct PassStream {
  Stream stream;
  Access access;   // of the first stage that uses it
  uint32_t bytes;  // in local store, for one item, in the largest case
  bool get, put;   // copied in before, out after
  bool transient;  // written first and used nowhere else in the frame: a console need not put it
};

struct Pass {
  uint32_t first_stage;
  uint32_t stage_count;
  Domain domain;
  std::vector<PassStream> streams;
  // For one item of the layer kind that needs most.
  uint32_t resident_bytes;  // with double buffering if `double_buffered`
  uint32_t get_bytes;
  uint32_t put_bytes;
  bool double_buffered;
};

struct PlanOptions {
  bool fuse = true;
  // What a local store has for data, after code and stack. Passes fuse only while they fit it twice
  // over.
  uint32_t local_store_data_bytes = 176 * 1024;
  // A stage that does not fit is refused. Without this (main memory) it becomes a pass of its own:
  // only sorting a large layer whole is that big.
  bool must_fit = true;
};

struct Plan {
  std::vector<Stage> stages;
  std::vector<Pass> passes;
};

// Largest layer, in chunks, whose sort fits a local store of `bytes` of data.
uint32_t SortableChunks(uint32_t local_store_data_bytes);

// Stages that no layer of the scene has the kind for are left out. Fails, naming the stage: when it
// does not fit the local store, and by how much; when a port or gate does not suit the stage's
// domain or stream; when two of its ports are one stream and one of them is written.
std::optional<Plan> TryCompilePlan(std::vector<Stage> stages, const SceneShape& shape,
                                   const PlanOptions& options, std::string& error);
#if defined(__cpp_exceptions)
inline Plan CompilePlan(std::vector<Stage> stages, const SceneShape& shape,
                        const PlanOptions& options) {
  return ValueOrThrow(
      [&](std::string& error) { return TryCompilePlan(std::move(stages), shape, options, error); });
}
#endif

}  // namespace pelt
