// From straight code to code on a core's registers, two ways: in program order, as a compiler
// leaves it that does not schedule, and scheduled, as a good one or a hand would write it.
//
// Idea: first the code is made to fit the registers (fit_registers.hpp), with spills if it must;
// then it is ordered (list_schedule.hpp) with several windows, since a wide one hides latency and a
// narrow one saves registers. Iterations of a loop are tried side by side as well
// (interleave_iterations.hpp), fitted to fewer registers than there are. The best order by the
// core's own issue model wins, and program order is one of those that run.
//
// Invariant: a schedule never costs more cycles than program order, by the issue model.
// Deterministic: the same code gives the same instructions.
//
// Not modelled: instructions that must write the register they read (iohl, mpyhha; of VMX128's
// multiply-add the sum): each would cost a copy where the old value is still needed.
#pragma once

#include <optional>
#include <string>

#include "platform_sim/schedule/fit_registers.hpp"
#include "platform_sim/schedule/list_schedule.hpp"
#include "platform_sim/schedule/scheduling_core.hpp"
#include "platform_sim/schedule/straight_code.hpp"

namespace pelt {

// Nothing, and the reason in `error`, when the code breaks its invariant or cannot fit the
// registers.
std::optional<FinishedCode> TryAllocateInOrder(const StraightCode& code, const SchedulingCore& core,
                                               std::string& error);
std::optional<FinishedCode> TrySchedule(const StraightCode& code, const SchedulingCore& core,
                                        std::string& error);

// The same for `iterations` iterations of a loop, of which kIterationsTogether may be interleaved.
inline constexpr uint32_t kIterationsTogether = 2;
std::optional<FinishedCode> TryScheduleIterations(const StraightCode& code, uint32_t iterations,
                                             const SchedulingCore& core, std::string& error);

// The last step of both, for who brings an order of his own: registers and, where pairs go by
// address, padding. False, and the reason in `error`, when the order does not fit the registers.
bool TryFinish(const FittedCode& fitted, const IssueOrder& order, const SchedulingCore& core,
               FinishedCode& out, std::string& error);

}  // namespace pelt
