// The pull interface and the door on plain threads, many frames of many short passes, under the
// thread sanitizer where it is on: late threads crossing frames, helpers leaving and coming, tasks
// called late, twice or never. (OpenMP and oneTBB synchronise in ways the sanitizer does not know: not here.)
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <deque>
#include <thread>
#include <utility>
#include <vector>

#include "core/random.hpp"
#include "jobs/adapters/pull_pool.hpp"
#include "jobs/adapters/thread_pool_door.hpp"
#include "jobs/conformance.hpp"
#include "tests/jobs/tiny_scene.hpp"

namespace pelt::testing {
namespace {

std::atomic<uint64_t> items_run{0};

// Gives the core away now and then, in the middle of an item.
void YieldSometimes(const void*, const Binding*) {
  if (items_run.fetch_add(1, std::memory_order_relaxed) % 5 == 0) std::this_thread::yield();
}

// Frames in which an item is next to nothing: all that happens is scheduling.
class EmptyFrames {
 public:
  explicit EmptyFrames(const std::vector<uint32_t>& chunks) {
    for (const uint32_t count : chunks) {
      SceneShape& shape = shapes_.emplace_back();
      shape.AddLayer(0, 0, count);
      shape.AddLayer(0, 0, count / 2);
      memory_.emplace_back().shape = &shape;
      plans_.push_back(MakePlan(shape));
    }
  }
  Frame frame(size_t f) const { return {&plans_[f % plans_.size()], &memory_[f % memory_.size()]}; }
  // Runs frame f; every item must run once.
  void Run(Executor& executor, size_t f) const {
    const uint64_t before = items_run;
    executor.Run(frame(f));
    ASSERT_EQ(items_run - before, frame(f).plan->graph.items.size()) << "frame " << f;
  }

 private:
  // Waits of every kind.
  static Plan MakePlan(const SceneShape& shape) {
    const Domain chunk = Domain::kChunk, layer = Domain::kLayer, scene = Domain::kScene;
    const std::pair<Domain, std::vector<Wait>> passes[] = {
        {chunk, {}},           {layer, {{0, layer}}}, {chunk, {{1, layer}}},
        {chunk, {{2, chunk}}}, {layer, {{3, scene}}}, {chunk, {{3, layer}, {4, layer}}}};
    Plan plan;
    for (const auto& [domain, waits] : passes)
      plan.passes.push_back({0, 1, domain, {}, 0, 0, 0, false, waits});
    const KernelDesc yield{"yield", nullptr, {}, 0, &YieldSometimes};
    plan.stages.push_back({yield, nullptr, scene});
    plan.waits_of_end = {{1, scene}, {4, scene}, {5, scene}};  // some layers have no chunks
    plan.graph = BuildGraph(plan, shape);
    return plan;
  }

  std::vector<Plan> plans_;
  std::deque<SceneShape> shapes_;
  std::vector<FrameMemory> memory_;
};

constexpr uint32_t kSoakFrames = 20'000;

TEST(DoorSoak, PollingThreadsCrossFrames) {
  EmptyFrames frames({5, 1, 0, 17});
  PullPool pool(4);
  for (uint32_t f = 0; f < kSoakFrames; ++f) frames.Run(pool, f);
}

TEST(DoorSoak, HelpersComeAndGo) {
  EmptyFrames frames({5, 1, 0, 17});
  ThreadPoolDoor pool(4);
  DoorExecutor executor(pool.door());
  for (uint32_t f = 0; f < kSoakFrames; ++f) frames.Run(executor, f);
  EXPECT_FALSE(executor.faults().Any()) << executor.faults().Text();
}

TEST(DoorSoak, SixteenThreads) {
  EmptyFrames frames({5, 1, 0, 170});
  PullPool polling(16);
  ThreadPoolDoor pool(16);
  DoorExecutor executor(pool.door());
  for (uint32_t f = 0; f < kSoakFrames / 40; ++f) {
    frames.Run(polling, f);
    frames.Run(executor, f);
  }
  EXPECT_FALSE(executor.faults().Any()) << executor.faults().Text();
}

// By a seed, an engine that calls a task as it should, late on another thread, before enqueue
// returns, when its frame is over, twice, or never.
class UnreliableEngine {
 public:
  UnreliableEngine(EngineDoor threads, uint64_t seed) : threads_(threads), random_(seed) {}
  EngineDoor door() { return {&Enqueue, &Finish, this, threads_.worker_count}; }

