// The dispatch of the PPE and its family: in order, two a cycle, one unit of each kind.
//
// Idea: an instruction takes the units its class names (a vector load: load/store and VSU2). Two go
// in one cycle if they share no unit and both are ready; behind a branch, a multiply or a divide
// none does (they take the younger slot, GCC). What a result costs depends on who reads it: 2
// cycles into arithmetic, but 5 into an address, which is what a pointer chase pays. Multiply and
// divide are not pipelined. A load whose address (the same base and index registers, unchanged, and
// overlapping offsets) a store wrote less than 40 cycles ago waits for that store to get out.
//
// With SMT the two threads alternate, one cycle each: this thread dispatches in every other one.
// That is what a thread has beside one that never waits; two listings beside each other: TimePpePair.
//
// Source: platforms/ppe.hpp. If ignored: float-to-int through memory looks free and costs 40
// cycles.
//
// Not modelled: caches (every access hits L1), the branch predictor (a loop's branch is foretold
// but for its last iteration), microcoded forms, the rule that a result must not be overwritten
// while another unit still writes it, that the two of a group lie in one aligned 8 bytes (GCC: code
// is taken to be padded so), and of the other thread anything but the cycles it takes: it always
// has something to dispatch, and its divides do not hold this one.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "core/error.hpp"
#include "platform_sim/pipeline/issue_chart.hpp"
#include "platform_sim/platforms/ppe.hpp"

namespace pelt {

struct PpeRules {
  bool smt = false;  // the other hardware thread runs too
};

// Every op_class of the program is a PpeClass, registers are numbered as instruction_set.hpp says.
// A program that cannot be run is refused.
Result<IssueChart> TimeOnPpe(Program program, std::span<const TripCount> trips,
                             const PpeRules& rules, const PpeParameters& ppe);

// ---- Two threads --------------------------------------------------------------------------------
//
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
