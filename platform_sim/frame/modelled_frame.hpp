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
#include "jobs/plan.hpp"
#include "platform_sim/frame/console_machine.hpp"
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

// ---- Many frames ----------------------------------------------------------------------------
//
// Many modelled frames as a few numbers: how long, on what, limited by what.
//
// Passes run side by side: a pass's time is that of all units on it over their number, so that passes
// add up to the frame. A pass's limits are answers to "what if": its frame is timed again on a
// machine where one thing costs nothing. What shrinks a pass most binds it.

enum class PassLimit : uint8_t { kCompute, kMemory, kDispatch, kImbalance };
inline constexpr uint32_t kPassLimitCount = 4;
std::string_view PassLimitName(PassLimit limit);

using WorkMs = std::array<double, kUnitWorkCount>;  // [UnitWork]

// Milliseconds; bytes and items are of a frame in the mean.
struct FrameSummary {
  uint32_t frames = 0;
  double median_ms = 0.0, p95_ms = 0.0, worst_ms = 0.0;

  struct Stage {
    double core_ms = 0.0;  // compute, summed over units
    double wall_ms = 0.0;  // its part of its pass's time, by compute
    double items = 0.0;
  };
  std::vector<Stage> stages;  // as in the plan

  struct Pass {
    double ms = 0.0, items = 0.0;
    WorkMs unit_ms{};      // of a unit in the mean: adds up to `ms`
    WorkMs critical_ms{};  // of the critical path: over all passes it adds up to the frame
    // If this cost nothing; over the frames whose limits were added.
    std::array<double, kPassLimitCount> without_ms{};
    double limited_ms = 0.0;                // over the same frames, as it is
    PassLimit binds = PassLimit::kCompute;  // means nothing while limited_ms is 0
    // By how much the pass would shrink.
    double GainMs(PassLimit limit) const { return limited_ms - without_ms[size_t(limit)]; }
  };
  std::vector<Pass> passes;  // as in the plan

  std::vector<double> stream_get_bytes, stream_put_bytes;  // [Stream]
  double code_bytes = 0.0, wasted_bytes = 0.0;
  double bus_use = 0.0;             // bytes moved over what the memory could have moved meanwhile
  WorkMs unit_ms{}, critical_ms{};  // of the whole frame

  uint32_t worst_frame = 0;  // of those added, from 0
};

class FrameStatistics {
 public:
  FrameStatistics(const ConsoleMachine& machine, const Plan& plan);

  void Add(const ModelledFrame& frame);
  // Times the frame's work again, once for each limit: worth doing for some of the frames.
  void AddLimits(const ModelledFrame& frame, const FrameWork& work);

  FrameSummary Summarise() const;

 private:
  double CyclesOf(const ModelledPass& pass) const;

  const ConsoleMachine machine_;
  std::vector<uint32_t> stage_pass_;
  std::vector<Cycles> lengths_;
  FrameSummary sum_;  // cycles instead of milliseconds, sums instead of means
  uint32_t limited_frames_ = 0;
  double bytes_ = 0.0, cycles_ = 0.0;
};

// The machine without what limits it; kImbalance has none.
ConsoleMachine WithoutLimit(const ConsoleMachine& machine, PassLimit limit);

}  // namespace pelt
