// Force volumes in whole frames: whom they wake, that what they hold comes to rest, and what joints carry.
#include <gtest/gtest.h>

#include <cmath>

#include "core/kernels/frame_table.hpp"
#include "core/kernels/wind.hpp"
#include "jobs/colliders.hpp"
#include "tests/jobs/pair_scene.hpp"

namespace pelt::testing {
namespace {

ForceVolume BallAt(float x) {
  ForceVolume ball;
  ball.centre[0] = x, ball.centre[1] = 0.5f;
  for (float& half : ball.half) half = 1.5f;
  ball.strength = 6.0f;
  ball.hardness = 0.5f;
  return ball;
}

// Two characters that come to rest, 5 m apart: in a scene that sleeps, and in one that never does.
struct Courses {
  void Run(const std::vector<ForceVolume>& forces) {
    for (RunningScenario* course : {&lazy, &eager}) {
      const SkipSettings skip{.sleep = course == &lazy, .cull = false};
      FrameInput input = course->Prepare(frame, skip, scenario.base.lod);
      input.force_count = uint32_t(forces.size());
      std::copy(forces.begin(), forces.end(), input.force);
      RunInput(*course, input);
    }
    ASSERT_EQ(lazy.scene().DigestFrame(), eager.scene().DigestFrame()) << "frame " << frame;
    ++frame;
  }
  void FallAsleep(const std::vector<ForceVolume>& forces) {
    constexpr uint32_t kLongestToRest = 2000;
    for (uint32_t i = 0; i < kLongestToRest && !::testing::Test::HasFatalFailure(); ++i) {
      Run(forces);
      if (CountChunks(lazy.scene(), kChunkSimulate) == 0) return Run(forces);
    }
    FAIL() << "it does not come to rest";
  }
  // Then all chunks of the first character are simulated, or none; none of the second.
  void RunAndExpect(const std::vector<ForceVolume>& forces, bool awake, const char* what) {
    Run(forces);
    const SceneShape& shape = lazy.scene().shape();
    for (uint32_t c = 0; c < shape.chunk_count; ++c) {
      const bool first = shape.layer_character[shape.chunk_layer[c]] == 0;
      const uint32_t flags = lazy.scene().memory().Of<&Streams::chunk_state>(c)->flags;
      EXPECT_EQ((flags & kChunkSimulate) != 0, awake && first) << what << ", chunk " << c;
    }
  }

  Scenario scenario;
  RunningScenario lazy{scenario, {}}, eager{scenario, {}};
  uint32_t frame = 0;
};

TEST(Forces, WakeTheLayersThatTheyTouchAndLetThemRest) {
  Scenario apart = PairScenario();
  apart.rest_from_frame = 6;
  apart.actors[1].placement[3] += glm::vec4(5.0f, 0.0f, 0.0f, 0.0f);
  Courses courses{std::move(apart)};
  ForceVolume ball = BallAt(0.0f);
  ASSERT_NO_FATAL_FAILURE(courses.FallAsleep({}));
  const uint64_t first = DigestCharacter(courses.lazy.scene(), 0);
  const uint64_t second = DigestCharacter(courses.lazy.scene(), 1);
  courses.RunAndExpect({BallAt(-50.0f)}, false, "one that touches nothing");
  courses.RunAndExpect({ball}, true, "one comes to the first");
  ASSERT_NO_FATAL_FAILURE(courses.FallAsleep({ball}));
  EXPECT_NE(DigestCharacter(courses.lazy.scene(), 0), first);
  courses.RunAndExpect({ball}, false, "it stays");
  ball.centre[1] += 0.01f;
  courses.RunAndExpect({ball}, true, "it moves");
  ASSERT_NO_FATAL_FAILURE(courses.FallAsleep({ball}));
  courses.RunAndExpect({}, true, "it goes");
  ASSERT_NO_FATAL_FAILURE(courses.FallAsleep({}));
  EXPECT_EQ(DigestCharacter(courses.lazy.scene(), 1), second);
}

// Measured by a capsule from its centre along its direction, which is placed in another way.
TEST(Forces, ABoundOneGoesWhereItsJointGoes) {
  Scenario scenario = PairScenario();
  RunningScenario running(scenario, {});
  const FrameMemory& memory = running.scene().memory();
  PoseGate gate(scenario.ActorGrooms(), *FindKernels(BestIsa()));
  FrameInput input;
  input.force_count = input.capsule_count = 1;
  ForceVolume& force = input.force[0];
  CapsuleCollider& capsule = input.capsule[0];
  force.character = capsule.character = 1;
  force.joint = capsule.joint = memory.Of<&Streams::layer_joints>(0)->joint[1];
  force.centre[0] = capsule.from[0] = capsule.to[0] = 0.1f;
  capsule.to[1] = 1.0f;
  force.half[1] = 0.25f;
  force.strength = 2.0f;
  for (uint32_t f = 0; f < 12; ++f) {
    RunFrame(running, f);
    gate.Judge(memory);
    SimulateParams placed{};
    PlaceCapsules(input, memory, gate, placed);
    const ForceParams forces = PlaceForces(input, memory, gate);
    ASSERT_EQ(forces.count, 1u);
    for (int row = 0; row < 3; ++row) {
      const float(&own)[4] = forces.force[0].own[row];
      double at_centre = double(own[3]), along = 0.0;
      for (int k = 0; k < 3; ++k) {
        at_centre += double(own[k]) * double(placed.capsule[0].from[k]);
        along += double(own[k]) * double(placed.capsule[0].axis[k]);
      }
      EXPECT_NEAR(at_centre, 0.0, 1e-5);
      EXPECT_NEAR(along, row == 1 ? 4.0 : 0.0, 1e-3);
      EXPECT_NEAR(forces.force[0].push[row], 2.0f * placed.capsule[0].axis[row], 1e-5f);
    }
  }
}

}  // namespace
}  // namespace pelt::testing
