// Makes straight code fit a core's registers, program order kept: where more values are live than a
// file has registers, some wait in memory.
//
// Idea: in straight code the best victim is known (Belady, 1966): the value whose next reader is
// farthest away. It is stored once, to a slot of its own, and loaded before each reader that it is
// not there for. What can be made again cheaply is not stored at all but made again: a constant of
// an instruction, a load whose bytes are not written before the last reader, one step on such a
// load (a splat). Every such load is a new value, so the result is straight code again and can be
// scheduled like any other, its spills too.
//
//   gap p lies before instruction p; a value written by d and last read by u fills gaps d+1 .. u,
//   one that nothing reads gap d+1. What an instruction reads last leaves its register to what the
//   same instruction writes.
//
// Invariant: in no gap of the result are more values of a file live than it has registers.
//
// Source: L. A. Belady, "A study of replacement algorithms for a virtual-storage computer", 1966.
#pragma once

#include <string>
#include <vector>

#include "core/error.hpp"
#include "platform_sim/schedule/scheduling_core.hpp"
#include "platform_sim/schedule/straight_code.hpp"

namespace pelt {

struct FittedCode {
  StraightCode code;                  // its first values are those of the code it was made from
  std::vector<uint32_t> origin;       // of each instruction, as in FinishedCode
  std::vector<EntryValue> in_memory;  // there when the code begins, in their slots
  uint32_t spill_stores = 0, spill_loads = 0;
  uint32_t made_again = 0;  // instructions that run once more
};

// Refused when the code breaks its invariant, one instruction needs more registers than there are,
// or a file overflows that nothing spills.
Result<FittedCode> FitRegisters(const StraightCode& code, const SchedulingCore& core);

}  // namespace pelt