  uint64_t repeated = 0, unreturned = 0;

 private:
  enum Fate : uint32_t { kGood, kDelayed, kInline, kKept, kRepeated, kDropped, kFates };
  struct Given {
    PeltTask task;
    void* context;
    Fate fate;
    uint32_t delay;
    void* handle = nullptr;
  };

  static void* Enqueue(PeltTask task, void* context, void* user, const char* name) {
    auto& self = *static_cast<UnreliableEngine*>(user);
    self.CallKept();
    const uint64_t bits = self.random_.U64();
    Given& given = self.given_.emplace_back(
        Given{task, context, Fate(bits % kFates), uint32_t(bits >> 8) % 16});
    self.repeated += given.fate == kRepeated;
    if (given.fate == kKept || given.fate == kDropped) return &given;
    if (given.fate == kInline) return task(context), nullptr;
    given.handle = self.threads_.enqueue(&Call, &given, self.threads_.user, name);
    return &given;
  }
  static void Call(void* context) {
    // Not a copy: `handle` is being written by the thread that enqueued it.
    const Given& given = *static_cast<Given*>(context);
    for (uint32_t d = 0; given.fate == kDelayed && d < given.delay; ++d) std::this_thread::yield();
    for (uint32_t calls = given.fate == kRepeated ? 2 : 1; calls; --calls)
      given.task(given.context);
  }
  static void Finish(void* handle, void* user) {
    auto& self = *static_cast<UnreliableEngine*>(user);
    const Given& given = *static_cast<Given*>(handle);
    self.unreturned += given.fate == kKept || given.fate == kDropped;
    if (given.handle) self.threads_.finish(given.handle, self.threads_.user);
  }
  // Some that were kept, those of frames that are over and those of this one.
  void CallKept() {
    for (Given& given : given_)
      if (given.fate == kKept && random_.U64() % 4 == 0) given.fate = kGood, Call(&given);
  }

  EngineDoor threads_;
  Random random_;
  std::deque<Given> given_;
};

TEST(DoorSoak, AnEngineThatKeepsNoPromise) {
  constexpr uint32_t kFrames = 5;
  EmptyFrames frames({5, 1, 0, 17});
  ThreadPoolDoor pool(3);
  const char* asked = std::getenv("PELT_SCHEDULES");
  const uint32_t seeds = asked ? uint32_t(std::atoi(asked)) : 2000;
  for (uint32_t seed = 0; seed < seeds; ++seed) {
    UnreliableEngine engine(pool.door(), seed);
    DoorExecutor executor(engine.door(), kFrames);
    for (uint32_t f = 0; f < kFrames; ++f) frames.Run(executor, seed + f);
    EXPECT_EQ(executor.faults().started_again, engine.repeated) << "seed " << seed;
    EXPECT_EQ(executor.faults().not_returned, engine.unreturned) << "seed " << seed;
  }
}

TEST(DoorSoak, ConformanceOnThreads) {
  ThreadPoolDoor pool(4);
  const ConformanceReport report = CheckDoor(pool.door());
  EXPECT_TRUE(report.Passed()) << report.Text();
}

TEST(DoorSoak, WholeFrameGivesTheSerialBits) {
  Scenario scenario = TinyScenario();
  const auto truth = RunDigests(scenario, {}, 22);
  PullPool polling(16);
  ExpectSameFrames(truth, RunDigests(scenario, {}, polling, 22), "polling threads");
  ThreadPoolDoor pool(16);
  DoorExecutor executor(pool.door());
  ExpectSameFrames(truth, RunDigests(scenario, {}, executor, 22), "door");
}

}  // namespace
}  // namespace pelt::testing
