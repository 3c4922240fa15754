// The Cell's memory as its SPUs see it: one MFC per SPU, the bus and the memory behind them.
//
//   SPU --channels--> queue (16) --take up, in order--> lines (16 in flight) --snoop--> EIB, memory
//
// A command waits in its MFC's queue; the MFC takes commands up one after another (a fenced one
// lets others pass until its turn), cuts each into lines and keeps at most so many in flight. A
// line's command is snooped, its data crosses the bus, memory serves it. Latency, Little's law,
// waste of small and of badly aligned commands, sharing and contention come out of that; none is a
// rule.
//
// Invariant: every submitted command completes, once, and the lines counted at the bus are the sum
// of the commands' lines. Everything happens on the caller's EventQueue, so a frame model can put
// its own events beside these.
//
// Not modelled: TLB misses, the proxy queue of the PPE, the SPU's own loads and stores delaying DMA
// in the local store (at most one cycle in sixteen), data: only addresses and sizes move here.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "core/error.hpp"
#include "platform_sim/memory/bus.hpp"
#include "platform_sim/memory/dma_command.hpp"
#include "platform_sim/memory/event_queue.hpp"
#include "platform_sim/memory/memory_controller.hpp"

namespace pelt {

struct DmaCounts {
  uint64_t commands = 0;
  uint64_t list_elements = 0;
  uint64_t get_bytes = 0, put_bytes = 0;  // as asked for
  uint64_t lines = 0;                     // moved for them
  uint32_t most_queued = 0;               // commands at one time
};

class CellMemory {
 public:
  // A platform that cannot be is refused. `queue` must outlive it.
  static Result<std::unique_ptr<CellMemory>> Make(const CellMemoryParameters& p, EventQueue& queue);

  // Gives a command to the SPU's MFC now. `accepted` runs when it has a place in the queue (at once
  // unless 16 are in it: until then the SPU stands at its channel), `done` when it has completed.
  // False, and why in `error`, for an illegal command; then neither runs.
  bool Submit(uint32_t spu, const DmaCommand& command, Action accepted, Action done,
              std::string& error);

  // Runs `done` as soon as no accepted command of these tags is left (at once if there is none).
  void WaitTags(uint32_t spu, uint32_t tag_mask, Action done);

  const CellMemoryParameters& parameters() const { return p_; }
  EventQueue& queue() { return queue_; }
  const DmaCounts& counts(uint32_t spu) const { return mfcs_[spu].counts; }
  uint64_t bus_lines() const { return bus_.lines(); }
  uint64_t memory_lines(bool write) const { return memory_.lines(write); }

 private:
  struct Entry {
    DmaCommand command;
    Action done;
    size_t element = 0;       // next to cut
    uint32_t lines_left = 0;  // of the element being cut
    uint32_t local_address = 0;
    uint32_t in_flight = 0;
    bool started = false;

    bool AllCut() const { return element == command.elements.size() && lines_left == 0; }
  };
  struct Waiting {
    DmaCommand command;
    Action accepted, done;
  };
  struct TagWait {
    uint32_t mask;
    Action done;
  };
  struct Mfc {
    std::deque<std::unique_ptr<Entry>> queue;  // in the order given
    std::deque<Waiting> stalled;               // at the channel
    std::vector<TagWait> waits;
    Entry* current = nullptr;  // being cut into lines
    uint32_t lines_in_flight = 0;
    bool busy = false;  // taking up a command, or between two lines
    DmaCounts counts;
  };

  CellMemory(const CellMemoryParameters& p, EventQueue& queue);

  void Accept(uint32_t spu, DmaCommand command, Action done);
  void Pump(uint32_t spu);
  void PumpAfter(uint32_t spu, Cycles cycles);
  Entry* NextToStart(Mfc& mfc) const;
  void StartLine(uint32_t spu, Entry& entry);
  void MoveLine(uint32_t spu, Entry& entry);
  void LineDone(uint32_t spu, Entry& entry);
  void Complete(uint32_t spu, Entry& entry);

  const CellMemoryParameters p_;
  EventQueue& queue_;
  Bus bus_;
  MemoryController memory_;
  std::vector<Mfc> mfcs_;
  Cycles next_snoop_ = 0;
  Cycles l2_free_ = 0;
};

}  // namespace pelt
