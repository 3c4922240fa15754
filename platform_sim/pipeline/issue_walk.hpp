// Runs a program through an in-order core: follows its branches, counts the iterations of its
// loops, and once a loop's state comes back leaps over the iterations that are left.
//
// Idea: an in-order core's future depends only on what is under way: results, hints, stores and the
// place in a fetch group. When that state at the end of an iteration is one that was there before,
// all that follows repeats, and the rest of the trip count is a multiplication: exact, and a loop
// of a million iterations costs a few.
//
// Rules of the walk: a backward branch closes a loop, which runs as often as its trip count says; a
// forward branch that has a condition falls through; calls are not followed. What a condition
// computes is not known here.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "platform_sim/pipeline/instruction.hpp"
#include "platform_sim/pipeline/issue_chart.hpp"

namespace pelt {

// The rules and the state of one core. All cycles count from the run's beginning.
class IssueModel {
 public:
  virtual ~IssueModel() = default;
  // The next instruction in order. `taken`: it branches; the next one is then its target.
  virtual IssueSlot Issue(const Instruction& instruction, uint32_t index, bool taken) = 0;
  // How long `pipe` (of the slot) is busy with it.
  virtual uint32_t BusyCycles(const Instruction& instruction, uint32_t pipe) const = 0;
  // All that the future depends on, relative to now. Equal states have equal futures.
  virtual void AppendState(std::vector<int64_t>& state) const = 0;
  // Moves all that is under way by so many cycles.
  virtual void Leap(int64_t cycles) = 0;
  virtual uint32_t PipeCount() const = 0;
};

// Iterations of a loop whose trip count was not given.
inline constexpr uint64_t kAssumedIterations = 1000;
// The most iterations of one loop.
inline constexpr uint64_t kMaxIterations = 1'000'000'000'000;

// The most registers (or values) a program may number.
inline constexpr uint32_t kMaxRegisters = 1u << 22;

// Whether classes are below `class_count`, and registers and targets are ones that can be.
bool CheckProgram(Program program, uint32_t class_count, std::string& error);

// One more than the highest register; the program passed CheckProgram.
uint32_t RegisterEnd(Program program);

// Fills first_pass, loops and totals of `chart`. False, and the reason in `error` ("instruction 4:
// ..."), when the program cannot be run.
bool RunWalk(Program program, std::span<const TripCount> trips, IssueModel& model,
             IssueChart& chart, std::string& error);

// The backward branches' targets, in order: what a trip count can be given for.
std::vector<uint32_t> LoopHeads(Program program);

// The most registers that hold a value still needed, of `count` from `first` on, at any place of
// the program, for any way that its branches go.
uint32_t MostLiveRegisters(Program program, uint32_t first, uint32_t count);

}  // namespace pelt
