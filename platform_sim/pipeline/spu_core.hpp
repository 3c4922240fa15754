// The SPU's issue: in order, two at a time, by its class table.
//
// Idea: because it is in order, one instruction after the other can be given its cycle:
//
//   fetch group (8 bytes)   | even-pipe op , odd-pipe op |   both ready: one cycle
//                           | anything else              |   the second waits, at least a cycle;
//                                                            no new group until both are out
//
// An instruction issues when its group's turn has come, what it reads is ready (a class's latency
// after its writer's issue), and no rule holds it: double precision stops both pipes for 6 cycles
// and never pairs, an FP6 right after an FP7 loses one, and a branch that goes elsewhere than the
// front end thought costs 18. The front end thinks that branches fall through, but for the one that
// the last hint named. It has the hint's target 15 cycles after the hint: a branch that comes
// earlier waits for it ("stall due to waiting for hint target" of IBM's simulator, SDK tutorial);
// one with fewer than 8 instructions between the hint and itself is fetched before the hint is seen
// (GCC).
//
// Source: platforms/spu.hpp. If ignored: an estimate on the wrong pipe alone is 15 % of a Newton
// step (row C5); pairing without addresses hides what .align is for.
//
// Not modelled: instruction fetch from the local store and its contention with DMA, and with loads
// and stores in every cycle of 16 or more (GCC keeps a cycle free there); what sync, stop and a
// channel that is not ready wait for. Loads and stores depend on each other by registers only: the
// SPU does them in order, so that is exact.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "core/error.hpp"
#include "platform_sim/pipeline/issue_chart.hpp"
#include "platform_sim/platforms/spu.hpp"

namespace pelt {

struct SpuRules {
  // Any even-pipe instruction pairs with an odd-pipe one behind it, wherever they lie: what the
  // vendor's published static tool prints.
  bool pair_by_order = false;
  // Every branch as if it were hinted in time.
  bool branches_hinted = false;
};

// Every op_class of the program is an SpuClass. A program that cannot be run is refused.
Result<IssueChart> TimeOnSpu(Program program, std::span<const TripCount> trips,
                             const SpuRules& rules, const SpuParameters& spu);

}  // namespace pelt
