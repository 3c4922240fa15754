// Small kernels written by hand, recorded: what the tests of recording, lowering and pricing share.
#pragma once

#include <gtest/gtest.h>

#include <map>
#include <string>

#include "core/simd.hpp"
#include "platform_sim/pricing/lowering.hpp"
#include "platform_sim/pricing/recording_vec.hpp"

namespace pelt::testing {

using Kind = RecordedKind;
using V = RecordingVec;

// Rows of a block, aligned as blocks are.
struct alignas(128) Rows {
  float row[16][64];
  uint32_t word[64];
};

// What `work(rows)` does, recorded.
template <class Work>
Trace Record(Work work) {
  static Rows rows;
  Recorder recorder(Recorder::Keep::kOperations);
  EXPECT_TRUE(recorder.AddBlock(&rows, sizeof rows));
  const RecorderScope recording(recorder);
  work(rows);
  return recorder.trace();
}

inline std::map<RecordedKind, uint32_t> CountKinds(const std::vector<RecordedOperation>& all) {
  std::map<RecordedKind, uint32_t> out;
  for (const RecordedOperation& operation : all) ++out[operation.kind];
  return out;
}

inline std::vector<RecordedOperation> Simplify(const Trace& trace, bool fuse = true) {
  return SimplifyTrace(trace, 0, uint32_t(trace.operations.size()), {.fuse_multiply_add = fuse});
}

// Mnemonics of the code, blank-separated.
inline std::string Text(const LoweredCode& lowered) {
  std::string out;
  for (const std::string_view name : lowered.name)
    out += (out.empty() ? "" : " ") + std::string(name);
  return out;
}
inline uint32_t CountName(const LoweredCode& lowered, std::string_view name) {
  uint32_t count = 0;
  for (const std::string_view other : lowered.name) count += other == name;
  return count;
}

}  // namespace pelt::testing
