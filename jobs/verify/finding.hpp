// What kind of fault a verification found: the first thing to know for a programmer who has to mend
// it.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

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

}  // namespace pelt
