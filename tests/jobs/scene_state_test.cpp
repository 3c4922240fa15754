// A scene that takes over another's state goes on as the other does.
#include <gtest/gtest.h>

#include "tests/jobs/tiny_scene.hpp"

namespace pelt {
namespace {

using namespace testing;

uint64_t RunOne(RunningScenario& running, uint32_t frame) {
  running.Begin(frame);
  SerialExecutor().Run(running.scene().CurrentFrame());
  return running.scene().DigestFrame();
}

TEST(FurSceneState, CopiedMidwayBothGoOnAlike) {
  Scenario scenario = TinyScenario();
  RunningScenario straight(scenario, {}), other(scenario, {});
  for (uint32_t f = 0; f < 12; ++f) RunOne(straight, f);
  RunOne(other, 0);  // elsewhere on its course, and no first frame any more
  ASSERT_TRUE(other.scene().CopyStateFrom(straight.scene()));
  EXPECT_EQ(other.scene().DigestFrame(), straight.scene().DigestFrame());
  for (uint32_t f = 12; f < 24; ++f)  // the teleport of frame 20 is in it
    ASSERT_EQ(RunOne(straight, f), RunOne(other, f)) << "frame " << f;
}

TEST(FurSceneState, GoesBackToAnEarlierFrame) {
  Scenario scenario = TinyScenario();
  RunningScenario running(scenario, {}), kept(scenario, {});
  for (uint32_t f = 0; f < 6; ++f) RunOne(running, f);
  ASSERT_TRUE(kept.scene().CopyStateFrom(running.scene()));
  std::vector<uint64_t> first;
  for (uint32_t f = 6; f < 10; ++f) first.push_back(RunOne(running, f));
  ASSERT_TRUE(running.scene().CopyStateFrom(kept.scene()));
  for (uint32_t f = 6; f < 10; ++f) ASSERT_EQ(RunOne(running, f), first[f - 6]) << "frame " << f;
}

TEST(FurSceneState, OfAnotherShapeIsRefusedAndNothingIsDone) {
  Scenario scenario = TinyScenario(), longer = TinyScenario();
  longer.actors.push_back(longer.actors[0]);
  RunningScenario one(scenario, {}), two(longer, {});
  RunOne(one, 0);
  const uint64_t before = one.scene().DigestFrame();
  EXPECT_FALSE(one.scene().CopyStateFrom(two.scene()));
  EXPECT_FALSE(two.scene().CopyStateFrom(one.scene()));
  EXPECT_EQ(one.scene().DigestFrame(), before);
  // Of the same memory, but sorted in pieces: other stages run.
  SceneOptions pieces;
  pieces.piecewise_sort_chunks = 1;
  RunningScenario sorted_in_pieces(scenario, pieces);
  EXPECT_FALSE(one.scene().CopyStateFrom(sorted_in_pieces.scene()));
}

}  // namespace
}  // namespace pelt
