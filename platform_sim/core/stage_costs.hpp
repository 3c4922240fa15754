// What the stages of a plan cost on a core: the kernels' own source, recorded, expanded into the
// core's instructions and scheduled (kernel_cost.hpp), once for each kind of work, and the number of
// recorded operations of every item.
//
// cycles of an item = cycles per operation of its kind x operations per turn of that item x turns
//
// A turn is one vector of four lanes. Turns follow the run: an item that lives with half its
// strands has half the turns. Items of a coarser domain have one turn.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "jobs/frame.hpp"
#include "platform_sim/memory/event_queue.hpp"

namespace pelt {

struct StageCosts {
  struct Stage {
    std::string_view name;
    uint32_t code_bytes = 0;  // of its loop as scheduled, unrolled as far as it was
    // Of each item of the stage's domain; 0 where the stage never runs. One hardware thread alone.
    std::vector<float> cycles_per_turn;
    // The same while the core's other hardware thread runs too (a core without: the same).
    std::vector<float> shared_cycles_per_turn;
    // Cycles that do not grow with turns: the call, its set-up, filling and draining the pipeline.
    float fixed_cycles = 0.0f;
  };
  std::vector<Stage> stages;  // as in the plan
  uint64_t clock_hz = 0;
};

// Turns of `stage` on `item` as the frame stands now: live lanes of what it writes, in fours,
// rounded up; visible lanes of what it sorts. 0: none of its lanes live.
uint32_t CountTurns(const Frame& frame, uint32_t stage, uint32_t item);

}  // namespace pelt
