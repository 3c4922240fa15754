// The whole frame under the thread sanitizer, on plain std::threads: oneTBB's own synchronisation
// is unknown to the sanitizer, so it is not in this program. In builds without the sanitizer the
// same frames are compared with the serial bits.
#include <gtest/gtest.h>

#include <atomic>
#include <barrier>
#include <thread>
#include <vector>

#include "jobs/pass_loop.hpp"
#include "tests/jobs/synthetic_scene.hpp"
#include "tests/jobs/tiny_scene.hpp"

#if defined(__SANITIZE_THREAD__)
#define PELT_THREAD_SANITIZER 1
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define PELT_THREAD_SANITIZER 1
#endif
#endif

namespace pelt::testing {
namespace {

// Hands out the items of a pass by a counter (or, interleaved, item i to thread i % n, so that
// neighbours always meet), with a barrier after every pass. The counter orders nothing by itself:
// only the barrier does, as in any executor.
class ThreadExecutor final : public Executor {
 public:
  explicit ThreadExecutor(uint32_t threads, bool interleaved = false)
      : threads_(threads), interleaved_(interleaved) {}

  void RunPasses(const Frame& frame) override {
    const size_t passes = frame.plan->passes.size();
    std::vector<std::atomic<uint32_t>> next(passes);
    std::barrier<> end_of_pass{std::ptrdiff_t(threads_)};
    const auto work = [&](uint32_t self) {
      for (uint32_t p = 0; p < passes; ++p) {
        const uint32_t count = frame.memory->shape->ItemCount(frame.plan->passes[p].domain);
        if (interleaved_) {
          for (uint32_t i = self; i < count; i += threads_) RunItem(frame, p, i);
        } else {
          for (uint32_t i; (i = next[p].fetch_add(1, std::memory_order_relaxed)) < count;)
            RunItem(frame, p, i);
        }
        end_of_pass.arrive_and_wait();
      }
    };
    std::vector<std::thread> threads;
    for (uint32_t t = 1; t < threads_; ++t) threads.emplace_back(work, t);
    work(0);
    for (std::thread& thread : threads) thread.join();
  }

 private:
  uint32_t threads_;
  bool interleaved_;
};

TEST(Threads, WholeFrameGivesTheSerialBits) {
  Scenario scenario = TinyScenario();
  const auto truth = RunDigests(scenario, {}, 22);
  for (const uint32_t threads : {2u, 3u, 7u})
    for (const bool interleaved : {false, true}) {
      ThreadExecutor executor(threads, interleaved);
      ExpectSameFrames(truth, RunDigests(scenario, {}, executor, 22),
                       std::to_string(threads) + " threads");
    }
}

TEST(Threads, SortInPiecesAndUnfusedGiveTheSerialBits) {
  Scenario scenario = TinyScenario();
  const auto truth = RunDigests(scenario, {}, 6);
  SceneOptions options;
  options.piecewise_sort_chunks = 1;
  options.plan.fuse = false;
  ThreadExecutor executor(3, true);
  ExpectSameFrames(truth, RunDigests(scenario, options, executor, 6), "pieces, unfused");
}

// The kernels' way of reading a neighbour is harmless on one thread; here it races.
struct ReadsMovingNeighbour {
  static constexpr std::string_view kName = "reads_moving_neighbour";
  struct Ports {
    InOut<&Toys::keys> keys;
  };
  static void Run(const Ports& ports) {
    KeyBlock* own = ports.keys.block;
    asm volatile("" : "+r"(own));
    own->key[0] += own[1].key[0];
  }
};

void RunPlantedRace() {
  SyntheticScene scene({{0, 0, 64}});
  const Plan plan =
      CompilePlan({MakeStage<ReadsMovingNeighbour>(Domain::kChunk)}, scene.shape(), {}).OrThrow();
  ThreadExecutor executor(4, true);
  for (int frame = 0; frame < 20; ++frame) executor.Run({&plan, &scene.memory()});
}

TEST(ThreadsDeathTest, PlantedRaceIsCaught) {
#if defined(PELT_THREAD_SANITIZER)
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_DEATH(
      {
        RunPlantedRace();
        std::exit(0);
      },
      "data race");
#else
  RunPlantedRace();
  GTEST_SKIP() << "no thread sanitizer in this build: nothing detects the race";
#endif
}

}  // namespace
}  // namespace pelt::testing
