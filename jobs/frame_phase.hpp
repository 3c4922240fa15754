// What a scene's frame is at, so that calls in the wrong order are refused instead of computed.
//
//   done ── BeginFrame ──> filling ──> begun ── Run ──> running ── its last item ──> done
//             └── refused: back to done
//
// Any thread may make any call at any time: one atomic word decides who is in turn, and everybody
// else gets the reason as a text. What breaks without it: a frame begun twice has forgotten what
// the first one changed (sleepers then sleep through it), a frame run twice steps its chains twice,
// and parameters filled while a frame runs are read half old and half new. None of that crashes; it
// gives other bits.
#pragma once

#include <atomic>
#include <cstdint>

namespace pelt {

class FramePhase {
 public:
  // done -> filling. Null, or why not; then nothing has changed.
  const char* StartFilling() {
    Phase was = kDone;
    if (phase_.compare_exchange_strong(was, kFilling, std::memory_order_acquire)) return nullptr;
    if (was == kFilling) return "BeginFrame is at work on this scene on another thread";
    if (was == kBegun) return "BeginFrame was called again before the frame it began was run";
    return "BeginFrame was called while the scene's frame is running";
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
  std::atomic<Phase> phase_{kDone};
};

}  // namespace pelt
