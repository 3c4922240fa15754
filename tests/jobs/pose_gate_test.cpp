// A pose that cannot be used stops its character and no other: the others keep the bits of a
// scene in which nothing was wrong, and the character those of one whose pose was given again.
#include "jobs/pose_gate.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/bind_pose.hpp"
#include "jobs/adapters/pull_pool.hpp"
#include "jobs/tbb_executor.hpp"
#include "platform_sim/local_store.hpp"
#include "tests/jobs/pair_scene.hpp"

namespace pelt::testing {
namespace {

struct BadPose {
  const char* says;
  void (*spoil)(PoseBlock&);
};
const BadPose kBadPoses[] = {
    {"joint count is not its groom's", [](PoseBlock& p) { p.joint_count = 0; }},
    {"joint count is not its groom's", [](PoseBlock& p) { --p.joint_count; }},
    {"joint count is not its groom's", [](PoseBlock& p) { p.joint_count = kJointsPerCharacter; }},
    {"joint count is not its groom's", [](PoseBlock& p) { p.joint_count = ~0u; }},
    {"character 1: its root placement", [](PoseBlock& p) { p.root[3] = kNaN; }},
    {"root placement", [](PoseBlock& p) { p.root[3] = 1e9f; }},
    {"joint 2: its translation keys", [](PoseBlock& p) { p.translation_key[0][1][2] = kNaN; }},
    {"rotation keys", [](PoseBlock& p) { p.rotation_key[3][3][p.joint_count - 1] = -kInf; }},
    {"joint 1: its scale keys", [](PoseBlock& p) { p.scale_key[2][0][1] = kNaN; }},
    {"joint 0: its translation weights", [](PoseBlock& p) { p.translation_weight[1][0] = kNaN; }},
    {"rotation weights", [](PoseBlock& p) { p.rotation_weight[1][0] = kNaN; }},
    {"scale weights", [](PoseBlock& p) { p.scale_weight[1][0] = 1e7f; }},
    {"it takes the skin beyond 1e7 m",
     [](PoseBlock& p) {
       for (uint32_t j = 0; j < p.joint_count; ++j)
         for (int c = 0; c < 3; ++c) p.scale_key[0][c][j] = 1e6f;
     }},
    {"it takes the skin beyond 1e7 m",
     [](PoseBlock& p) {
       for (uint32_t j = 0; j < p.joint_count; ++j) p.translation_key[0][1][j] = -1e6f;
       for (float& w : p.translation_weight[0]) w = 1e6f;
     }},
};

// `bad` runs with a refused pose of character 1 in every third frame; `good` with the pose it had
// before. Frame by frame they must not differ in a bit, and character 0 not from the undisturbed.
void ExpectHeld(const BadPose& fault, Executor& executor, const SceneOptions& options) {
  Scenario scenario = PairScenario();
  RunningScenario bad(scenario, options), good(scenario, options);
  PoseBlock last{};
  for (uint32_t f = 0; f < 10; ++f) {
    const bool spoiled = f % 3 == 2;
    const FrameInput input = scenario.PrepareFrame(f, bad.scene());
    if (spoiled) fault.spoil(bad.scene().Pose(1));
    ASSERT_EQ(BeginError(bad.scene(), input), "");
    ASSERT_EQ(bad.scene().RefusedPoses().size(), spoiled ? 1u : 0u);
    if (spoiled) {
      const std::string text = DescribeRefusedPose(bad.scene().RefusedPoses()[0]);
      EXPECT_NE(text.find("pose of character 1"), std::string::npos) << text;
      EXPECT_NE(text.find(fault.says), std::string::npos) << text;
    }
    executor.Run(bad.scene().CurrentFrame());

    const FrameInput same = scenario.PrepareFrame(f, good.scene());
    if (spoiled) good.scene().Pose(1) = last;
    last = good.scene().Pose(1);
    RunInput(good.scene(), same);
    ASSERT_TRUE(good.scene().RefusedPoses().empty());
    ASSERT_EQ(bad.scene().DigestFrame(), good.scene().DigestFrame())
        << fault.says << ", frame " << f;
  }
}

TEST(PoseGate, HoldsTheLastPoseAndDisturbsNobody) {
  for (const BadPose& fault : kBadPoses) {
    SerialExecutor serial;
    ExpectHeld(fault, serial, OptionsFor(BestIsa()));
  }
}

TEST(PoseGate, IsTheSameOnEveryExecutor) {
  const BadPose& fault = kBadPoses[6];
  PermutedExecutor permuted(5);
  ExpectHeld(fault, permuted, OptionsFor(Isa::kReference));
  TbbExecutor tbb(3);
  ExpectHeld(fault, tbb, OptionsFor(BestIsa()));
  PullPool pull(2);
  ExpectHeld(fault, pull, OptionsFor(BestIsa()));
  SceneOptions options = OptionsFor(BestIsa());
  LocalStoreExecutor local(options.plan.local_store_data_bytes);
  ExpectHeld(fault, local, options);
  ExpectNoFaults(local);
}

// The other character, against a scene in which nothing was ever wrong.
TEST(PoseGate, LeavesTheOthersAsTheyWere) {
  Scenario scenario = PairScenario();
  RunningScenario bad(scenario, {}), good(scenario, {});
  for (uint32_t f = 0; f < 12; ++f) {
    const FrameInput input = scenario.PrepareFrame(f, bad.scene());
    bad.scene().Pose(1).rotation_key[0][0][0] = kNaN;
    RunInput(bad.scene(), input);
    RunFrame(good, f);
    ASSERT_EQ(DigestCharacter(bad.scene(), 0), DigestCharacter(good.scene(), 0)) << f;
    ASSERT_NE(DigestCharacter(bad.scene(), 1), DigestCharacter(good.scene(), 1)) << f;
  }
}

// As it was bound, at the origin.
TEST(PoseGate, ACharacterWithoutAPoseStandsAsItWasBound) {
  Scenario scenario = PairScenario();
  RunningScenario late(scenario, {});
  FurScene& scene = late.scene();
  const FrameInput input = scenario.PrepareFrame(0, scene);
  scene.Pose(1).joint_count = 3;
  RunInput(scene, input);
  const auto& palette = *scene.memory().Of<&Streams::palette>(1);
  const float scale = scenario.ActorGrooms()[1]->unit_scale;
  for (int i = 0; i < 12; ++i) EXPECT_EQ(palette.matrix[1][i], i % 5 == 0 ? scale : 0.0f);
}

// Patches and chunks of a character that start from their groom in the last frame, and all it has.
std::pair<uint32_t, uint32_t> CountStarts(const FurScene& scene, uint32_t character) {
  const SceneShape& shape = scene.shape();
  uint32_t starts = 0, all = 0;
  for (uint32_t p = 0; p < shape.patch_count; ++p) {
    if (shape.layer_character[shape.patch_layer[p]] != character) continue;
    ++all;
    starts += (scene.memory().Of<&Streams::patch_state>(p)->flags & kChunkRestart) != 0;
  }
  for (uint32_t c = 0; c < shape.chunk_count; ++c) {
    if (shape.layer_character[shape.chunk_layer[c]] != character) continue;
    ++all;
    starts += (scene.memory().Of<&Streams::chunk_state>(c)->flags & kChunkRestart) != 0;
  }
  return {starts, all};
}

// In which frames a character is given a pose that is refused, or is said to teleport; and in which
// its fur starts from its groom then.
struct StartCase {
  const char* name;
  std::vector<uint32_t> refused, teleports, starts;
};
const StartCase kStartCases[] = {
    {"a first pose that comes late", {0, 1, 2, 3}, {}, {0, 4}},
    {"a teleport with a pose that is refused happens with the next", {4}, {4}, {0, 5}},
    {"a teleport that happened does not happen again", {3, 4}, {2}, {0, 2}},
};

bool Lists(const std::vector<uint32_t>& frames, uint32_t f) {
  return std::find(frames.begin(), frames.end(), f) != frames.end();
}

// The other character, in front of it or behind it, starts with the scene and never again; and a
// scene that takes the state over before any of these frames goes on as the one it is from.
void ExpectStarts(const StartCase& start, uint32_t character) {
  Scenario scenario = PairScenario();
  RunningScenario running(scenario, {});
  for (uint32_t f = 0; f < 7; ++f) {
    RunningScenario copied(scenario, {});
    ASSERT_TRUE(copied.scene().CopyStateFrom(running.scene()));
    for (FurScene* scene : {&running.scene(), &copied.scene()}) {
      const FrameInput input = scenario.PrepareFrame(f, *scene);
      scene->Pose(character).teleported = Lists(start.teleports, f);
      if (Lists(start.refused, f)) scene->Pose(character).root[0] = kInf;
      RunInput(*scene, input);
      ASSERT_EQ(scene->RefusedPoses().size(), Lists(start.refused, f) ? 1u : 0u);
    }
    const auto [starts, all] = CountStarts(running.scene(), character);
    EXPECT_GT(all, 0u);
    EXPECT_EQ(starts, Lists(start.starts, f) ? all : 0u) << "frame " << f;
    const auto [others, all_others] = CountStarts(running.scene(), 1 - character);
    EXPECT_EQ(others, f == 0 ? all_others : 0u) << "frame " << f;
    EXPECT_EQ(copied.scene().DigestFrame(), running.scene().DigestFrame()) << "frame " << f;
  }
}

TEST(PoseGate, FurStartsFromItsGroomWhenAPoseComesThatWasMissed) {
  for (const uint32_t character : {0u, 1u})
    for (const StartCase& start : kStartCases) {
      SCOPED_TRACE(::testing::Message() << start.name << ", character " << character);
      ExpectStarts(start, character);
    }
}

// Scales that cancel along the chain are absurd one by one and harmless together: the bound does
// not pass them, the kernels' own bits do.
TEST(PoseGate, AcceptsWhatTheKernelsMakeHarmless) {
  Scenario scenario = PairScenario();
  RunningScenario running(scenario, {});
  FurScene& scene = running.scene();
  FrameInput input = scenario.PrepareFrame(0, scene);
  const SkeletonBlock& skeleton = scenario.ActorGrooms()[1]->skeleton;
  PoseBlock& pose = scene.Pose(1);
  uint32_t stretched = 0;
  std::vector<int> depths(pose.joint_count, 0);
  for (uint32_t j = 0; j < pose.joint_count; ++j) {
    const int32_t parent = skeleton.parent[j];
    const int depth = parent < 0 ? 0 : depths[size_t(parent)] + 1;
    depths[j] = depth;
    // Stretched along one axis by a joint, flattened along it by the next.
    const float along = depth % 2 == 0 ? 1e4f : 1e-4f;
    SetJoint(pose, j, {.scale = {along, 1.0f / along, 1.0f}});
    stretched += depth >= 2;
  }
  ASSERT_GT(stretched, 0u);
  RunInput(scene, input);
  for (const RefusedPose& refused : scene.RefusedPoses())
    ADD_FAILURE() << DescribeRefusedPose(refused);
}

}  // namespace
}  // namespace pelt::testing
