// Two loops on the PPE's two hardware threads, each with a mix of its own: how fast each goes.
//
// Idea: a cycle's dispatch, one or two instructions, is one thread's. Who could dispatch earlier
// does; when both could, the one that did not dispatch last. So two threads that never wait have
// every other cycle each, and what a thread waits for (a result, a divide, a branch) is the other's
// to use. Instructions that are not pipelined block their unit for both threads (GCC: "stall point").
// Source: CBE handbook as quoted by cellmark (one thread a cycle, alternating); that a cycle which
// its thread cannot use goes to the other is how this model reads "stall only one thread" (GCC,
// IB2), class L: no measured pair distinguishes it from strict alternation.
//
// Not modelled: caches. Both threads hit L1 throughout; what a miss of one leaves to the other is
// not in it.
//
// Exact, as with one thread, when the state of both comes back: the rates are those of the period.
// Where it takes too long to (long loops without a common divisor), they are the mean of many
// iterations.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "core/error.hpp"
#include "platform_sim/pipeline/instruction.hpp"
#include "platform_sim/platforms/ppe.hpp"

namespace pelt {

struct PpePairTiming {
  bool steady = false;  // false: not a period, but a long stretch
  int64_t period_cycles = 0;
  std::array<uint64_t, 2> period_iterations{};

  double CyclesPerIteration(uint32_t thread) const {
    return double(period_cycles) / double(period_iterations[thread]);
  }
};

// Each program has one loop, which runs for ever; what lies before and behind it does not run.
// Forward branches are as in issue_walk.hpp. Others are refused.
Result<PpePairTiming> TimePpePair(const std::array<Program, 2>& programs, const PpeParameters& ppe);

}  // namespace pelt
