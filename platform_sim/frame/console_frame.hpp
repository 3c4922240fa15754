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
#include "platform_sim/platforms/cell.hpp"
#include "platform_sim/pricing/stage_costs.hpp"

namespace pelt {

// What of an item's blocks is moved. Plans give stages whole blocks, and that is how an item is executed, so its bits
// stay; a console's programmer moves less of them:
//
//   live prefix        of rows, only the lanes that live
//   resident palette   a unit with a store keeps what items of a character read of it (its joints' matrices) from
//                      item to item, until it runs another pass
//
// All that is timed from there on is of what is moved.

// `bytes`, in `elements` pieces of a list and `lines` lines.
struct MovedPieces {
  uint64_t bytes;
  uint32_t elements, lines;
};

class MovedData {
 public:
  explicit MovedData(const ConsoleMachine& machine);

  void BeginFrame();
  // Of what `unit` has just run, `work` with whole blocks.
  void Apply(const Frame& frame, uint32_t unit, uint32_t pass, uint32_t item, ItemWork& work);

 private:
  void DropResident(const Frame& frame, uint32_t unit, Domain domain, uint32_t item,
                    ItemWork& work);
  void MoveLivePrefix(const Frame& frame, Domain domain, uint32_t item, ItemWork& work) const;
  // Of a block that is moved as it lies.
  MovedPieces Whole(uint64_t bytes) const;
  // `shape` moves `is` in place of `was`.
  void Replace(const MovedPieces& was, const MovedPieces& is, TransferShape& shape) const;

  const uint32_t line_bytes_, largest_bytes_;
  const bool has_stores_;
  struct Held {
    uint32_t pass = kNoBlock;
    std::vector<uint32_t> character;  // [stream]; kNoBlock: none's
  };
  std::vector<Held> held_;  // [unit]
};

// Does a program fit into an SPU's local store? Code, stack, resident data and the DMA buffers
// share it; a second buffer hides the transfers and takes the same again.

struct LocalStoreUse {
  uint64_t code_bytes = 0;
  uint64_t stack_bytes = 0;
  uint64_t data_bytes = 0;    // resident: parameters, tables
  uint64_t buffer_bytes = 0;  // one set
  uint32_t buffer_sets = 2;

  uint64_t Bytes() const {
    return code_bytes + stack_bytes + data_bytes + buffer_bytes * buffer_sets;
  }
};

// False, and in `error` by how much and what of, when it does not fit. `free_bytes`: what is left.
bool FitsLocalStore(const CellMemoryParameters& p, const LocalStoreUse& use, uint64_t& free_bytes,
                    std::string& error);

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
