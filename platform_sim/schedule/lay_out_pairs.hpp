// Dual-issue alignment: puts code that was scheduled by cycles where a core that pairs by address
// finds its pairs.
//
//   cycle   8   9  10  10  11        fetch groups   | 8    9   |      two alone
//                                                   | 10   10  |      a pair
//                                                   | 11   ..
//
// Instructions that go alone fill groups among themselves, which costs nothing: each would take a
// cycle anyway. Only when a pair comes in the middle of a group, the one before it gets a nop or
// lnop beside it, in its own cycle.
#pragma once

#include "platform_sim/schedule/list_schedule.hpp"

namespace pelt {

// `code`: as AssignRegisters made it in the order of `order`. Adds padding and sets locations.
void LayOutPairs(const IssueOrder& order, const SchedulingCore& core, FinishedCode& code);

}  // namespace pelt
