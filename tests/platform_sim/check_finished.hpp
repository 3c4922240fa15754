// Whether finished code does what the straight code it was made from does: run without numbers,
// every register and spill slot holding the name of a value.
//
// Checked: every instruction is there once, or more often if it only makes a value; each reads,
// operand by operand, the value it should, and writes registers of the right file; a spill slot
// holds what is loaded from it and nothing else; every byte is loaded and overwritten behind
// the same store as in the straight code; no store is ahead of a branch that it was behind; padding
// has no operands; locations follow on each other; the counts are right. Not checked: cycles.
//
// It shares nothing with what made the code.
#pragma once

#include <string>

#include "platform_sim/schedule/scheduling_core.hpp"
#include "platform_sim/schedule/straight_code.hpp"

namespace pelt {

// False, and the first fault in `error` ("instruction 7: ..."); instructions are counted in the
// finished code.
bool CheckFinishedCode(const StraightCode& code, const FinishedCode& finished,
                       const SchedulingCore& core, std::string& error);

}  // namespace pelt
