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
#pragma once

#include <atomic>
#include <cstdint>

namespace pelt {

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

}  // namespace pelt
