// What a core model finds: when each instruction issues, why not earlier, what an iteration of each
// loop costs and what binds it. The same for every core, so that reports and searches read one
// thing.
//
// Invariant: every cycle is accounted for once: cycles = cycles in which something issued + stall
// cycles, and the stalls are split by cause. All counts are whole cycles.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "platform_sim/pipeline/instruction.hpp"

namespace pelt {

enum class StallCause : uint8_t {
  kRegister,      // a result is not there yet
  kBranch,        // the front end starts again behind a mispredicted branch
  kBlocked,       // an instruction that is not pipelined holds the core
  kAfterFp7,      // an FP6 right after an FP7
  kLoadHitStore,  // a load finds its address in a store that is under way
  kOtherThread,   // the cycle is the other hardware thread's
  kHintTarget,    // a hinted branch came before its target was fetched
};
inline constexpr uint32_t kStallCauseCount = 7;
std::string_view StallCauseName(StallCause cause);

// Why an instruction does not issue together with the one before it.
enum class Unpaired : uint8_t {
  kPaired,    // it does
  kFirst,     // nothing to pair with: behind a pair, or at the beginning of a fetch group
  kPipe,      // both need the same pipe or unit, or the odd pipe's comes first
  kAddress,   // not in one fetch group
  kNotReady,  // waits for something
  kNever,     // one of the two never pairs
};
inline constexpr uint32_t kUnpairedCount = 6;
std::string_view UnpairedName(Unpaired reason);

struct Stall {
  StallCause cause;
  uint32_t cycles;
  uint32_t reg = kNoRegister;  // for kRegister
};

struct IssueSlot {
  uint32_t instruction;
  int64_t cycle;
  uint8_t pipe;  // of the core: SpuPipe, or the first unit of PpeUnit
  Unpaired unpaired;
  uint8_t stall_count = 0;
  std::array<Stall, 5> stalls{};

  // There is a place for each cause that a core has; a cause that goes on is one stall.
  void AddStall(Stall stall) {
    Stall* last = stall_count > 0 ? &stalls[stall_count - 1u] : nullptr;
    if (last && last->cause == stall.cause && last->reg == stall.reg)
      last->cycles += stall.cycles;
    else if (stall_count < stalls.size())
      stalls[stall_count++] = stall;
  }
  void WaitUntil(int64_t until, StallCause cause, uint32_t reg = kNoRegister) {
    if (until <= cycle) return;
    AddStall({cause, uint32_t(until - cycle), reg});
    cycle = until;
  }
  // It had to wait, so it goes alone, a cycle of its own after the first: that cycle is no stall.
  void GiveUpPair() {
    unpaired = Unpaired::kNotReady;
    for (uint32_t s = 0; s < stall_count; ++s)
      if (stalls[s].cycles > 0) {
        --stalls[s].cycles;
        return;
      }
  }
};

inline constexpr uint32_t kMaxPipes = 5;

struct IssueTotals {
  int64_t cycles = 0;  // of issue: from the first instruction's to the last one's
  uint64_t instructions = 0;
  uint64_t dual_issues = 0;  // cycles in which two issue
  std::array<uint64_t, kStallCauseCount> stall_cycles{};
  std::array<uint64_t, kUnpairedCount> unpaired{};
  std::array<uint64_t, kMaxPipes> pipe_cycles{};  // in which the pipe was busy

  uint64_t AllStallCycles() const;
  uint64_t IssueCycles() const { return instructions - dual_issues; }
  // Part of the issuing cycles in which two issue.
  double DualIssueRate() const;

  IssueTotals& operator+=(const IssueTotals& other);
  IssueTotals& operator-=(const IssueTotals& other);
};
IssueTotals operator*(IssueTotals totals, uint64_t times);

// A loop at its steady state: the core's state comes back after `period_iterations`,
// `period_cycles` later, so this is exact for every further iteration.
struct LoopTiming {
  uint32_t head, branch;            // instructions
  uint64_t iterations = 0;          // of the first time it ran
  bool iterations_assumed = false;  // no trip count was given
  bool steady = false;              // false: it ended before
  uint64_t period_iterations = 0;
  int64_t period_cycles = 0;
  IssueTotals period{};            // what happens in it
  std::vector<IssueSlot> slots{};  // of the last iteration in it; cycles from the iteration's first

  double CyclesPerIteration() const { return double(period_cycles) / double(period_iterations); }
};

struct LiveRegisters {
  std::string_view file;
  uint32_t most, limit;
};

struct IssueChart {
  std::vector<std::string_view> pipes;  // names, by IssueSlot::pipe
  std::vector<IssueSlot> first_pass;    // until the first instruction that comes a second time
  IssueTotals first_pass_totals;
  std::vector<LoopTiming> loops;
  IssueTotals totals;  // of the whole run, every iteration
  std::vector<LiveRegisters> live;
};

// What takes the most cycles: "even pipe", "register", "branch" ...
std::string_view BindingResource(const IssueChart& chart, const IssueTotals& totals);

}  // namespace pelt
