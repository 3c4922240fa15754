// Orders straight code for a core, a topological order of its dependences: cycle by cycle, the most
// urgent instruction that is ready, has its units free and fits the registers.
//
// Idea: code of several lane groups, one behind the other, becomes a software pipeline by itself.
// Work of younger groups fills what an older one leaves free, and how far it runs ahead is bounded
// twice: by a window that begins at the oldest instruction that has not issued, and by the
// registers (RegisterGuard). Urgency is the instruction's turn, if all went at the resources'
// pace, less the cycles that still hang on it:
//
//   urgency = turn x pace - height        lowest first; equal: program order
//
// so an older lane group goes first, and a chain's beginning before work that nothing waits for.
//
// Source: list scheduling as in any compiler book; the window, as an out-of-order machine has one.
#pragma once

#include <cstdint>
#include <vector>

#include "platform_sim/schedule/dependence_graph.hpp"
#include "platform_sim/schedule/scheduling_core.hpp"

namespace pelt {

// Instructions in the order they issue in, and when they should, by the scheduler's own count.
struct IssueOrder {
  std::vector<uint32_t> instruction;
  std::vector<int64_t> cycle;

  int64_t cycles() const { return cycle.empty() ? 0 : cycle.back() + 1; }
};

// Straight code that fits the core's registers, and what all its schedules share.
struct ScheduleInput {
  ScheduleInput(const StraightCode& fitted_code, const SchedulingCore& for_core);

  const StraightCode& code;
  const SchedulingCore& core;
  const ValueUses uses;
  const DependenceGraph graph;
  const std::vector<uint32_t> by_urgency;  // most urgent first
};

// `window`: how far behind the oldest one an instruction may be, 1 or more.
IssueOrder ScheduleWithin(uint32_t window, const ScheduleInput& input);

}  // namespace pelt
