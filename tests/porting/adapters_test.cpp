// Every adapter in jobs/adapters, through the conformance checks and the whole frame of `tiny`.
#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>

#include "jobs/adapters/openmp_door.hpp"
#include "jobs/adapters/pull_pool.hpp"
#include "jobs/adapters/tbb_door.hpp"
#include "jobs/adapters/thread_pool_door.hpp"
#include "jobs/conformance.hpp"
#include "tests/jobs/tiny_scene.hpp"

#if defined(PELT_HAS_BULLET)
#include "jobs/adapters/bullet_door.hpp"
#endif

namespace pelt::testing {
namespace {

void ExpectConforms(const EngineDoor& door, const ConformanceOptions& options = {}) {
  const ConformanceReport report = CheckDoor(door, options);
  EXPECT_TRUE(report.Passed()) << report.Text();
  EXPECT_EQ(report.checks.size(), ConformanceCheckNames().size());
}

const std::vector<uint64_t>& SerialFrames() {
  static const std::vector<uint64_t> kTruth = [] {
    Scenario scenario = TinyScenario();
    return RunDigests(scenario, {}, 22);
  }();
  return kTruth;
}

std::vector<uint64_t> FramesOf(Executor& executor) {
  Scenario scenario = TinyScenario();
  return RunDigests(scenario, {}, executor, 22);
}

void ExpectSerialBits(DoorExecutor& executor, const std::string& what) {
  ExpectSameFrames(SerialFrames(), FramesOf(executor), what);
  EXPECT_FALSE(executor.faults().Any()) << executor.faults().Text();
}

TEST(Adapters, ThreadPoolConforms) {
  for (const uint32_t workers : {1u, 2u, 5u}) {
    ThreadPoolDoor pool(workers);
    EXPECT_EQ(pool.ObservedWorkers(), workers);
    ExpectConforms(pool.door());
    DoorExecutor executor(pool.door());
    ExpectSerialBits(executor, std::to_string(workers) + " threads");
    EXPECT_EQ(executor.TasksEnqueued() > 0, workers > 1);
  }
}

TEST(Adapters, ThreadPoolRunsTasksInlineWhenItsPlacesAreTaken) {
  ThreadPoolDoor pool(1);
  const EngineDoor door = pool.door();
  const auto count = [](void* context) { ++*static_cast<uint32_t*>(context); };
  uint32_t calls = 0, inline_calls = 0;
  std::vector<void*> handles;
  for (uint32_t t = 0; t < 5000; ++t) {
    handles.push_back(door.enqueue(count, &calls, door.user, "count"));
    inline_calls += handles.back() == nullptr;
  }
  EXPECT_GT(inline_calls, 0u);
  EXPECT_EQ(calls, inline_calls);
  for (void* handle : handles)
    if (handle) door.finish(handle, door.user);
  EXPECT_EQ(calls, 5000u);
}

TEST(Adapters, PullPoolGivesTheSerialBits) {
  for (const uint32_t workers : {1u, 2u, 5u}) {
    PullPool pool(workers);
    EXPECT_EQ(pool.ObservedWorkers(), workers);
    ExpectSameFrames(SerialFrames(), FramesOf(pool), std::to_string(workers) + " polling");
  }
}

TEST(Adapters, OneTbbConforms) {
  constexpr uint32_t kWorkers = 3;
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, kWorkers);
  tbb::task_arena arena(kWorkers);
  TbbDoor tasks(kWorkers);
  ConformanceOptions options;
  options.enter = [&](const auto& body) { arena.execute(body); };
  ExpectConforms(tasks.door(), options);
  DoorExecutor executor(tasks.door());
  arena.execute([&] { ExpectSerialBits(executor, "oneTBB"); });
}

TEST(Adapters, OpenMpConforms) {
#if defined(_OPENMP)
  omp_set_num_threads(3);
  ExpectConforms(OpenMpDoor());  // outside a team: every task where it is created
  ConformanceOptions options;
  options.enter = [](const auto& body) {
    omp_set_num_threads(3);
    RunInOpenMpTeam(body);
  };
  ExpectConforms(OpenMpDoor(), options);
  DoorExecutor executor(OpenMpDoor());
  RunInOpenMpTeam([&] { ExpectSerialBits(executor, "OpenMP"); });
#else
  ExpectConforms(OpenMpDoor());
  GTEST_SKIP() << "this compiler has no OpenMP here: only the fallback was tried";
#endif
}

#if defined(PELT_HAS_BULLET)
// What an application with a threaded Bullet gives it: iterations in no order on threads of its
// own.
class ThreadedScheduler final : public btITaskScheduler {
 public:
  explicit ThreadedScheduler(int threads) : btITaskScheduler("threads"), threads_(threads) {}
  int getMaxNumThreads() const override { return threads_; }
  int getNumThreads() const override { return threads_; }
  void setNumThreads(int threads) override { threads_ = threads; }
  void parallelFor(int begin, int end, int, const btIParallelForBody& body) override {
    std::vector<std::thread> threads;
    for (int i = end - 1; i > begin; --i)
      threads.emplace_back([&body, i] { body.forLoop(i, i + 1); });
    body.forLoop(begin, begin + 1);
    for (std::thread& thread : threads) thread.join();
  }
  btScalar parallelSum(int begin, int end, int, const btIParallelSumBody& body) override {
    return body.sumLoop(begin, end);
  }

 private:
  int threads_;
};
#endif

TEST(Adapters, BulletConforms) {
#if defined(PELT_HAS_BULLET)
  ThreadedScheduler threaded(3);
  for (btITaskScheduler* scheduler :
       {btGetSequentialTaskScheduler(), static_cast<btITaskScheduler*>(&threaded)}) {
    BulletDoor bullet(*scheduler);
    ConformanceOptions options;
    options.enter = [&](const auto& body) { bullet.Run(body); };
    ExpectConforms(bullet.door(), options);
    DoorExecutor executor(bullet.door());
    bullet.Run([&] { ExpectSerialBits(executor, scheduler->getName()); });
  }
#else
  GTEST_SKIP() << "Bullet was not found when this was built";
#endif
}

// The tiny scenario as the caller's own course: what an engine with scenes of its own would do.
TEST(Adapters, ConformanceRunsTheCallersFrames) {
  ThreadPoolDoor pool(3);
  const auto course = [](Executor& executor) {
    Digest digest;
    for (const uint64_t frame : FramesOf(executor)) digest.Add64(frame);
    return digest.Value();
  };
  const ConformanceReport report = CheckDoor(pool.door(), course);
  EXPECT_TRUE(report.Passed()) << report.Text();
}

}  // namespace
}  // namespace pelt::testing
