// Puts iterations of a loop side by side: what a hand does that unrolls a loop of long chains twice
// and writes the two copies as one, instruction by instruction.
//
// Idea: a scheduler that goes through iteration after iteration has to run far ahead to find work
// of another one, and what it finds there first are loads, which fill the registers long before
// anything reads them. Code in which the iterations lie beside each other has its work near by, and
// the register allocator sees what that takes.
//
//   key of an instruction = (group of its iteration, how far into it the instruction is, iteration)
//
// The order is topological in the dependences: the least key of what is ready goes next. What waits
// for nothing in a register that another instruction writes (a load of a row, a constant) goes just
// before its first reader.
//
// An iteration ends where the fewest values are alive near the place where it should, were all of
// one length. A wrong end makes code slower, never wrong.
#pragma once

#include <cstdint>
#include <vector>

#include "platform_sim/schedule/scheduling_core.hpp"
#include "platform_sim/schedule/straight_code.hpp"

namespace pelt {

struct InterleavedCode {
  StraightCode code;             // the same values
  std::vector<uint32_t> origin;  // of each instruction, in the code it was made from
};

// `code` has `iterations` iterations; `together` of them are put side by side, 1 or more.
InterleavedCode InterleaveIterations(const StraightCode& code, uint32_t iterations,
                                     uint32_t together, const SchedulingCore& core);

}  // namespace pelt
