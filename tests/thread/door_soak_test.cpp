// The pull interface and the door on plain threads, many frames of many short passes, under the
// thread sanitizer where it is on: late threads crossing frames, helpers leaving and coming, tasks
// called twice. (OpenMP and oneTBB synchronise in ways the sanitizer does not know: not here.)
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

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
      shapes_.emplace_back().AddLayer(0, 0, count);
    }
    memory_.resize(chunks.size());
    for (size_t f = 0; f < chunks.size(); ++f) memory_[f].shape = &shapes_[f];
    for (uint32_t p = 0; p < 6; ++p) {
      Pass pass{};
      pass.domain = p % 3 == 1 ? Domain::kLayer : Domain::kChunk;
      pass.first_stage = 0;
      pass.stage_count = 1;
      plan_.passes.push_back(pass);
    }
    const KernelDesc yield{"yield", nullptr, {}, 0, &YieldSometimes};
    plan_.stages.push_back({yield, nullptr, Domain::kScene});
  }
  Frame frame(size_t f) const { return {&plan_, &memory_[f % memory_.size()]}; }

 private:
  Plan plan_;
  std::vector<SceneShape> shapes_;
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
