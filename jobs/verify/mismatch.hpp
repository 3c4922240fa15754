// What a verification finds: what kind of fault it is, the first thing to know for a programmer who has
// to mend it; and where two runs of the same frames part: stage, stream, item, row and lane, of any table
// of streams.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "jobs/frame.hpp"

namespace pelt {

enum class FindingKind : uint8_t {
  kNone,
  kValue,            // other bits than the reference, every time
  kOrder,            // the same, but only in another order of items or on several threads
  kRace,             // other bits once, and not again in lock-step
  kUndeclaredRead,   // a stage looked at memory that none of its ports declares
  kUndeclaredWrite,  // a stage wrote to memory that none of its ports declares as written
  kReadsOut,         // a stage's results depend on what lay in a port that it declares Out
  kHiddenState,      // a stage gave other results when run twice on the same blocks
  kFloats,           // other bits where the calling threads round or flush otherwise
  kSkip,             // a skip changed bits
  kSleep,            // a sleeper did not see that an input had changed
  kCull,             // a layer in view was culled, or one that came back is not as promised
  kRollback,         // other bits after going back: something was kept that is in no snapshot
  kDigest,           // a value that the digests do not see
  kWorkers,          // not the number of threads that was asked for
  kExecutor,         // what an executor finds wrong with its use: a door, a local store
};
std::string_view FindingName(FindingKind kind);  // "undeclared-read"; "" for kNone

struct Finding {
  FindingKind kind = FindingKind::kNone;
  std::string stage, stream;  // empty where it has none
  std::string text;           // one line
};

// The first value that differs, in the order of the frame's stages.
struct Mismatch {
  static constexpr uint32_t kNoLayer = ~0u;

  uint32_t frame = 0;
  std::string stage, stream, row;
  Domain domain = Domain::kScene;
  uint32_t item = 0;                // of the scene, in the domain
  uint32_t layer_index = kNoLayer;  // of streams of layers, and of what is in them
  uint32_t place_in_layer = 0;      // of patches and chunks
  std::string layer = {};           // its name, where the caller knows one
  uint32_t component = 0, lane = 0;
  uint32_t expected = 0, found = 0;
  bool is_float = false;
  bool reproduced = true;  // false: seen once, and not again in lock-step: a race
};
// One line.
std::string DescribeMismatch(const Mismatch& mismatch);

// The first difference after a frame that both have run, of values, then, if `bookkeeping` is set,
// of the bookkeeping of what ran. Of the same streams and shape; `expected` has the plan whose
// stages are gone through. Who calls knows which frame it is.
std::optional<Mismatch> FindMismatch(const Frame& expected, const Frame& found,
                                     bool bookkeeping = false);

}  // namespace pelt
