// Runs an item of a frame for real, as a console would, and says what it asked of the console.
//
// Every unit of a Cell has a poisoned local store of its own; threads of a Xenon run in main
// memory, behind one L2. Work counts are those of the run: each stage's, just before it runs.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "jobs/frame.hpp"
#include "platform_sim/frame/console_machine.hpp"
#include "platform_sim/frame/item_work.hpp"
#include "platform_sim/local_store.hpp"
#include "platform_sim/pricing/stage_costs.hpp"

namespace pelt {

class ItemRunner {
 public:
  virtual ~ItemRunner() = default;
  // `work` is cleared first.
  virtual void Run(const Frame& frame, uint32_t unit, uint32_t pass, uint32_t item,
                   ItemWork& work) = 0;
  // Of the local stores.
  virtual std::vector<LocalStoreFault> Faults() const { return {}; }
};

// `costs` must outlive it.
std::unique_ptr<ItemRunner> MakeLocalStoreRunner(const ConsoleMachine& machine,
                                                 const StageCosts& costs);
std::unique_ptr<ItemRunner> MakeCacheRunner(const ConsoleMachine& machine, const StageCosts& costs,
                                            const FrameMemory& memory);

// What a stage takes on an item that is about to run it.
ItemWork::StageTime TimeStage(const StageCosts& costs, const Frame& frame, uint32_t stage,
                              uint32_t item);

}  // namespace pelt
