// A recorded trace as instructions of a machine: an SPU's, or the PPE's and Xenon core's with VMX.
//
// What a machine lacks expands here: divides and roots to an estimate and Newton steps, 32-bit
// multiplies to 16-bit ones, scalar words on the SPU to whole quadwords (a store reads, merges and
// writes sixteen bytes), moves between vectors and scalars on the PPE to a store and a load.
//
// Invariant: the result is StraightCode as straight_code.hpp wants it. Constants that only tell an
// instruction how to do its work (shuffle patterns, 1.0 of a Newton step) are in registers before
// the code begins, as in a loop of any length.
//
// Source: SPU and AltiVec instruction sets; Newton steps as in the measured row C5.
// Not modelled: address arithmetic beyond the look-up of a record (rows are reached from bases that
// stay in registers), and precision: an SPU truncates, a VMX estimate has 12 bits.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "platform_sim/pricing/trace.hpp"
#include "platform_sim/schedule/straight_code.hpp"

namespace pelt {

struct LoweringRules {
  // As the host computes it: no multiply-adds, and the integer-seeded root in plain arithmetic.
  // What the same operations would cost on the console. (On an SPU the bits would still differ: its
  // single precision truncates.)
  bool host_operations = false;
};

struct LoweredCode {
  StraightCode code;
  std::vector<std::string_view> name;  // of each instruction: its mnemonic
};

// `iterations`: as many of its loop as the operations are; each is charged a counter, a hint where
// there are hints, and a branch, at the end.
LoweredCode LowerToSpu(std::span<const RecordedOperation> operations, uint32_t iterations,
                       const LoweringRules& rules);
LoweredCode LowerToVmx(std::span<const RecordedOperation> operations, uint32_t iterations,
                       const LoweringRules& rules);

}  // namespace pelt
