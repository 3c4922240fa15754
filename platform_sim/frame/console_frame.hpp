// A frame of the real plan on a console, in the console's time.
//
// The frame is executed for real while it is timed: an item runs when a unit draws it, in the
// unit's own poisoned local store on a Cell, in main memory on a Xenon; so gates see what ran, work
// counts are those of the run, and the digests must be the host's. When things happen is
// frame_clock.hpp's matter, what they cost stage_costs.hpp's, what the console is
// console_machine.hpp's.
//
// Times are whole cycles of the console's clock; a frame begins at cycle 0. Two runs of one frame
// give the same cycles.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/error.hpp"
#include "jobs/frame.hpp"
#include "platform_sim/frame/console_machine.hpp"
#include "platform_sim/frame/item_work.hpp"
#include "platform_sim/frame/modelled_frame.hpp"
#include "platform_sim/local_store.hpp"
#include "platform_sim/pricing/stage_costs.hpp"

namespace pelt {

// What a pass of the plan takes of a local store. `code_bytes` has the loop over items in it.
struct PassStore {
  uint64_t code_bytes = 0, stack_bytes = 0, parameter_bytes = 0;
  uint64_t buffer_bytes = 0;  // one set
  uint32_t buffer_sets = 1;
  uint64_t free_bytes = 0;
};

// Runs frames on a console. One frame's result stays until the next.
class ConsoleExecutor final : public Executor {
 public:
  // Refused when code, stack and buffers of a pass do not fit the local store, the costs are of
  // another plan or clock, or the machine cannot be. Frames that are run must be of this one's plan
  // and memory.
  static Result<std::unique_ptr<ConsoleExecutor>> Make(const ConsoleMachine& machine,
                                                       const StageCosts& costs, const Frame& frame);
  ~ConsoleExecutor() override;

  void KeepTimelines(bool keep);

  const ConsoleMachine& machine() const;
  const ModelledFrame& modelled() const;
  // Of the last frame: to time it again on another machine (TimeFrame, frame_clock.hpp).
  const FrameWork& work() const;
  // [pass]; empty on caches.
  const std::vector<PassStore>& stores() const;
  // Of the local stores; empty on caches.
  std::vector<LocalStoreFault> faults() const;

 private:
  void RunPasses(const Frame& frame) override;

  struct State;
  explicit ConsoleExecutor(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace pelt
