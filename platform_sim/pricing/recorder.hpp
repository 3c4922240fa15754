// Where a recording vector (recording_vec.hpp) writes down what it does.
//
// Invariant: no host address leaves it. The blocks a kernel is bound to lie in a space of the
// recorder's own, one behind the other in the order they were named; what lies outside them
// (temporaries of the kernel) gets a place the first time it is touched, 64 bytes at a time:
//
//   0            1 MiB           64 MiB
//   | constants  | temporaries   | block 0 | block 1 | ...
//
// Lines keep their inside, so accesses overlap here exactly when they overlap there, provided a
// temporary is aligned to 64 bytes; kernels align theirs. If ignored: costs differ from run to run
// with the place of the stack.
//
// One recorder is installed on a thread at a time; without one the recording vector only computes.
#pragma once

#include <array>
#include <cstdint>
#include <initializer_list>
#include <map>
#include <vector>

#include "platform_sim/pricing/trace.hpp"

namespace pelt {

class Recorder {
 public:
  // Counts alone cost a few instructions an operation, operations some forty bytes.
  enum class Keep : uint8_t { kCounts, kOperations };
  static constexpr int32_t kTemporaries = 1 << 20, kBlocks = 64 << 20;  // where they begin
  static constexpr int32_t kLineBytes = 64;
  explicit Recorder(Keep keep) : keep_(keep) {}
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  // Of this thread; null: nothing is recorded.
  static inline thread_local Recorder* installed = nullptr;

  // Memory that the kernel is given. Naming the same twice is naming it once. False when the space
  // is full (almost 2 GiB).
  bool AddBlock(const void* begin, uint64_t bytes);

  // Operations so far, splats left out: those are made once a kernel, others once per item and
  // iteration.
  uint64_t operation_count() const { return operation_count_; }
  const std::array<uint64_t, kRecordedKindCount>& counts() const { return counts_; }
  const Trace& trace() const { return trace_; }

  // All return the number of the (first) value made.
  uint32_t Make(RecordedKind kind, std::initializer_list<uint32_t> operands, uint32_t results = 1,
                uint32_t bits = 0) {
    Count(kind);
    if (keep_ == Keep::kCounts) return kNoValue;
    return Append({.kind = kind, .bits = bits}, operands, results);
  }
  // The value that has `bits` on all lanes; an operation the first time.
  uint32_t Splat(uint32_t bits);
  uint32_t Load(RecordedKind kind, const void* from, uint32_t bytes, uint32_t index = kNoValue);
  void Store(RecordedKind kind, const void* to, uint32_t bytes, uint32_t value,
             uint32_t index = kNoValue);
  // `b` was just made by the operation that made `a`, on the vector beside it: one operation of the source.
  void SideBySide(uint32_t a, uint32_t b);
  // Of a scalar word of `bytes`; kNoValue operands are constants.
  uint32_t Word(RecordedKind kind, uint32_t bytes, uint32_t a, uint32_t b = kNoValue);

 private:
  struct Block {
    uintptr_t begin, end;
    int32_t place;
  };

  void Count(RecordedKind kind) {
    ++counts_[uint32_t(kind)];
    ++operation_count_;
  }
  uint32_t Append(RecordedOperation operation, std::initializer_list<uint32_t> operands,
                  uint32_t results);
  int32_t PlaceOf(const void* host);

  const Keep keep_;
  uint64_t operation_count_ = 0;
  std::array<uint64_t, kRecordedKindCount> counts_{};
  Trace trace_;
  std::vector<Block> blocks_;
  int64_t blocks_end_ = kBlocks;
  std::map<uintptr_t, int32_t> lines_;   // temporaries
  std::map<uint32_t, uint32_t> splats_;  // bits to value
};

// Installs a recorder for as long as it lives.
class RecorderScope {
 public:
  explicit RecorderScope(Recorder& recorder) : before_(Recorder::installed) {
    Recorder::installed = &recorder;
  }
  ~RecorderScope() { Recorder::installed = before_; }
  RecorderScope(const RecorderScope&) = delete;
  RecorderScope& operator=(const RecorderScope&) = delete;

 private:
  Recorder* before_;
};

}  // namespace pelt
