// What a scheduler and a register allocator need of a core: for each class its units, latency and
// what it blocks; how many issue in a cycle; how many registers each file has and what spills them.
//
// Idea: the SPU and the PPE family differ in numbers only. The SPU is a core of two units, one of
// each a cycle, whose pairs must lie in one fetch group, even-pipe one first; the PPE is one of
// five units, any two that share none.
//
// Invariant: these numbers only order code. What an order costs is always asked of the issue model
// of the core itself, `time`; a rule that is missing here makes a schedule worse, never a cycle
// count wrong.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/error.hpp"
#include "platform_sim/pipeline/issue_chart.hpp"
#include "platform_sim/platforms/ppe.hpp"
#include "platform_sim/platforms/spu.hpp"
#include "platform_sim/schedule/straight_code.hpp"

namespace pelt {

struct SchedulingCore {
  struct Class {
    uint8_t units = 0;                        // of one cycle, bits; two that go together share none
    uint32_t latency_cycles = 0;              // from issue to the issue of a reader
    uint32_t latency_into_branch_cycles = 0;  // the same, if the reader is a branch
    uint8_t blocks_units = 0;  // these take nothing for blocked_cycles from its issue
    uint32_t blocked_cycles = 0;
    bool is_branch = false;
    bool ends_cycle = false;  // nothing behind it goes in its cycle
  };
  struct File {
    uint32_t first = 0, count = 0;  // registers that code may use
    bool spills = false;            // false: nothing stores such a register
    uint8_t store_class = 0, load_class = 0;
    uint32_t slot_bytes = 0;
  };
  // Pairs by address: the second half of a fetch group goes with the first if the first's units are
  // `first_units` and its own are not.
  struct FetchGroups {
    uint32_t bytes = 0;
    uint8_t first_units = 0;
    uint8_t first_padding_class = 0, second_padding_class = 0;
  };
  // `held_class` does not issue in the `cycles` cycles behind one of `behind_class`.
  struct Hold {
    uint8_t behind_class = 0, held_class = 0;
    uint32_t cycles = 0;
  };

  std::vector<Class> classes;
  std::array<File, kValueFileCount> files;  // by ValueFile
  uint32_t width = 2;                       // instructions per cycle
  uint32_t instruction_bytes = 4;
  uint32_t store_to_load_cycles = 1;  // from a store to a load of what it wrote
  Hold hold;
  std::optional<FetchGroups> fetch_groups;
  // The real issue model on code without loops.
  std::function<Result<IssueChart>(Program)> time;

  const File& Of(ValueFile file) const { return files[uint32_t(file)]; }
};

// Registers that code cannot use: $0 and $1, by the SPU's calling conventions the link register and
// the stack pointer. (What addresses blocks of data is a value of the code itself, or absolute.)
inline constexpr uint32_t kSpuReservedRegisters = 2;
// r0 (no register where it is a base), r1 (stack), r2 (table of contents), r13 (thread).
inline constexpr uint32_t kPpeReservedRegisters = 4;

// More registers in a file than this are not used.
inline constexpr uint32_t kMostSchedulingRegisters = 4096;

SchedulingCore SpuForScheduling(const SpuParameters& spu);
// One hardware thread, the other one silent. Vector registers as `ppe` says: 32, or a Xenon's 128.
SchedulingCore PpeForScheduling(const PpeParameters& ppe);

// The fewest cycles in which the core can issue `program`, regardless of its dependences: what its
// busiest unit needs, or its width.
int64_t ResourceBoundCycles(Program program, const SchedulingCore& core);

}  // namespace pelt
