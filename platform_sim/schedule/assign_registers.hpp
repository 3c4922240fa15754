// Gives the values of straight code registers, in the order that it is to run in.
//
// Idea: in straight code the lives of values are intervals, so whenever no more of them overlap
// than there are registers, handing out a free one at each write never fails. Free registers wait
// in a queue: the one that was free for longest goes first, so that a reused register's last result
// is long out of the pipeline.
#pragma once

#include <span>
#include <string>

#include "core/error.hpp"
#include "platform_sim/schedule/fit_registers.hpp"

namespace pelt {

// One instruction behind the other, without padding. `order`: every instruction of `fitted` once;
// one that does not fit the registers is refused.
Result<FinishedCode> AssignRegisters(const FittedCode& fitted, std::span<const uint32_t> order,
                                     const SchedulingCore& core);

}  // namespace pelt
