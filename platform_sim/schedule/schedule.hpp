// From straight code to code on a core's registers, two ways: in program order, as a compiler
// leaves it that does not schedule, and scheduled, as a good one or a hand would write it.
//
// Idea: first the code is made to fit the registers (fit_registers.hpp), with spills if it must;
// then it is ordered (list_schedule.hpp) with several windows, since a wide one hides latency and a
// narrow one saves registers. Iterations of a loop are tried side by side as well,
// fitted to fewer registers than there are. The best order by the
// core's own issue model wins, and program order is one of those that run.
//
// Invariant: a schedule never costs more cycles than program order, by the issue model.
// Deterministic: the same code gives the same instructions.
//
// Not modelled: instructions that must write the register they read (iohl, mpyhha; of VMX128's
// multiply-add the sum): each would cost a copy where the old value is still needed.
#pragma once

#include "core/error.hpp"
#include "platform_sim/schedule/fit_registers.hpp"
#include "platform_sim/schedule/list_schedule.hpp"
#include "platform_sim/schedule/scheduling_core.hpp"
#include "platform_sim/schedule/straight_code.hpp"

namespace pelt {

// Refused when the code breaks its invariant or cannot fit the registers.
Result<FinishedCode> AllocateInOrder(const StraightCode& code, const SchedulingCore& core);
Result<FinishedCode> Schedule(const StraightCode& code, const SchedulingCore& core);

// The same for `iterations` iterations of a loop, of which kIterationsTogether may be interleaved.
inline constexpr uint32_t kIterationsTogether = 2;
Result<FinishedCode> ScheduleIterations(const StraightCode& code, uint32_t iterations,
                                        const SchedulingCore& core);

// The last step of both, for who brings an order of his own: registers and, where pairs go by
// address, padding. Refused when the order does not fit the registers.
Result<FinishedCode> Finish(const FittedCode& fitted, const IssueOrder& order,
                            const SchedulingCore& core);

}  // namespace pelt
