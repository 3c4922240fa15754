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
// That is what a thread has beside one that never waits; two listings beside each other:
// ppe_pair.hpp.
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

#include <optional>
#include <span>
#include <string>

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

}  // namespace pelt
