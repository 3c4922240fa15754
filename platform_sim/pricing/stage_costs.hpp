// What the stages of a plan cost on a core: the kernels' own source, recorded, expanded into the
// core's instructions and scheduled (kernel_cost.hpp), once for each kind of work, and the number
// of recorded operations of every item.
//
//   cycles of an item = cycles per operation of its kind x operations per iteration of that item
//                       x iterations
//
// An iteration is one vector of four lanes. Iterations follow the run: an item that lives with half
// its strands has half the iterations. Items of a coarser domain have one iteration, but for a
// layer's stage that writes lanes of all its chunks (a sort), which has those of the live ones.
//
// A kind of work is what the recording shows: a stage's items whose iterations are made of the same
// kinds of operations and are of about the same length (a quarter apart at most). Solver
// iterations, clumping, culling, a restart each make a kind of their own, without a list of them
// here.
//
// Not seen by the recording are scalars outside sorting. A stage that is nothing else (select_lod,
// activate, collect_changes, most of order_layers) is charged by a rule: every word of the small
// blocks it is bound to (kSmallBlockBytes or less) is loaded and used once, one after the other.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.hpp"
#include "jobs/frame.hpp"
#include "platform_sim/pricing/kernel_cost.hpp"

namespace pelt {

struct StageCosts {
  struct Stage {
    std::string_view name;
    uint32_t code_bytes = 0;  // of its loop as scheduled, unrolled as far as it was
    // Ordered one way, of each item of the stage's domain; 0 where the stage never runs.
    struct Price {
      std::vector<float> cycles_per_iteration;         // one hardware thread alone
      std::vector<float> shared_cycles_per_iteration;  // while the core's other one runs too
      // Cycles that do not grow with iterations: the call, its set-up, filling and draining the
      // pipeline.
      float fixed_cycles = 0.0f;
    };
    Price as_written, scheduled;  // what code reaches lies between
    // One for each kind of work that was found, the first item of it.
    std::vector<KernelCost> kinds;
  };
  std::vector<Stage> stages;  // as in the plan
  uint64_t clock_hz = 0;
};

inline constexpr uint32_t kSmallBlockBytes = 512;

// Iterations of `stage` on `item` as the frame stands now: the most live lanes of what it writes,
// in fours, as the kernel rounds them; all lanes of what it scatters. 0: none of its lanes live.
uint32_t CountIterations(const Frame& frame, uint32_t stage, uint32_t item);

// Prices a frame that has been begun, with every skip off so that every stage wants to run, by
// running it on recording kernels (record_stage.hpp): it is run afterwards. Refused
// when a stage cannot be recorded or does not fit the core's registers. `known`: of this core and these rules.
Result<StageCosts> PriceStages(const Frame& frame, std::span<const KernelDesc> kernels,
                               const PricedCore& core, const PriceRules& rules,
                               KnownPrices* known = nullptr);

}  // namespace pelt
