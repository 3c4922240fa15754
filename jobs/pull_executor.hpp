// A frame that threads come to, instead of a frame that is handed to threads: for engines that
// would rather poll than be called.
//
//   pull.Begin(frame);                                      // one thread
//   while (pull.TryRun(w) != PullResult::kIdle) {...}       // any threads, any time, also none
//
// TryRun runs one item if one is ready and returns at once if not; it never blocks, locks or
// allocates, and knows no threads: a fibre may call it from another thread each time. It may be
// called at any moment of the executor's life, also between frames. The frame is done when it
// returns kIdle after Begin; whoever sees that sees everything the frame wrote.
//
// Invariant: the frame, and all it points to, stays unchanged from Begin until it is done. The
// executor outlives every call.
#pragma once

#include "jobs/frame.hpp"
#include "jobs/frame_scheduler.hpp"

namespace pelt {

class PullExecutor final : public Executor {
 public:
  // Items have homes with `workers` threads; 0: as many as the machine has cores. Any number may
  // come. Memory is allocated here and, for a frame with more items than all before, in Begin.
  explicit PullExecutor(uint32_t workers = 0);

  // Opens a frame. False, and nothing done, while this executor has another one open, or when the
  // frame was not begun, was run already or is running; `why`, unless null, gets a text.
  [[nodiscard]] bool Begin(const Frame& frame, const char** why = nullptr);

  // `worker` says whose items to look for first, and is noted in the profile: threads that keep
  // their numbers find in their caches what they left there. Any number is right.
  PullResult TryRun(uint32_t worker = 0);

  bool IsIdle() const { return scheduler_.IsIdle(); }

 private:
  // Run begins the frame and works on it until it is done; other threads may help by TryRun. Waits
  // only for items that other threads are running. While another frame is open it works on that
  // first.
  void RunPasses(const Frame& frame) override;
  void EndRun() const;

  FrameScheduler<std::atomic> scheduler_;
  Frame frame_{};  // written between TakeForFrame and Start, read between a claim and its Finish
};

}  // namespace pelt
