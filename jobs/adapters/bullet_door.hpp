// The door on Bullet's task scheduler, and the pattern for every engine that has a parallel loop
// but no tasks: the loop's iterations are the workers.
//
//   BulletDoor bullet(*btGetTaskScheduler());
//   DoorExecutor executor(bullet.door());
//   bullet.Run([&] { executor.Run(frame); });
//
//   parallelFor over the workers:   first to come   body: enqueue ─ work ─ finish ─┐
//                                   others          serve the queue until the body ends
//                                   too late        nothing
//
// No iteration is special and none waits for another to begin, so it works on any number of
// threads, Bullet's sequential scheduler included: then finish runs the tasks. (A stock Bullet is
// built without threads, and its schedulers are sequential.) Outside Run, too, finish runs them.
#pragma once

#include <LinearMath/btThreads.h>

#include <atomic>
#include <cstdint>
#include <functional>

#include "jobs/adapters/task_queue.hpp"

namespace pelt {

class BulletDoor {
 public:
  explicit BulletDoor(btITaskScheduler& scheduler) : scheduler_(scheduler) { queue_.Close(); }

  EngineDoor door() {
    return {&TaskQueue::Enqueue, &TaskQueue::Finish, &queue_, uint32_t(scheduler_.getNumThreads())};
  }

  // Runs body once, on some thread of the scheduler.
  void Run(const std::function<void()>& body) {
    queue_.Open();
    const Loop loop(queue_, body);
    scheduler_.parallelFor(0, scheduler_.getNumThreads(), 1, loop);
  }

 private:
  struct Loop final : btIParallelForBody {
    Loop(TaskQueue& q, const std::function<void()>& b) : queue(q), body(b) {}
    void forLoop(int begin, int end) const override {
      for (int i = begin; i < end; ++i) {
        if (taken.exchange(true)) {
          queue.Serve();
        } else {
          body();
          queue.Close();
        }
      }
    }
    TaskQueue& queue;
    const std::function<void()>& body;
    mutable std::atomic<bool> taken{false};
  };

  btITaskScheduler& scheduler_;
  TaskQueue queue_;
};

}  // namespace pelt
