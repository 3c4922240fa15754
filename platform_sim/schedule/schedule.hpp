// From straight code to code on a core's registers, two ways: in program order, as a compiler
// leaves it that does not schedule, and scheduled, as a good one or a hand would write it.
//
// Idea: first the code is made to fit the registers (FitRegisters), with spills if it must; then it is ordered
// (ScheduleWithin) with several windows, since a wide one hides latency and a narrow one saves registers. Iterations of
// a loop are tried side by side as well, fitted to fewer registers than there are. The best order by the core's own
// issue model wins, and program order is one of those that run.
//
// Invariant: a schedule never costs more cycles than program order, by the issue model.
// Deterministic: the same code gives the same instructions.
//
// Not modelled: instructions that must write the register they read (iohl, mpyhha; of VMX128's
// multiply-add the sum): each would cost a copy where the old value is still needed.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/error.hpp"
#include "platform_sim/schedule/scheduling_core.hpp"
#include "platform_sim/schedule/straight_code.hpp"

namespace pelt {

// ---- Registers ------------------------------------------------------------------------------
//
// Makes straight code fit a core's registers, program order kept: where more values are live than a
// file has registers, some wait in memory.
//
// Idea: in straight code the best victim is known (Belady, 1966): the value whose next reader is
// farthest away. It is stored once, to a slot of its own, and loaded before each reader that it is
// not there for. What can be made again cheaply is not stored at all but made again: a constant of
// an instruction, a load whose bytes are not written before the last reader, one step on such a
// load (a splat). Every such load is a new value, so the result is straight code again and can be
// scheduled like any other, its spills too.
//
//   gap p lies before instruction p; a value written by d and last read by u fills gaps d+1 .. u,
//   one that nothing reads gap d+1. What an instruction reads last leaves its register to what the
//   same instruction writes.
//
// Invariant: in no gap of the result are more values of a file live than it has registers.
//
// Source: L. A. Belady, "A study of replacement algorithms for a virtual-storage computer", 1966.

struct FittedCode {
  StraightCode code;                  // its first values are those of the code it was made from
  std::vector<uint32_t> origin;       // of each instruction, as in FinishedCode
  std::vector<EntryValue> in_memory;  // there when the code begins, in their slots
  uint32_t spill_stores = 0, spill_loads = 0;
  uint32_t made_again = 0;  // instructions that run once more
};

// Refused when the code breaks its invariant, one instruction needs more registers than there are,
// or a file overflows that nothing spills.
Result<FittedCode> FitRegisters(const StraightCode& code, const SchedulingCore& core);

// ---- Dependences ----------------------------------------------------------------------------
//
// What must come before what in straight code, and by how many cycles.
//
// Edges, all forward in program order: from a value's writer to its readers, by latency; between
// accesses to the same bytes when one is a store, a load behind a store as late as the core says;
// from each branch to the next and to the stores behind it. Loads among themselves are free, and so
// is all that raises nothing.
//
// Bytes are looked at in words of four: accesses that share a word and no byte are kept in order
// too, which the rules would not need.

class DependenceGraph {
 public:
  struct Edge {
    uint32_t to;
    uint32_t cycles;  // at least, from issue to issue
  };

  DependenceGraph(const StraightCode& code, const ValueUses& uses, const SchedulingCore& core);

  uint32_t size() const { return uint32_t(height_.size()); }
  std::span<const Edge> After(uint32_t instruction) const {
    return std::span(edges_).subspan(first_[instruction],
                                     first_[instruction + 1] - first_[instruction]);
  }
  uint32_t EdgesInto(uint32_t instruction) const { return edges_into_[instruction]; }
  // Cycles from its issue to the issue of the last instruction that waits for it.
  uint32_t Height(uint32_t instruction) const { return height_[instruction]; }

 private:
  std::vector<uint32_t> first_;
  std::vector<Edge> edges_;
  std::vector<uint32_t> edges_into_, height_;
};

// ---- Order ----------------------------------------------------------------------------------
//
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

// ---- All of it ------------------------------------------------------------------------------

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
