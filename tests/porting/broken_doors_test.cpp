// Doors that are broken in one way each: the conformance check that is meant for it must fail, and
// say why.
#include <gtest/gtest.h>

#include <array>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "jobs/adapters/thread_pool_door.hpp"
#include "jobs/conformance.hpp"

namespace pelt {
namespace {

// A working door, and what is wrong with it.
struct BrokenDoor {
  ThreadPoolDoor pool{3};
  EngineDoor good = pool.door();
  uint32_t count = 0;
  std::vector<std::thread> threads;

  ~BrokenDoor() {
    for (std::thread& thread : threads) thread.join();
  }
  static BrokenDoor& Of(void* user) { return *static_cast<BrokenDoor*>(user); }
  void* PassOn(PeltTask task, void* context) {
    return good.enqueue(task, context, good.user, "passed on");
  }
  static void Finish(void* handle, void* user) {
    BrokenDoor& self = Of(user);
    if (handle != user) self.good.finish(handle, self.good.user);
  }
};

void ExpectFails(const ConformanceReport& report, const char* check, const char* why) {
  EXPECT_FALSE(report.Passed());
  const ConformanceCheck* found = report.Find(check);
  ASSERT_NE(found, nullptr) << report.Text();
  EXPECT_FALSE(found->passed) << report.Text();
  EXPECT_NE(found->detail.find(why), std::string::npos) << report.Text();
}

TEST(BrokenDoors, DropsTasks) {
  BrokenDoor broken;
  const auto enqueue = [](PeltTask task, void* context, void* user, const char*) -> void* {
    BrokenDoor& self = BrokenDoor::Of(user);
    return ++self.count % 4 == 0 ? user : self.PassOn(task, context);
  };
  const auto report = CheckDoor({enqueue, &BrokenDoor::Finish, &broken, 3});
  ExpectFails(report, "tasks", "before its task had run");
  ExpectFails(report, "as it is", "had not returned");
  EXPECT_TRUE(report.Find("one worker")->passed) << report.Text();
}

TEST(BrokenDoors, StartsTasksTwice) {
  BrokenDoor broken;
  using Pair = std::array<void*, 2>;
  const auto enqueue = [](PeltTask task, void* context, void* user, const char*) -> void* {
    BrokenDoor& self = BrokenDoor::Of(user);
    return new Pair{self.PassOn(task, context), self.PassOn(task, context)};
  };
  const auto finish = [](void* handle, void* user) {
    const auto pair = static_cast<Pair*>(handle);
    for (void* one : *pair)
      if (one) BrokenDoor::Finish(one, user);
    delete pair;
  };
  const auto report = CheckDoor({enqueue, finish, &broken, 3});
  ExpectFails(report, "tasks", "called 2 times");
  ExpectFails(report, "as it is", "called again");
}

// For doors where every task is a thread.
uint64_t RunOneFrame(Executor& executor) {
  conformance::SyntheticFrames frames;
  executor.Run(frames.frame());
  return frames.Digest();
}

TEST(BrokenDoors, ReturnsNullForQueuedTasks) {
  BrokenDoor broken;
  const auto enqueue = [](PeltTask task, void* context, void* user, const char*) -> void* {
    // Starts the task when no caller waits for it any more.
    BrokenDoor::Of(user).threads.emplace_back([=] {
      std::this_thread::sleep_for(std::chrono::milliseconds(300));
      task(context);
    });
    return nullptr;
  };
  const auto report = CheckDoor({enqueue, &BrokenDoor::Finish, &broken, 2}, RunOneFrame);
  ExpectFails(report, "tasks", "null");
  ExpectFails(report, "as it is", "null");
}

TEST(BrokenDoors, FinishReturnsEarly) {
  BrokenDoor broken;
  const auto enqueue = [](PeltTask task, void* context, void* user, const char*) -> void* {
    BrokenDoor::Of(user).threads.emplace_back([=] {
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
      task(context);
    });
    return user;
  };
  const auto report = CheckDoor({enqueue, &BrokenDoor::Finish, &broken, 2}, RunOneFrame);
  ExpectFails(report, "tasks", "before its task had run");
  ExpectFails(report, "as it is", "had not returned");
}

// Every task gets the context of the one before, if that was of the same kind.
TEST(BrokenDoors, PassesTheWrongContext) {
  BrokenDoor broken;
  static std::pair<PeltTask, void*> last;
  last = {};
  const auto enqueue = [](PeltTask task, void* context, void* user, const char*) -> void* {
    void* given = last.first == task ? last.second : context;
    last = {task, context};
    return BrokenDoor::Of(user).PassOn(task, given);
  };
  const auto report = CheckDoor({enqueue, &BrokenDoor::Finish, &broken, 3});
  EXPECT_FALSE(report.Find("tasks")->passed) << report.Text();
}

// ---- Doors that hang. What they hang on is left behind, so it is static. ------------------------

struct HangingDoor {
  std::mutex mutex;
  std::condition_variable never;
  void Hang() {
    std::unique_lock lock(mutex);
    never.wait(lock, [] { return false; });
  }
};

TEST(BrokenDoors, FinishNeverReturns) {
  static HangingDoor& hanging = *new HangingDoor;
  const auto enqueue = [](PeltTask task, void* context, void* user, const char*) -> void* {
    task(context);
    return user;
  };
  const auto finish = [](void*, void* user) { static_cast<HangingDoor*>(user)->Hang(); };
  ConformanceOptions options;
  options.limit_s = 0.5;
  const auto report = CheckDoor({enqueue, finish, &hanging, 3}, options);
  EXPECT_TRUE(report.hung);
  ExpectFails(report, "tasks", "did not return in time");
  EXPECT_EQ(report.checks.size(), 1u) << "nothing can be said about the rest";
}

// Two workers that wait for their task to be taken by a third: fine until they are all busy.
TEST(BrokenDoors, EnqueueWaitsForAFreeWorker) {
  struct Rendezvousing {
    std::mutex mutex;
    std::condition_variable changed;
    PeltTask task = nullptr;
    void* context = nullptr;
    uint32_t running = 0;
    void Serve() {
      std::unique_lock lock(mutex);
      for (;;) {
        changed.wait(lock, [&] { return task; });
        const PeltTask t = std::exchange(task, nullptr);
        void* c = context;
        ++running;
        changed.notify_all();
        lock.unlock();
        t(c);
        lock.lock();
        --running;
        changed.notify_all();
      }
    }
  };
  static Rendezvousing& door = *new Rendezvousing;
  std::thread([] { door.Serve(); }).detach();
  const auto enqueue = [](PeltTask task, void* context, void* user, const char*) -> void* {
    auto& self = *static_cast<Rendezvousing*>(user);
    std::unique_lock lock(self.mutex);
    self.task = task;
    self.context = context;
    self.changed.notify_all();
    self.changed.wait(lock, [&] { return !self.task; });
    return user;
  };
  const auto finish = [](void*, void* user) {
    auto& self = *static_cast<Rendezvousing*>(user);
    std::unique_lock lock(self.mutex);
    self.changed.wait(lock, [&] { return self.running == 0; });
  };
  ConformanceOptions options;
  options.limit_s = 3.0;
  const auto report = CheckDoor({enqueue, finish, &door, 2}, options);
  ExpectFails(report, "starved", "does enqueue wait for a worker");
}

TEST(BrokenDoors, LacksAFunction) {
  const auto report = CheckDoor({nullptr, &BrokenDoor::Finish, nullptr, 2});
  ExpectFails(report, "door", "must both be given");
}

// Memory of the frame overwritten by the engine's own doing, seen in the digest.
TEST(BrokenDoors, DisturbsMemory) {
  BrokenDoor broken;
  static uint64_t course_runs = 0;
  course_runs = 0;
  const auto course = [](Executor& executor) {
    const uint64_t digest = conformance::SyntheticFrames::Run(executor);
    return course_runs++ == 0 ? digest : digest ^ 1;  // the serial run is the first
  };
  const auto report = CheckDoor(broken.good, course);
  ExpectFails(report, "as it is", "when run serially");
}

}  // namespace
}  // namespace pelt
