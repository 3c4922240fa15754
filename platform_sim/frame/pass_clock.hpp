// When what happens in a pass: units draw items, bring blocks in, compute, put them back, and meet.
//
//   unit:   draw i | draw i+1 | wait for get i | compute i           | put i, draw i+2 | wait ...
//   memory:        | get i    | get i+1  ................            | put i | get i+2 ...
//
// Items go in order to whoever asks first in console time; a unit that is double-buffered asks for
// the next item before it computes on this one, and gets it into the other buffer as soon as that
// buffer's put is through. Fewer items than units leave units idle: that is a result.
//
// Rules: who draws holds the counter's line; one draw more finds it at its end. With a dispatcher
// items come from it instead, one after another, to the units that have room, and nobody stands for
// it who has work. A unit brings the pass's parameters with its first item, and the code unless it
// is what it ran last. Threads that share a core slow each other down while both compute.
//
// Not modelled: gates are decided where the item is drawn, so a get brings exactly what the run
// will need; making DMA lists; a full DMA queue; code of several passes kept side by side.
#pragma once

#include <deque>
#include <vector>

#include "platform_sim/frame/console_machine.hpp"
#include "platform_sim/frame/item_work.hpp"
#include "platform_sim/frame/modelled_frame.hpp"

namespace pelt {

// Asked for each item of a pass once, when `unit` has drawn it. The work stays until the pass ends.
class WorkSource {
 public:
  virtual ~WorkSource() = default;
  virtual const ItemWork& Take(uint32_t unit, uint32_t item) = 0;
};

class PassClock {
 public:
  explicit PassClock(const ConsoleMachine& machine);

  void BeginFrame(const FrameWork& work, bool timelines, ModelledFrame& frame);
  // Adds a pass of `items` items to the frame, from frame.cycles on. `work`: all but its items.
  void Run(const PassWork& work, uint32_t items, WorkSource& source, ModelledFrame& frame);

  const ConsoleMachine& machine() const { return machine_; }

 private:
  enum class Phase : uint8_t {
    kFree,
    kDrawing,
    kGivingGet,
    kAsking,
    kStanding,
    kComputing,
    kGivingPut,
    kDraining,
    kFinished,
  };
  struct Held {
    uint32_t item = ~0u;
    const ItemWork* work = nullptr;
    uint32_t get = SharedTransfers::kNone;
    uint32_t buffer_put = SharedTransfers::kNone;  // that the get waits for
    bool any() const { return work != nullptr; }
  };
  struct Grant {  // of the dispatcher
    uint32_t item;
    Cycles ready;
  };
  struct Unit {
    Phase phase = Phase::kFree;
    Cycles wake = 0;
    uint32_t waits_for = SharedTransfers::kNone;  // instead of `wake`
    Cycles since = 0;                             // begin of the slice
    Held current, next, drawn;
    std::deque<Grant> grants;
    bool exhausted = false;
    bool has_parameters = false;
    uint32_t code_pass = ~0u;
    uint32_t code = SharedTransfers::kNone;  // on its way
    std::vector<uint32_t> puts;              // of the last items, newest last
    // Of the work being computed: what all of it takes; which part is left from `clocked` on, when
    // all of it would take `pace`.
    double cycles = 0.0, shared_cycles = 0.0, left = 0.0, pace = 0.0;
    Cycles clocked = 0, compute_begin = 0;
    WorkCycles spent{};
    std::vector<uint32_t> items;
  };

  bool IsDue(const Unit& unit) const;
  Cycles NextWake() const;
  void Step(uint32_t u);
  void Decide(uint32_t u);
  void Request(Unit& unit);
  bool StartDraw(Unit& unit);
  void EndDraw(uint32_t u);
  void StartGet(uint32_t u);
  void Stand(uint32_t u);
  void StartCompute(uint32_t u);
  ItemWork::CodeTime TimeOf(const ItemWork::StageTime& stage) const;
  void EndCompute(uint32_t u);
  void StartPut(uint32_t u);
  void Drain(Unit& unit);
  void Meet();
  // The unit computes from now on, or no longer: whoever shares its core goes on at another speed.
  void ReclockCore(uint32_t u);
  void Reclock(uint32_t u);
  bool SharesCore(uint32_t u) const;
  void EndSlice(Unit& unit, UnitWork work, uint32_t item);
  void Spend(Unit& unit, Phase phase, Cycles cycles);
  void Count(const ItemWork& work);
  uint32_t Move(uint32_t u, bool put, const TransferShape& shape, uint32_t item, uint32_t after);
  uint32_t Places() const { return work_->double_buffered ? 2 : 1; }

  const ConsoleMachine machine_;
  SharedTransfers transfers_;
  std::vector<Unit> units_;
  bool timelines_ = false;

  // Of the pass that runs.
  const PassWork* work_ = nullptr;
  WorkSource* source_ = nullptr;
  ModelledFrame* frame_ = nullptr;
  ModelledPass* pass_ = nullptr;
  uint32_t items_ = 0, next_item_ = 0;
  Cycles now_ = 0, line_free_ = 0, dispatcher_free_ = 0;
  struct Moved {
    uint32_t unit, slice, transfer;
  };
  std::vector<Moved> moved_;  // whose times the timelines lack yet
};

// The same work on another machine.
ModelledFrame TimeFrame(const FrameWork& work, const ConsoleMachine& machine);

}  // namespace pelt
