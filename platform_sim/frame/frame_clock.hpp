// When what happens in a frame: units draw items, bring blocks in, compute, put them back, and what
// waited for an item is open when its blocks are put.
//
//   unit:   draw i | draw i+1 | wait for get i | compute i           | put i, draw i+2 | wait ...
//   memory:        | get i    | get i+1  ................            | put i | get i+2 ...
//
// A unit goes on with the pass that it is at, whose code it has, while that has open items. Then it
// takes one of the last pass that has any: what is nearest to the frame's end. The last unit always
// does that, so that what many wait for, such as a layer's sort, begins early. Of a pass the items of
// the largest layers come first. Fewer open items than units leave units idle: that is a result.
//
// A unit that is double-buffered draws the next item before it computes on this one. If that is of
// the same pass it comes into the other buffer as soon as that buffer's put is through. A local
// store holds one pass's code and buffers: an item of another pass comes when this one is put.
//
// Rules: who draws holds the line that says what is open; a unit that finds nothing looks once, and
// is then called. With a dispatcher items come from it instead, one after another, to the units that
// have room, and a unit that has work does not stand waiting for one. That an item is done is one small command behind
// its put (on caches a count like a draw), and seen by others after `barrier_cycles`. A unit brings
// the pass's parameters with its first item, and the code unless it is what it ran last. Threads
// that share a core slow each other down while both compute.
//
// Not modelled: gates are decided where the item is drawn, so a get brings exactly what the run
// will need; making DMA lists; a full DMA queue; code of several passes kept side by side.
#pragma once

#include <deque>
#include <span>
#include <vector>

#include "platform_sim/frame/console_machine.hpp"
#include "platform_sim/frame/item_work.hpp"
#include "platform_sim/frame/modelled_frame.hpp"

namespace pelt {

// Asked for each item once, when `unit` has drawn it. The work stays until the frame ends.
class WorkSource {
 public:
  virtual ~WorkSource() = default;
  virtual const ItemWork& Take(uint32_t unit, uint32_t pass, uint32_t item) = 0;
};

class FrameClock {
 public:
  explicit FrameClock(const ConsoleMachine& machine);

  // `work`: all but its items, which `source` gives.
  void Run(const FrameWork& work, WorkSource& source, bool timelines, ModelledFrame& frame);

  const ConsoleMachine& machine() const { return machine_; }

 private:
  static constexpr uint32_t kNone = ~0u;

  enum class Phase : uint8_t {
    kFree,
    kDrawing,
    kGivingGet,
    kAsking,
    kStanding,
    kComputing,
    kGivingPut,
    kDraining,
    kLooking,
    kIdle,
  };
  // That an item was put, or is being put.
  struct ItemEnd {
    uint32_t unit, pass, node;
    Cycles given;  // when the put was
    uint32_t put;
    Cycles done;
  };
  struct Ready {
    uint32_t pass, item;
    uint32_t opened_by;  // in ends_; kNone: open from the beginning
  };
  struct Opening {
    Cycles at;
    Ready ready;
  };
  struct Grant {  // of the dispatcher
    Ready ready;
    Cycles at;
  };
  struct Held {
    uint32_t pass = 0, item = 0;
    const ItemWork* work = nullptr;
    uint32_t get = SharedTransfers::kNone;
    uint32_t buffer_put = SharedTransfers::kNone;  // that the get waits for
    bool any() const { return work != nullptr; }
  };
  struct Past {
    UnitSlice slice;
    uint32_t cause;  // of one that waits to be called: in ends_
  };
  struct Unit {
    Phase phase = Phase::kFree;
    Cycles wake = 0;
    uint32_t waits_for = SharedTransfers::kNone;  // instead of `wake`
    Cycles since = 0;                             // begin of the slice
    uint32_t pass = 0;                            // of what it holds, or held last
    Ready drawing{};
    Held current, next, drawn;
    std::deque<Grant> grants;
    uint32_t parameters_pass = kNone;  // whose it has
    uint32_t code_pass = kNone;
    uint32_t code = SharedTransfers::kNone;  // on its way
    std::vector<uint32_t> puts;              // of the last items, newest last
    // Of the work being computed: what all of it takes; which part is left from `clocked` on, when
    // all of it would take `pace`.
    double cycles = 0.0, shared_cycles = 0.0, left = 0.0, pace = 0.0;
    Cycles clocked = 0, compute_begin = 0;
    std::vector<Past> past;
  };

