// The pull interface: every item once, passes in order, at any time and by anyone.
#include "jobs/pull_executor.hpp"

#include <gtest/gtest.h>

#include <array>

#include "jobs/conformance.hpp"
#include "jobs/frame_recording.hpp"

namespace pelt {
namespace {

using conformance::SyntheticFrames;

TEST(PullExecutor, RunGivesTheSerialBits) {
  PullExecutor pull;
  SerialExecutor serial;
  EXPECT_EQ(SyntheticFrames::Run(pull), SyntheticFrames::Run(serial));
}

TEST(PullExecutor, RunsOneItemACallAndIsIdleAfterTheLast) {
  SyntheticFrames frames;
  PullExecutor pull;
  EXPECT_EQ(pull.TryRun(), PullResult::kIdle) << "no frame was begun";
  const Plan& plan = *frames.frame().plan;
  uint32_t items = 0;
  for (const Pass& pass : plan.passes)
    items += frames.frame().memory->shape->ItemCount(pass.domain);
  for (uint32_t f = 0; f < SyntheticFrames::kFrames; ++f) {
    ASSERT_TRUE(pull.Begin(frames.frame()));
    for (uint32_t i = 0; i < items; ++i) {
      EXPECT_FALSE(pull.IsIdle());
      ASSERT_EQ(pull.TryRun(), PullResult::kRan);
    }
    EXPECT_TRUE(pull.IsIdle());
    EXPECT_EQ(pull.TryRun(), PullResult::kIdle);
  }
  SerialExecutor serial;
  EXPECT_EQ(frames.Digest(), SyntheticFrames::Run(serial));
}

TEST(PullExecutor, RefusesAFrameWhileAnotherIsOpenAndLosesNothing) {
  SyntheticFrames frames, other;
  PullExecutor pull;
  ASSERT_TRUE(pull.Begin(frames.frame()));
  EXPECT_EQ(pull.TryRun(), PullResult::kRan);
  EXPECT_FALSE(pull.Begin(other.frame()));
  while (pull.TryRun() != PullResult::kIdle) {
  }
  EXPECT_TRUE(pull.Begin(other.frame()));
  while (pull.TryRun() != PullResult::kIdle) {
  }
  EXPECT_EQ(frames.Digest(), other.Digest());
}

TEST(PullExecutor, RunWorksOffAnOpenFrameFirst) {
  SyntheticFrames frames, other;
  PullExecutor pull;
  ASSERT_TRUE(pull.Begin(frames.frame()));
  pull.Run(other.frame());
  EXPECT_TRUE(pull.IsIdle());
  EXPECT_EQ(frames.Digest(), other.Digest());
}

// A pass of no items, and a frame of none at all.
TEST(PullExecutor, PassesOfNoItemsAreSkipped) {
  const SceneShape shape;
  const Plan plan = CompilePlan(SyntheticFrames().frame().plan->stages, shape, {}).OrThrow();
  conformance::SumBlock scene{};
  const FrameMemory memory = PlaceStreams(*plan.table, shape, reinterpret_cast<std::byte*>(&scene));
  PullExecutor pull;
  FrameRecording recording(plan, shape);
  ASSERT_TRUE(pull.Begin({&plan, &memory, recording.profile()}));
  EXPECT_FALSE(pull.IsIdle()) << "the scene has one item";
  EXPECT_EQ(pull.TryRun(), PullResult::kRan);
  EXPECT_TRUE(pull.IsIdle());
  const Plan none = CompilePlan({}, shape, {}).OrThrow();
  ASSERT_TRUE(pull.Begin({&none, &memory}));
  EXPECT_TRUE(pull.IsIdle());
}

TEST(PullExecutor, ProfilesPassesItemsAndWorkers) {
  SyntheticFrames frames;
  Frame frame = frames.frame();
  FrameRecording recording(*frame.plan, *frame.memory->shape);
  frame.profile = recording.profile();
  PullExecutor pull;
  ASSERT_TRUE(pull.Begin(frame));
  for (uint32_t call = 0; pull.TryRun(call % 3) == PullResult::kRan; ++call) {
  }
  std::array<uint32_t, 3> ran{};  // by worker
  for (uint32_t p = 0; p < frame.plan->passes.size(); ++p) {
    ASSERT_TRUE(recording.Pass(p).Ran());
    const uint32_t items = frame.memory->shape->ItemCount(frame.plan->passes[p].domain);
    for (uint32_t i = 0; i < items; ++i) {
      const ItemSlice& item = recording.Item(p, i);
      ASSERT_LT(item.worker, 3u);
      ++ran[item.worker];
      EXPECT_GE(item.begin_ticks, recording.Pass(p).begin_ticks);
      EXPECT_LE(item.end_ticks, recording.Pass(p).end_ticks);
    }
  }
  EXPECT_LE(ran[0] - ran[2], 1u) << "they alternated";
}

}  // namespace
}  // namespace pelt
