// The pull interface and the door on plain threads, many frames of many short passes, under the
// thread sanitizer where it is on: late threads crossing frames, helpers leaving and coming, tasks
// called twice. (OpenMP and oneTBB synchronise in ways the sanitizer does not know: not here.)
#include <gtest/gtest.h>

#include <atomic>
#include <deque>
#include <thread>
#include <utility>
#include <vector>

#include "jobs/adapters/pull_pool.hpp"
#include "jobs/adapters/thread_pool_door.hpp"
#include "jobs/conformance.hpp"
#include "tests/jobs/tiny_scene.hpp"

namespace pelt {
namespace {

using namespace testing;

// Gives the core away now and then, in the middle of an item.
void YieldSometimes(const void*, const Binding*) {
  static std::atomic<uint32_t> calls{0};
  if (calls.fetch_add(1, std::memory_order_relaxed) % 5 == 0) std::this_thread::yield();
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
  for (uint32_t f = 0; f < kSoakFrames; ++f) pool.Run(frames.frame(f));
}

TEST(DoorSoak, HelpersComeAndGo) {
  EmptyFrames frames({5, 1, 0, 17});
  ThreadPoolDoor pool(4);
  DoorExecutor executor(pool.door());
  for (uint32_t f = 0; f < kSoakFrames; ++f) executor.Run(frames.frame(f));
  EXPECT_FALSE(executor.faults().Any()) << executor.faults().Text();
}

TEST(DoorSoak, ConformanceOnThreads) {
  ThreadPoolDoor pool(4);
  const ConformanceReport report = CheckDoor(pool.door());
  EXPECT_TRUE(report.Passed()) << report.Text();
}

TEST(DoorSoak, WholeFrameGivesTheSerialBits) {
  Scenario scenario = TinyScenario();
  SerialExecutor serial;
  const auto truth = RunDigests(scenario, {}, serial, 22);
  PullPool polling(3);
  ExpectSameFrames(truth, RunDigests(scenario, {}, polling, 22), "polling threads");
  ThreadPoolDoor pool(3);
  DoorExecutor executor(pool.door());
  ExpectSameFrames(truth, RunDigests(scenario, {}, executor, 22), "door");
}

}  // namespace
}  // namespace pelt
