// A frame of the real plan on a console, in the console's time.
//
// Discrete events: units (SPUs, or hardware threads) take the items of a pass one after another,
// bring their blocks in, compute, put them back, the next item's transfer under this one's work
// where the pass is double-buffered; between passes all meet. The frame is executed for real while
// it is timed: an item runs when a unit takes it, in the unit's own poisoned local store on a Cell,
// in main memory on a Xenon; so gates see what ran, work counts are those of the run, and the
// digests must be the host's.
//
//   unit 0  |dispatch|get|  compute   |  compute  |put|......|barrier
//   unit 1  |dispatch|get|    compute    |  compute     |put|
//
// Times are whole cycles of the console's clock; a frame begins at cycle 0.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "jobs/frame.hpp"
#include "platform_sim/core/stage_costs.hpp"
#include "platform_sim/local_store.hpp"
#include "platform_sim/memory/event_queue.hpp"

namespace pelt {

enum class UnitWork : uint8_t {
  kDispatch,   // fetching the next item's number, telling that it is done
  kCode,       // bringing the pass's code into the local store
  kGetStall,   // standing until blocks are here
  kCompute,
  kPutStall,   // standing until a buffer is free again
  kBarrier,    // waiting for the other units
};
inline constexpr uint32_t kUnitWorkCount = 6;
std::string_view UnitWorkName(UnitWork work);

// What one unit did, in order, without gaps from the frame's begin to its end.
struct UnitSlice {
  UnitWork work;
  uint32_t pass, item;  // kNoBlock where it belongs to none
  Cycles begin, end;
};
// A transfer beside it.
struct TransferSlice {
  bool put;
  uint32_t pass, item;
  Cycles begin, end;
  uint64_t bytes;
};
struct UnitTimeline {
  std::vector<UnitSlice> slices;
  std::vector<TransferSlice> transfers;
};

struct ModelledPass {
  Cycles begin = 0, end = 0;
  uint32_t items = 0;  // on which a stage ran
  uint64_t get_bytes = 0, put_bytes = 0;
  // Bytes that lines carry beyond what was asked for: small list elements, bad alignment.
  uint64_t wasted_bytes = 0;
  std::array<Cycles, kUnitWorkCount> unit_cycles{};  // summed over units
  uint32_t last_unit = 0;                            // that all others waited for
};

struct ModelledFrame {
  Cycles cycles = 0;
  std::vector<ModelledPass> passes;          // as in the plan
  std::vector<Cycles> stage_cycles;          // compute, summed over units, [stage]
  std::vector<uint32_t> stage_items;         // items it ran on, [stage]
  std::vector<uint64_t> stream_get_bytes, stream_put_bytes;  // main memory, [Stream]
  std::vector<UnitTimeline> units;           // filled when asked for
};

// Numbers the engine needs, made from a platform's parameters (cell_console.cpp, xenon_console.cpp).
// Rates are bytes a cycle of this clock.
struct ConsoleMachine {
  std::string name;          // "PS3"
  uint64_t clock_hz = 0;
  uint32_t units = 0;
  uint32_t threads_per_core = 1;
  uint32_t local_store_bytes = 0;  // 0: caches
  double availability = 1.0;       // of compute: measured kernels reach this part of the issue rate
  // Shared memory as transfers see it. Derived by running the memory model, not typed in.
  double read_rate = 0.0, write_rate = 0.0, mixed_rate = 0.0;  // all units together
  double unit_rate = 0.0;                                      // one unit alone
  Cycles latency_cycles = 0;     // of the first bytes of a transfer
  Cycles command_cycles = 0;     // of the unit, for each command it gives
  uint32_t largest_command_bytes = 0;
  uint32_t line_bytes = 128;
  Cycles dispatch_cycles = 0;    // of a unit, for each item it takes
  Cycles barrier_cycles = 0;     // from the last unit's end to the next pass
};

// Runs frames on a console. One frame's result stays until the next.
class ConsoleExecutor final : public Executor {
 public:
  // Null, and why in `error`, when code, stack and buffers of a pass do not fit the local store, or
  // the machine cannot be.
  static std::unique_ptr<ConsoleExecutor> TryMake(const ConsoleMachine& machine,
                                                  const StageCosts& costs, const Frame& frame,
                                                  std::string& error);
  ~ConsoleExecutor() override;

  void Run(const Frame& frame) override;
  void KeepTimelines(bool keep);

  const ModelledFrame& modelled() const;
  // Of the local stores; empty on caches.
  std::vector<LocalStoreFault> faults() const;

 private:
  struct State;
  explicit ConsoleExecutor(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace pelt
