// A kernel as it ran: what a recording vector saw. And what is done with that before it becomes instructions.
//
// A trace is a list of operations in program order, on values that are numbered as they are made: each
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
  // Not recorded: made of a product with one reader and the sum that reads it (SimplifyTrace).
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

// A trace in the order its source was written in, regardless of which compiler built the kernels.
//
// C++ leaves one thing open: which operand of an expression is computed first. Of a * b + c * d one
// compiler records the left product first, another the right one. Costs must not depend on that, so
// here it is always the left one; all else stays where the source has it.
//
// Idea: operands that may change places are read by their own expression only. So the trace falls
// into stretches, from behind: what stands before an operation without a gap and is read by none
// behind it. Within a stretch all leads to its last operation, and a walk from there, operands from
// left to right, gives the order. Two traces that differ by who came first have the same stretches
// and the same walks.
//
//   ... | load a, load b, a * b, load c, load d, c * d, +, store | ...     one stretch: the store's
//   ... | x = ... | y = x * x | z = x + y ...                              x is read by two: its own
//
// What stays open are operands of several values, such as the vectors of a * s + b * t: no single
// operation is their last. Kernels give such operands names, or use Combine (core/simd/maths.hpp);
// a test compares the prices of every compiler with the same digest.
//
// Operations that nothing needs are left out. Constants come right before their first reader: which expression
// names one first is open as well.
//
// Invariant: the same values, from the same operands; what has an effect stays in its order, and
// nothing crosses it; every load reads what it read. Values, constants and temporaries are numbered
// anew, in the new order. Two effects in one expression are the one thing that remains open;
// kernels do not write such.
Trace InWrittenOrder(const Trace& trace);

// What a compiler does with a kernel before it thinks of a machine's instructions: computes equal
// things once (what does not change from iteration to iteration leaves the loop with that), drops
// what nothing reads, and, where the machine has it, makes multiply-adds of products that one sum
// reads.
//
// Invariant: what remains reads and writes the same memory in the same order, but for loads of what
// was loaded before and not written since. Records are loaded each time: which one it is, the code
// does not know. If ignored: strands that share a vertex would look as if they cost nothing.

struct SimplifyRules {
  // Off: products are rounded by themselves, as on the host.
  bool fuse_multiply_add = true;
};

// Operations [begin, end) of the trace. Values made before are there; values read behind `end` are
// kept. Their numbers stay those of the trace.
std::vector<RecordedOperation> SimplifyTrace(const Trace& trace, uint32_t begin, uint32_t end,
                                             const SimplifyRules& rules);

}  // namespace pelt
