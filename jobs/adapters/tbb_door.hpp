// The door on a oneTBB task group. (jobs/tbb_executor.hpp runs on oneTBB without a door; this is
// for programs that have an arena of their own to run in, and an example of a door on groups.)
//
//   tbb::task_arena arena(4);
//   TbbDoor tasks(4);
//   DoorExecutor executor(tasks.door());
//   arena.execute([&] { executor.Run(frame); });
//
// Tasks go to the arena that the caller is in. A group is waited for as a whole: more than finish
// asks for, never less.
#pragma once

#include <oneapi/tbb/task_group.h>

#include <cstdint>

#include "jobs/engine_door.hpp"

namespace pelt {

class TbbDoor {
 public:
  // `workers`: the concurrency of the arena.
  explicit TbbDoor(uint32_t workers) : workers_(workers) {}

  EngineDoor door() {
    const auto enqueue = [](PeltTask task, void* context, void* user, const char*) -> void* {
      static_cast<tbb::task_group*>(user)->run([task, context] { task(context); });
      return context;
    };
    const auto finish = [](void*, void* user) { static_cast<tbb::task_group*>(user)->wait(); };
    return {enqueue, finish, &group_, workers_};
  }

 private:
  uint32_t workers_;
  tbb::task_group group_;
};

}  // namespace pelt
