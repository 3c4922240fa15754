// What a frame on a console came out as: which unit did what when, bytes, and who waited for whom.
//
//   unit 0  |dispatch|get|  compute   |  compute  |put|imbalance|barrier|dispatch|get| ...
//   unit 1  |dispatch|get|    compute    |  compute       |put|barrier
//
// Invariant: the slices of a unit have no gaps, so the cycles of every kind of work, summed over
// passes, are units x cycles of the frame; and those of the critical path are the frame.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "core/stream_table.hpp"
#include "platform_sim/frame/item_work.hpp"
#include "platform_sim/memory/event_queue.hpp"

namespace pelt {

enum class UnitWork : uint8_t {
  kDispatch,  // drawing the next item
  kCommands,  // giving transfers, asking whether they are through
  kCode,      // standing until the pass's code and parameters are here
  kGetStall,  // standing until blocks are here
  kCompute,
  kPutStall,   // standing until a buffer is free again, or until all is put
  kImbalance,  // nothing is open: others work on what it waits for
  kBarrier,    // until it sees that they are done
};
inline constexpr uint32_t kUnitWorkCount = 8;
std::string_view UnitWorkName(UnitWork work);

using WorkCycles = std::array<Cycles, kUnitWorkCount>;  // [UnitWork]

// What one unit did, in order, without gaps from the frame's begin to its end.
struct UnitSlice {
  UnitWork work;
  uint32_t pass, item;  // kNoBlock where it belongs to none
  Cycles begin, end;
};
// A transfer beside it; one that the frame does not wait for ends with the frame.
struct TransferSlice {
  bool put;
  uint32_t pass, item;  // kNoBlock: code
  Cycles begin, end;
  uint64_t bytes;
};
struct UnitTimeline {
  std::vector<UnitSlice> slices;
  std::vector<TransferSlice> transfers;
};

struct ModelledPass {
  Cycles begin = 0, end = 0;              // of its first and its last item; others run meanwhile
  uint32_t items = 0;                     // on which a stage ran
  uint64_t get_bytes = 0, put_bytes = 0;  // of streams
  uint64_t code_bytes = 0;                // and parameters, brought to every unit that needs it
  // Bytes that lines carry beyond what was asked for: small list elements, bad alignment.
  uint64_t wasted_bytes = 0;
  // Summed over units. That nothing is open belongs to the pass that comes next.
  WorkCycles unit_cycles{};
  // Of the chain of items that the frame's end waited for, and of those that run no others.
  WorkCycles critical_cycles{};
};

struct ModelledFrame {
  Cycles cycles = 0;
  std::vector<ModelledPass> passes;                          // as in the plan
  std::vector<Cycles> stage_cycles;                          // compute, summed over units, [stage]
  std::vector<uint32_t> stage_items;                         // items it ran on, [stage]
  std::vector<uint64_t> stream_get_bytes, stream_put_bytes;  // main memory, [Stream]
  std::vector<UnitTimeline> units;                           // filled when asked for

  // As it is before anything is done; its timelines stay.
  void BeginWith(const FrameWork& work);
  // What an item adds to all but the times.
  void Count(const ItemWork& work, uint32_t pass);
};

}  // namespace pelt
