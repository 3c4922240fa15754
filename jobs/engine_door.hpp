// The door an engine opens to Pelt: two functions and a number. Everything else about running a
// frame on the engine's job system is on this side of it (jobs/README.md is the porting guide).
//
//   caller       Run: begin ─ enqueue helpers ─ item item item ─ ... ─ finish every helper ─ return
//   helper 1              └─> item item item item ─ return
//   helper 2                       └─ (starts late, or never in time: the frame does not wait for it)
//
// A helper is one task of the engine: it pulls items (jobs/frame_scheduler.hpp) until the frame is
// done. The caller pulls too, so a frame is done even if no helper ever starts; it waits only for
// items that a helper is running at that moment. Helpers are asked for once, when the frame begins:
// as many as there are workers and its largest pass has use for.
//
// Invariants: nothing here throws. `enqueue` and `finish` are called by the thread that called Run
// and by no other; every handle is finished before Run returns; nothing here allocates, locks or
// asks which thread it is on after construction. An engine that breaks its side (runs a task twice,
// never, or still after finish; throws) is found out and counted in faults(); the frame is right all
// the same, and the next one asks again.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>

#include "jobs/frame.hpp"
#include "jobs/pelt.h"
#include "jobs/pull_executor.hpp"

namespace pelt {

// What the engine implements: two C functions, user data and a number of threads.
using EngineDoor = PeltDoor;

// Null, or what is wrong with a door.
const char* FindDoorFault(const EngineDoor& door);

// How often an engine broke its side of the door since the executor was made: what had to be seen
// anyway to keep the frame right. What exactly it did wrong, CheckDoor finds
// (jobs/conformance.hpp).
struct DoorFaults {
  uint64_t started_again = 0;      // a task was called a second time
  uint64_t not_returned = 0;       // the door said that a task had returned, and it had not
  uint64_t threw = 0;              // enqueue or finish ended with an exception
  uint64_t run_while_running = 0;  // a frame was begun before the last was done: it ran serially
  const char* unusable = nullptr;  // why the door is not used, and the caller runs everything

  bool Any() const;
  // One line for each kind that happened, saying what to look for; empty when none did.
  std::string Text() const;
};

class DoorExecutor final : public Executor {
 public:
  // Frames whose tasks an engine may all lose (never return) before it is asked for no more.
  static constexpr uint32_t kDefaultSpareFrames = 16;

  // Reserves 64 bytes for each task: (worker_count - 1) * spare_frames. A door that lacks a
  // function, or has no workers, is not used: faults() says so.
  explicit DoorExecutor(const EngineDoor& door, uint32_t spare_frames = kDefaultSpareFrames);
  ~DoorExecutor() override;

  // Most tasks one frame of this plan enqueues.
  uint32_t MaxTasks(const Plan& plan, const SceneShape& shape) const;
  // Tasks enqueued since the executor was made.
  uint64_t TasksEnqueued() const { return tasks_enqueued_; }
  DoorFaults faults() const;

 private:
  struct Task;
  void RunPasses(const Frame& frame) override;
  static void RunTask(void* context);
  void Help(uint32_t worker);

  // False when the reserved tasks are used up, or the engine threw.
  bool Enqueue(uint32_t worker);
  void FinishTasks();
  // The door said that the task has returned.
  void CheckReturned(Task& task);

  EngineDoor door_;
  std::atomic<bool> running_{false};
  std::atomic<uint64_t> run_while_running_{0}, started_again_{0};
  PullExecutor pull_;
  uint32_t helper_count_;
  uint32_t task_capacity_;
  std::unique_ptr<Task[]> tasks_;
  uint32_t tasks_lent_ = 0;  // those before this one are with the engine, or retired
  uint64_t tasks_enqueued_ = 0;
  DoorFaults faults_;
};

}  // namespace pelt
