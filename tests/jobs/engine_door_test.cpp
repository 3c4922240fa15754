// The door executor over doors made for one purpose: helpers asked for, tasks counted and named,
// and every way an engine can break its side, found out while the frame stays right.
#include "jobs/engine_door.hpp"

#include <gtest/gtest.h>

#include <deque>
#include <set>
#include <string>
#include <thread>

#include "core/kernel.hpp"
#include "jobs/conformance.hpp"
#include "jobs/frame_recording.hpp"

namespace pelt {
namespace {

using conformance::SyntheticFrames;

uint64_t SerialDigest() {
  SerialExecutor serial;
  return SyntheticFrames::Run(serial);
}

// A door that does what its fields say, all on the caller's thread unless `thread`.
struct TestDoor {
  struct Given {
    PeltTask task;
    void* context;
    std::thread thread = {};
    bool started = false;
  };
  bool run_in_enqueue = false;
  bool return_null = false;
  bool run_in_finish = false;
  bool run_again_in_finish = false;
  bool thread = false;
  uint32_t workers = 4;

  std::deque<Given> given = {};
  std::multiset<std::string> names = {};
  uint32_t finished = 0;
  std::thread::id caller = std::this_thread::get_id();

  EngineDoor door() {
    const auto enqueue = [](PeltTask task, void* context, void* user, const char* name) -> void* {
      auto& self = *static_cast<TestDoor*>(user);
      EXPECT_EQ(std::this_thread::get_id(), self.caller) << "only the caller may use the door";
      self.names.insert(name);
      if (self.run_in_enqueue) task(context);
      if (self.return_null) return nullptr;
      Given& given = self.given.emplace_back(Given{task, context});
      if (self.thread) given.thread = std::thread(task, context);
      return &given;
    };
    const auto finish = [](void* handle, void* user) {
      auto& self = *static_cast<TestDoor*>(user);
      EXPECT_EQ(std::this_thread::get_id(), self.caller) << "only the caller may use the door";
      ++self.finished;
      auto& given = *static_cast<Given*>(handle);
      if (given.thread.joinable()) given.thread.join();
      if (self.run_in_finish) given.task(given.context);
      if (self.run_again_in_finish) given.task(given.context);
    };
    return {enqueue, finish, this, workers};
  }
};

// Runs the frames through the door; expects the serial bits.
DoorFaults FaultsOf(TestDoor& door) {
  DoorExecutor executor(door.door());
  EXPECT_EQ(SyntheticFrames::Run(executor), SerialDigest());
  EXPECT_EQ(door.finished, door.given.size()) << "every handle is finished, and once";
  return executor.faults();
}

TEST(DoorExecutor, RunsOnThreadsThatStartWithEveryTask) {
  TestDoor door{.thread = true};
  EXPECT_FALSE(FaultsOf(door).Any());
  EXPECT_GT(door.given.size(), 0u);
}

TEST(DoorExecutor, RunsInlineAndThenHasNothingToFinish) {
  TestDoor door{.run_in_enqueue = true, .return_null = true};
  EXPECT_FALSE(FaultsOf(door).Any());
  EXPECT_EQ(door.finished, 0u);
  EXPECT_GT(door.names.size(), 0u);
}

TEST(DoorExecutor, ATaskThatStartsAtFinishFindsNothingToDo) {
  TestDoor door{.run_in_finish = true};
  EXPECT_FALSE(FaultsOf(door).Any());
  // The caller never waits for them, and asks for no more while they are outstanding.
  EXPECT_EQ(door.given.size(), (door.workers - 1) * SyntheticFrames::kFrames);
}

TEST(DoorExecutor, OneWorkerAsksForNothing) {
  TestDoor door{.workers = 1};
  EXPECT_FALSE(FaultsOf(door).Any());
  EXPECT_EQ(door.names.size(), 0u);
}

TEST(DoorExecutor, NeverEnqueuesMoreThanItStates) {
  SyntheticFrames frames;
  const Frame frame = frames.frame();
  for (const uint32_t workers : {1u, 2u, 3u, 64u, 300u}) {
    TestDoor door{.thread = true, .workers = workers};
    DoorExecutor executor(door.door());
    const uint32_t most = executor.MaxTasks(*frame.plan, *frame.memory->shape);
    EXPECT_EQ(most, std::min(workers - 1, 129u)) << "the largest pass has 130 chunks";
    for (uint32_t f = 0; f < 5; ++f) {
      const uint64_t before = executor.TasksEnqueued();
      executor.Run(frame);
      EXPECT_LE(executor.TasksEnqueued() - before, most);
    }
    EXPECT_EQ(executor.TasksEnqueued(), door.names.size());
  }
}

TEST(DoorExecutor, AsksForNoMoreWhenItsTasksAreLost) {
  TestDoor door{.workers = 3};
  DoorExecutor executor(door.door(), 2);
  EXPECT_EQ(SyntheticFrames::Run(executor), SerialDigest());
  EXPECT_EQ(executor.TasksEnqueued(), 4u) << "those of two frames";
  EXPECT_EQ(executor.faults().not_returned, 4u);
}

TEST(DoorExecutor, NamesTasks) {
  TestDoor door{.run_in_finish = true, .workers = 2};
  FaultsOf(door);
  EXPECT_EQ(door.names.count("pelt"), door.names.size());
}

TEST(DoorExecutor, ProfilesWorkers) {
  SyntheticFrames frames;
  Frame frame = frames.frame();
  FrameRecording recording(*frame.plan, *frame.memory->shape);
  frame.profile = recording.profile();
  // Inline, all of the frame runs in the first task: worker 1.
  TestDoor door{.run_in_enqueue = true, .return_null = true};
  DoorExecutor executor(door.door());
  executor.Run(frame);
  EXPECT_EQ(recording.Item(0, 0).worker, 1u);
  for (uint32_t p = 0; p < frame.plan->passes.size(); ++p) EXPECT_TRUE(recording.Pass(p).Ran());
}

// ---- Doors that break their promises ------------------------------------------------------------

TEST(DoorFaults, StartedTwice) {
  TestDoor door{.run_in_enqueue = true, .run_again_in_finish = true};
  const DoorFaults faults = FaultsOf(door);
  EXPECT_EQ(faults.started_again, door.given.size());
  EXPECT_EQ(faults.not_returned, 0u);
  EXPECT_NE(faults.Text().find("called again"), std::string::npos) << faults.Text();
}

TEST(DoorFaults, StartedAgainAfterFinish) {
  TestDoor door{.run_in_enqueue = true, .workers = 2};
  DoorExecutor executor(door.door());
  SyntheticFrames frames;
  executor.Run(frames.frame());
  ASSERT_FALSE(door.given.empty());
  for (auto& given : door.given) given.task(given.context);  // between two frames
  EXPECT_EQ(executor.faults().started_again, door.given.size());
  executor.Run(frames.frame());
  EXPECT_EQ(executor.faults().not_returned, 0u);
}

TEST(DoorFaults, NeverRun) {
  TestDoor door;
  const DoorFaults faults = FaultsOf(door);
  EXPECT_EQ(faults.not_returned, door.given.size());
  EXPECT_NE(faults.Text().find("had not returned"), std::string::npos) << faults.Text();
  // Tasks that the engine kept may come at any time: they do no harm, and are not lent again.
  std::set<void*> contexts;
  for (const auto& given : door.given) contexts.insert(given.context);
  EXPECT_EQ(contexts.size(), door.given.size());
}

TEST(DoorFaults, AKeptTaskThatComesInALaterFrameDoesNoHarm) {
  TestDoor door{.workers = 3};
  DoorExecutor executor(door.door());
  SyntheticFrames frames;
  for (uint32_t f = 0; f < SyntheticFrames::kFrames; ++f) {
    executor.Run(frames.frame());
    for (auto& given : door.given)
      if (!given.started) given.started = true, given.task(given.context);
  }
  EXPECT_EQ(frames.Digest(), SerialDigest());
  EXPECT_EQ(executor.faults().not_returned, door.given.size());
}

TEST(DoorFaults, NullThoughNotRun) {
  TestDoor door{.return_null = true};
  const DoorFaults faults = FaultsOf(door);
  EXPECT_GT(faults.not_returned, 0u);
}

// A kernel that holds every thread but the caller's until the caller has run an item too.
struct HoldHelpers {
  static constexpr std::string_view kName = "hold_helpers";
  using Ports = conformance::StirChunk::Ports;
  static inline std::thread::id caller;
  static inline std::atomic<uint32_t> inside{0};
  static inline std::atomic<bool> released{false};
  static void Run(const Ports&) {
    if (std::this_thread::get_id() == caller) {
      released = true;
    } else {
      ++inside;
      while (!released) std::this_thread::yield();
    }
  }
};

// Two helpers, so that the second is asked for while the first one's task runs: that task is its
// own still, or the end of one call would pass for the end of the other.
TEST(DoorFaults, NullThoughRunningElsewhere) {
  SyntheticFrames frames;
  const Frame frame = frames.frame();
  const auto plan = CompilePlan({{MakeKernelDesc<HoldHelpers>(), nullptr, Domain::kChunk}},
                                *frame.memory->shape, {});
  ASSERT_TRUE(plan) << plan.error();
  HoldHelpers::caller = std::this_thread::get_id();
  HoldHelpers::inside = 0;
  HoldHelpers::released = false;
  struct Door {
    std::deque<std::thread> threads;
    std::set<void*> contexts;
  } self;
  const auto enqueue = [](PeltTask task, void* context, void* user, const char*) -> void* {
    auto& door = *static_cast<Door*>(user);
    door.contexts.insert(context);
    door.threads.emplace_back(task, context);
    while (HoldHelpers::inside < door.threads.size()) std::this_thread::yield();
    return nullptr;
  };
  DoorExecutor executor({enqueue, [](void*, void*) {}, &self, 3});
  executor.Run({&*plan, frame.memory});
  for (std::thread& thread : self.threads) thread.join();
  EXPECT_EQ(self.threads.size(), 2u);
  EXPECT_EQ(self.contexts.size(), 2u) << "a task that runs was lent again";
  EXPECT_EQ(executor.faults().not_returned, 2u);
  EXPECT_EQ(executor.faults().started_again, 0u);
}

// Threads that cannot have come to their end when finish returns: they start when the frame is
// over.
TEST(DoorFaults, FinishDoesNotWait) {
  struct Door {
    std::atomic<bool> go{false};
    std::deque<std::thread> threads;
  } self;
  const auto enqueue = [](PeltTask task, void* context, void* user, const char*) -> void* {
    auto& door = *static_cast<Door*>(user);
    door.threads.emplace_back([&door, task, context] {
      while (!door.go) std::this_thread::yield();
      task(context);
    });
    return &door;
  };
  DoorExecutor executor({enqueue, [](void*, void*) {}, &self, 3});
  EXPECT_EQ(SyntheticFrames::Run(executor), SerialDigest());
  self.go = true;
  for (std::thread& thread : self.threads) thread.join();
  EXPECT_EQ(executor.faults().not_returned, self.threads.size());
}

TEST(DoorFaults, AnUnusableDoorIsSaidAndTheCallerRunsEverything) {
  TestDoor test;
  EngineDoor no_enqueue = test.door(), no_finish = test.door(), no_workers = test.door();
  no_enqueue.enqueue = nullptr;
  no_finish.finish = nullptr;
  no_workers.worker_count = 0;
  for (const EngineDoor& door : {no_enqueue, no_finish, no_workers}) {
    DoorExecutor executor(door);
    EXPECT_EQ(SyntheticFrames::Run(executor), SerialDigest());
    EXPECT_TRUE(executor.faults().Any());
    EXPECT_NE(executor.faults().Text().find("not used"), std::string::npos);
    EXPECT_EQ(executor.TasksEnqueued(), 0u);
  }
}

// From inside a frame: the door runs another frame with the same executor.
// Of every third call of enqueue, and of finish: the frames are right, and each later one asks again.
TEST(DoorFaults, ExceptionsAreSaidAndTheNextFrameAsksAgain) {
  struct Door {
    uint32_t enqueued = 0, finished = 0;
  } user;
  const auto enqueue = [](PeltTask task, void* context, void* door, const char*) -> void* {
    if (++static_cast<Door*>(door)->enqueued % 3 == 0) throw std::bad_alloc();
    task(context);
    return door;
  };
  const auto finish = [](void*, void* door) {
    if (++static_cast<Door*>(door)->finished % 3 == 0) throw 1;
  };
  DoorExecutor executor({enqueue, finish, &user, 4});
  uint64_t threw = 0;
  for (int run = 0; run < 3; ++run) {
    const uint32_t before = user.enqueued;
    EXPECT_EQ(SyntheticFrames::Run(executor), SerialDigest());
    EXPECT_GT(user.enqueued, before);
    const DoorFaults faults = executor.faults();
    EXPECT_GT(faults.threw, threw);
    EXPECT_EQ(faults.run_while_running + faults.not_returned + faults.started_again, 0u);
    EXPECT_NE(faults.Text().find("threw an exception"), std::string::npos) << faults.Text();
    threw = faults.threw;
  }
}

TEST(DoorFaults, AFrameInsideAFrameIsSaidAndRunsSerially) {
  struct Nested {
    DoorExecutor* executor = nullptr;
    SyntheticFrames* inner = nullptr;
    uint32_t runs = 0;
  } nested;
  const auto enqueue = [](PeltTask task, void* context, void* user, const char*) -> void* {
    auto& self = *static_cast<Nested*>(user);
    if (self.runs < SyntheticFrames::kFrames) ++self.runs, self.executor->Run(self.inner->frame());
    task(context);
    return nullptr;
  };
  SyntheticFrames outer, inner;
  DoorExecutor executor({enqueue, [](void*, void*) {}, &nested, 4});
  nested = {&executor, &inner};
  for (uint32_t f = 0; f < SyntheticFrames::kFrames; ++f) executor.Run(outer.frame());
  EXPECT_EQ(outer.Digest(), SerialDigest());
  EXPECT_EQ(nested.runs, executor.faults().run_while_running);
  EXPECT_GT(nested.runs, 0u);
}

}  // namespace
}  // namespace pelt
