// One frame ready to run: a plan over memory. Everything an executor may do is RunItem once for each
// item of each pass, on any thread, in any order that keeps the waits of the plan.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>

#include "core/frame_memory.hpp"
#include "jobs/plan.hpp"

namespace pelt {

// From when to when something ran, in ticks of jobs/tick_clock.hpp.
struct Slice {
  uint64_t begin_ticks = 0, end_ticks = 0;
  bool Ran() const { return begin_ticks != 0; }
  uint64_t Ticks() const { return end_ticks - begin_ticks; }
};
struct ItemSlice : Slice {
  uint32_t worker = 0;
};

// Where a run puts its times, in places fixed before the frame (jobs/frame_recording.hpp makes
// them). Every entry is written by whichever thread runs the item, and read after the frame. What
// belongs to one item lies together: a profile costs little more than reading the clock.
struct FrameProfile {
  const uint32_t* item_first;  // of each pass: entry of its item 0 in `items`
  ItemSlice* items;
  // Of each pass: entry of its item 0 in `stage_ends`, which has one for each stage of the pass:
  // when it ended, having begun when the one before it did; 0 if it did not run.
  const uint32_t* stage_first;
  uint64_t* stage_ends;
  // Off: of a stage only that it ran (its end is the item's begin). Reading the clock after every
  // stage is most of what a profile costs.
  bool stage_times = true;

  // When stage `stage` of `pass` (0: the pass's first) ran on `item`.
  Slice Stage(const Plan& plan, uint32_t pass, uint32_t item, uint32_t stage) const;
  // From the first begin to the last end of the pass's `item_count` items; passes may overlap.
  Slice Pass(uint32_t pass, uint32_t item_count) const;
};

// What a scene's frame is at, so that calls in the wrong order are refused instead of computed.
//
//   done ── BeginFrame ──> filling ──> begun ── Run ──> running ── its last item ──> done
//             └── refused: back to done
//   done ── a call that changes the scene, or reads all of it ──> filling ──> done
//
// Any thread may make any call at any time: one atomic word decides which is in turn, and every
// other call gets the reason as a text. What breaks without it: a frame begun twice has forgotten what
// the first one changed (sleepers then sleep through it), a frame run twice steps its chains twice,
// and parameters filled while a frame runs are read half old and half new. None of that crashes; it
// gives other bits. (The atomic type is a parameter for tests/thread/model_test.cpp.)
template <template <class> class Atomic>
class FramePhaseOf {
 public:
  // done -> filling, for BeginFrame. Null, or why not; then nothing has changed.
  const char* StartFilling() {
    return Start("BeginFrame was called while another call is at work on the scene",
                 "BeginFrame was called again before the frame it began was run",
                 "BeginFrame was called while the scene's frame is running");
  }
  // The same for every other call that must have the scene to itself: see BetweenFrames.
  const char* StartChange() {
    return Start("another call is at work on the scene",
                 "the scene's frame is begun and was not run: this call comes between frames",
                 "the scene's frame is running: this call comes between frames");
  }
  // filling -> begun, or back to done.
  void EndFilling(bool begun) { phase_.store(begun ? kBegun : kDone, std::memory_order_release); }

  // begun -> running. Null, or why not.
  const char* StartRun() {
    Phase was = kBegun;
    if (phase_.compare_exchange_strong(was, kRunning, std::memory_order_acquire)) return nullptr;
    if (was == kRunning) return "the frame is running already";
    if (was == kFilling) return "the frame is being begun on another thread";
    return "no frame was begun, or it was run already: BeginFrame comes before every Run";
  }
  // running -> done; what the frame wrote is seen by whoever begins the next one.
  void EndRun() { phase_.store(kDone, std::memory_order_release); }
  bool IsDone() const { return phase_.load(std::memory_order_acquire) == kDone; }
  // running -> begun: it could not be run after all.
  void UndoStart() { phase_.store(kBegun, std::memory_order_release); }

 private:
  enum Phase : uint32_t { kDone, kFilling, kBegun, kRunning };

  const char* Start(const char* filling, const char* begun, const char* running) {
    Phase was = kDone;
    if (phase_.compare_exchange_strong(was, kFilling, std::memory_order_acquire)) return nullptr;
    return was == kFilling ? filling : was == kBegun ? begun : running;
  }

