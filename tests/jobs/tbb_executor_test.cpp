// The oneTBB executor: as many threads as asked for, every item once, a barrier after every pass,
// and the serial executor's bits.
#include "jobs/tbb_executor.hpp"

#include <gtest/gtest.h>

#include <thread>

#include "tests/determinism/planted_faults.hpp"
#include "tests/jobs/synthetic_scene.hpp"

namespace pelt::testing {
namespace {

constexpr FaultParams kParams{77};

template <class K>
Stage FaultStage() {
  return MakeStage<K>(Domain::kChunk, kParams);
}

// Five passes that all depend on each other across chunks: a missing barrier would show.
std::vector<Stage> CrossingFrame() {
  return {FaultStage<Advance>(),
          FaultStage<GathersAcrossTheLayer>(),
          FaultStage<Advance>(),
          FaultStage<ScatterStrands<false>>(),
          FaultStage<GathersAcrossTheLayer>(),
          FaultStage<Advance>()};
}

uint64_t RunFrames(Executor& executor) {
  SyntheticScene scene({{0, 0, 90}, {0, 0, 1}, {1, 0, 37}});
  for (uint32_t c = 0; c < scene.shape().chunk_count; ++c) {
    auto* list = reinterpret_cast<uint32_t*>(scene.memory().Block(StreamOf<&Toys::pairs_a>, c));
    const uint32_t places = scene.shape().LayerChunks(scene.shape().chunk_layer[c]) * kToyLanes;
    for (uint32_t i = 0; i < kToyLanes; ++i) list[i] = (i * 7919 + c) % places;
  }
  const Plan plan = CompilePlan(CrossingFrame(), scene.shape(), {}).OrThrow();
  EXPECT_EQ(plan.passes.size(), 5u);
  Digest digest;
  for (int frame = 0; frame < 10; ++frame) {
    executor.Run({&plan, &scene.memory()});
    digest.Add64(scene.DigestOf({StreamOf<&Toys::keys>, StreamOf<&Toys::order>}));
  }
  return digest.Value();
}

TEST(TbbExecutor, GivesTheSerialBitsOnAnyNumberOfWorkers) {
  SerialExecutor serial;
  const uint64_t truth = RunFrames(serial);
  for (const uint32_t workers : {1u, 2u, 3u, 7u}) {
    TbbExecutor executor(workers);
    EXPECT_EQ(executor.workers(), workers);
    EXPECT_EQ(RunFrames(executor), truth) << workers << " workers";
  }
}

// oneTBB silently gives an arena fewer threads than it was asked for.
TEST(TbbExecutor, ReallyRunsOnAsManyThreadsAsAsked) {
  for (const uint32_t workers : {1u, 2u, 3u, 7u}) {
    TbbExecutor executor(workers);
    EXPECT_EQ(executor.ObservedWorkers(), workers);
  }
}

TEST(TbbExecutor, ZeroMeansOneForEachCore) {
  TbbExecutor executor(0);
  EXPECT_EQ(executor.workers(), std::max(1u, std::thread::hardware_concurrency()));
}

}  // namespace
}  // namespace pelt::testing
