// One operation of a kernel as it ran: what a recording vector saw.
//
// A trace is a list of these in program order, on values that are numbered as they are made: each
// is made once and before any that reads it. Control is gone (what ran, ran), but for the branches
// that looked at data. Addresses are places in a space of the recorder's own (recorder.hpp), so a
// trace says the same on every machine.
//
// What an operation computes is not in it, only that it was computed: a core model needs no more.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

namespace pelt {

enum class RecordedKind : uint8_t {
  // Vectors of four lanes.
  kSplat,       // one word on all lanes: `bits`
  kIota,        // first, first + 1, ...
  kLoad,        // 16 bytes
  kLoadRecord,  // 16 bytes, whose place was looked up: a lane's own record
  kLoadBytes,   // four bytes, widened
  kLoadSplat,   // four bytes on all lanes; operand 0: index, if a value
  kStore,       // 16 bytes
  kAdd,
  kSubtract,
  kMultiply,
  kDivide,
  kNegate,
  kReciprocalRoot,
  kReciprocalEstimate,  // what the machine has, without a Newton step
  kReciprocalRootEstimate,
  kMin,
  kMax,
  kLess,       // a < b; a > b is b < a
  kLessEqual,  // a <= b
  kEqual,
  kMaskAnd,
  kMaskOr,
  kMaskNot,
  kAny,     // a branch
  kAllSet,  // a branch
  kSelect,  // mask, if set, if not
  kIntAdd,
  kIntSubtract,
  kIntMultiply,
  kIntAnd,
  kIntOr,
  kIntXor,
  kIntShiftLeft,
  kIntShiftRight,
  kIntEqual,
  kIntLess,
  kTruncate,
  kToFloat,
  kTranspose,     // four values to four
  kSplatInFours,  // one lane to all
  kExtract,       // one lane to a scalar, which is not followed further
  // Scalar words of `size_bytes`. An operand that is kNoValue is a constant of the code.
  kWordLoad,   // operand 0: index, if a value
  kWordStore,  // operand 0: what is stored; operand 1: index, if a value
  kWordAdd,
  kWordSubtract,
  kWordAnd,
  kWordOr,
  kWordShiftLeft,
  kWordShiftRight,
  kWordDiffers,  // 1 where a != b
  // Not recorded: made of a product with one reader and the sum that reads it (simplify_trace.hpp).
  kMultiplyAdd,       // a * b + c
  kMultiplySubtract,  // a * b - c
  kSubtractMultiply,  // c - a * b
  kCount,
};
inline constexpr uint32_t kRecordedKindCount = uint32_t(RecordedKind::kCount);
std::string_view RecordedKindName(RecordedKind kind);

// Arithmetic, compare, select, logic or conversion on lanes, as many as one is: what
// bench/benchmarks/frame_benchmark.cpp counts. A reciprocal root is the 16 of its exact sequence.
uint32_t LaneArithmetic(RecordedKind kind);

inline constexpr uint32_t kNoValue = 0xFFFFFFFF;

struct RecordedOperation {
  RecordedKind kind = RecordedKind::kSplat;
  uint8_t size_bytes = 0;     // of what is loaded or stored, of a word
  uint8_t operand_count = 0;  // of `operand`
  uint8_t result_count = 0;   // results are `result`, `result` + 1, ...
  bool is_side = false;       // one operation of the source with the one before it (recorder.hpp)
  uint32_t result = kNoValue;
  std::array<uint32_t, 4> operand{kNoValue, kNoValue, kNoValue, kNoValue};
  int32_t address = 0;
  uint32_t bits = 0;  // of a splat; the lane of an extraction or splat in fours
};

constexpr bool IsLoad(RecordedKind kind) {
  return kind == RecordedKind::kLoad || kind == RecordedKind::kLoadRecord ||
         kind == RecordedKind::kLoadBytes || kind == RecordedKind::kLoadSplat ||
         kind == RecordedKind::kWordLoad;
}
constexpr bool IsStore(RecordedKind kind) {
  return kind == RecordedKind::kStore || kind == RecordedKind::kWordStore;
}
// What must stay, whoever reads its results.
constexpr bool HasEffect(RecordedKind kind) {
  return IsStore(kind) || kind == RecordedKind::kAny || kind == RecordedKind::kAllSet ||
         kind == RecordedKind::kExtract;
}

struct Trace {
  std::vector<RecordedOperation> operations;
  uint32_t value_count = 0;
};

}  // namespace pelt
