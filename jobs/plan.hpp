// What runs in a frame, in which order, and what follows from the kernels' ports.
//
// A frame is a list of stages (of fur: core/kernels/frame_table.cpp). CompilePlan derives passes
// from it: neighbouring stages of one domain run back to back on an item while it is in cache, or
// in local store. An item of a pass waits for those items of earlier passes that touch what it
// touches: the waits of its pass say which (plan.cpp). That is the only synchronisation of a
// frame; to do all of a pass before any of the next keeps every wait.
//
// Invariant: stages of one pass touch only what belongs to their item, except for reading blocks no
// stage of the pass writes. If that broke, items of a pass would race.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/error.hpp"
#include "core/stage.hpp"
#include "jobs/frame_graph.hpp"

namespace pelt {

const char* DomainName(Domain domain);  // "chunk"

// One stream as a pass uses it.
struct PassStream {
  Stream stream;
  Access access;   // of the first stage that uses it
  uint32_t bytes;  // in local store, for one item, in the largest case
  bool get, put;   // copied in before, out after
  bool transient;  // written first and used nowhere else in the frame: a console need not put it
};

// Which items of an earlier pass an item waits for.
struct Wait {
  uint32_t pass;
  // All that are in the same scene, character or layer; the pass's own domain: the same item alone.
  Domain within;
  // Of those, when not kNone, only the ones that this list of the waiting item names.
  Stream list = Stream::kNone;
  friend bool operator==(const Wait&, const Wait&) = default;
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
  std::vector<Wait> waits = {};  // none that follows from the others; by pass, then list
};

struct PlanOptions {
  bool fuse = true;
  // What a local store has for data, after code and stack. Passes fuse only while they fit it twice
  // over.
  uint32_t local_store_data_bytes = 176 * 1024;
  // Where it is known what each kernel's code takes, by name, a pass has in place of that what its own code
  // leaves of `code_and_data_bytes`: one with much of it makes no other smaller.
  std::function<uint32_t(std::string_view kernel)> code_bytes = {};
  uint32_t code_and_data_bytes = 0;
  // Without must_fit they fuse while they fit this twice over: half of what a core has to itself of
  // cache. What one stage leaves there the next one need not fetch again.
  uint32_t cache_bytes = 512 * 1024;
  // A stage that does not fit is refused. Without this (main memory) it becomes a pass of its own:
  // only sorting a large layer whole is that big.
  bool must_fit = true;
};

struct Plan {
  const StreamTable* table = nullptr;  // that its stages' ports are of
  std::vector<Stage> stages;
  std::vector<Pass> passes;
  std::vector<Wait> waits_of_end;  // the frame is done when these are
  FrameGraph graph;  // what the waits mean for the items of the shape it was compiled for
};

// Stages that no layer of the scene has the kind for are left out. Fails, naming the stage: when it
// does not fit the local store, and by how much; when a port or gate does not suit the stage's
// domain or stream; when two of its ports are one stream and one of them is written; when its ports
// are of another table than those of other stages.
Result<Plan> CompilePlan(std::vector<Stage> stages, const SceneShape& shape,
                         const PlanOptions& options);

}  // namespace pelt