  void Begin(const FrameWork& work, WorkSource& source, ModelledFrame& frame);
  void End(bool timelines);
  Cycles WakeOf(const Unit& unit) const {
    return unit.waits_for == SharedTransfers::kNone ? unit.wake : transfers_.DoneAt(unit.waits_for);
  }
  bool IsDue(const Unit& unit) const;
  Cycles NextWake() const;
  void Step(uint32_t u);
  void Decide(uint32_t u);

  // What is open, and who gets it.
  void Finish(const ItemEnd& end);
  void Fire(uint32_t node, uint32_t by);
  void Count(uint32_t node, uint32_t by);
  void FinishPuts();
  void OpenDue();
  bool HasReady() const { return ready_count_ > 0; }
  auto RankIn(uint32_t pass) const {
    return [rank = std::span(work_->passes[pass].rank)](const Ready& ready) {
      return rank.empty() ? ready.item : rank[ready.item];
    };
  }
  Ready TakeReady(const Unit& unit);
  void Request(Unit& unit);
  bool StartDraw(Unit& unit);
  void EndDraw(uint32_t u);
  void EndIdle(Unit& unit, const Ready& called_for);

  void GiveGet(Unit& unit);
  void StartGet(uint32_t u);
  void Stand(uint32_t u);
  void StartCompute(uint32_t u);
  ItemWork::CodeTime TimeOf(const ItemWork::StageTime& stage) const;
  void EndCompute(uint32_t u);
  void StartPut(uint32_t u);
  bool Drains(Unit& unit);
  // The unit computes from now on, or no longer: whoever shares its core goes on at another speed.
  void ReclockCore(uint32_t u);
  void Reclock(uint32_t u);
  bool SharesCore(uint32_t u) const;
  void EndSlice(Unit& unit, UnitWork work, uint32_t pass, uint32_t item, uint32_t cause = kNone);
  void Spend(Unit& unit, Phase phase, Cycles cycles);
  uint32_t Move(uint32_t u, bool put, const TransferShape& shape, uint32_t pass, uint32_t item,
                uint32_t after);
  void FindCriticalPath();
  bool HasStores() const { return machine_.local_store_bytes > 0; }
  uint32_t Places(uint32_t pass) const { return work_->passes[pass].double_buffered ? 2 : 1; }
  // With what was drawn.
  bool BringsCode(const Unit& unit) const {
    return HasStores() && unit.code_pass != work_->passes[unit.drawn.pass].pass;
  }
  bool BringsParameters(const Unit& unit) const {
    return HasStores() && unit.parameters_pass != unit.drawn.pass;
  }
  // Whether an item of `pass` has to wait until the unit has put what it holds.
  bool Waits(const Unit& unit, uint32_t pass) const {
    return HasStores() && unit.current.any() && pass != unit.pass;
  }

  const ConsoleMachine machine_;
  SharedTransfers transfers_;
  std::vector<Unit> units_;

  // Of the frame that runs.
  const FrameWork* work_ = nullptr;
  WorkSource* source_ = nullptr;
  ModelledFrame* frame_ = nullptr;
  Cycles now_ = 0, line_free_ = 0, dispatcher_free_ = 0;
  std::vector<uint32_t> pending_;          // of nodes
  std::vector<std::vector<Ready>> ready_;  // of passes: heaps, the first to be taken on top
  uint32_t ready_count_ = 0;
  std::deque<Opening> openings_;  // in order of time
  std::vector<ItemEnd> flying_, ends_;
  uint32_t last_end_ = kNone;
  Cycles over_at_ = SharedTransfers::kNever;
  struct Moved {
    uint32_t unit, slice, transfer;
  };
  std::vector<Moved> moved_;  // whose times the timelines lack yet
};

// The same work on another machine.
ModelledFrame TimeFrame(const FrameWork& work, const ConsoleMachine& machine);

}  // namespace pelt