  Atomic<Phase> phase_{kDone};
};
using FramePhase = FramePhaseOf<std::atomic>;

// Keeps a scene between two frames while it lives; or, where it is not between two, says why.
class BetweenFrames {
 public:
  explicit BetweenFrames(FramePhase& phase) : phase_(phase), fault_(phase.StartChange()) {}
  BetweenFrames(const BetweenFrames&) = delete;
  BetweenFrames& operator=(const BetweenFrames&) = delete;
  ~BetweenFrames() {
    if (!fault_) phase_.EndFilling(false);
  }
  const char* fault() const { return fault_; }

 private:
  FramePhase& phase_;
  const char* fault_;
};

struct Frame {
  const Plan* plan;
  const FrameMemory* memory;
  const FrameProfile* profile = nullptr;
  FramePhase* phase = nullptr;  // of the scene the frame is of; null: call order is not checked
};

ItemPlace PlaceOf(const SceneShape& shape, Domain domain, uint32_t item);

// Whether `stage` runs this frame on the item at `place`, as main memory stands.
bool IsWanted(const Stage& stage, const FrameMemory& memory, const ItemPlace& place);
inline const void* ParamsOf(const Stage& stage, const FrameMemory& memory, uint32_t item) {
  return ParamsOf(stage, memory, PlaceOf(*memory.shape, stage.domain, item));
}
inline bool IsWanted(const Stage& stage, const FrameMemory& memory, uint32_t item) {
  return IsWanted(stage, memory, PlaceOf(*memory.shape, stage.domain, item));
}

// Resolves one port in main memory, for the item at `place`.
inline void BindPort(const PortDesc& port, const FrameMemory& memory, const ItemPlace& place,
                     Binding& out) {
  // Field by field: a binding that is put together and copied is read back before it is there.
  const bool by_record = port.access == Access::kGather || port.access == Access::kScatter;
  const auto domain = size_t(port.domain);
  out.block = memory.Block(port.stream, port.stride,
                           by_record ? place.layer_first[domain] : place.first[domain]);
  out.count = by_record ? port.records : place.count[domain];
  out.index = nullptr;
  if (port.access == Access::kGather)
    out.index = reinterpret_cast<uint32_t*>(
        memory.Block(port.record_list, place.first[size_t(Domain::kChunk)]));
}
inline Binding BindPort(const PortDesc& port, const FrameMemory& memory, Domain domain,
                        uint32_t item) {
  Binding binding;
  BindPort(port, memory, PlaceOf(*memory.shape, domain, item), binding);
  return binding;
}

// Runs all stages of `pass` that want to run on `item`, in main memory. The only function that
// calls a kernel there: every host executor ends here. Sets the floating-point environment for the
// duration (round to nearest, denormals kept), so the caller's thread settings cannot change the
// bits. `worker` is for the profile only: which track of a trace the item appears on.
void RunItem(const Frame& frame, uint32_t pass, uint32_t item, uint32_t worker = 0);

// Runs the passes of a frame. Every executor gives the same bits.
class Executor {
 public:
  virtual ~Executor() = default;

  // Returns when the frame is done: null; or why it was not run, and then nothing has happened: it
  // was not begun, was run already, or is running now. The text is a literal.
  const char* Run(const Frame& frame);

 private:
  // All items of all passes. The frame comes without its phase, so that an executor may hand it on
  // to another.
  virtual void RunPasses(const Frame& frame) = 0;
};

class SerialExecutor final : public Executor {
  void RunPasses(const Frame& frame) override;
};

// Serial, in a seeded one of all orders that the plan's waits allow: finds what an item wrongly takes
// from another without waiting for an unlucky thread. Seed 0 runs what became ready last first.
// Allocates on its first frame only.
class PermutedExecutor final : public Executor {
 public:
  explicit PermutedExecutor(uint64_t seed) : seed_(seed), state_(seed) {}

 private:
  void RunPasses(const Frame& frame) override;
  void Fire(const FrameGraph& graph, uint32_t node);

  struct Item {
    uint32_t pass, item, node;
  };
  uint64_t seed_, state_;
  std::vector<uint32_t> waits_for_;  // of nodes
  std::vector<Item> ready_;
};

}  // namespace pelt
