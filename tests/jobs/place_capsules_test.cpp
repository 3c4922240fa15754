// A capsule that is bound to a joint goes where the joint goes: the frame with it is the frame with
// a free one at that place, bit for bit.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/kernels/frame_table.hpp"
#include "jobs/colliders.hpp"
#include "platform_sim/local_store.hpp"
#include "tests/jobs/pair_scene.hpp"

namespace pelt::testing {
namespace {

// Bound to `joint`, from its origin some way along its own axes, thick enough to part the fur.
CapsuleCollider BoundTo(uint32_t character, uint32_t joint) {
  CapsuleCollider capsule;
  capsule.to[0] = 0.1f;
  capsule.to[1] = 0.2f;
  capsule.radius = 0.2f;
  capsule.character = character;
  capsule.joint = joint;
  return capsule;
}

// The joint that moves most hair of the first layer.
uint32_t AnyJoint(const FurScene& scene) {
  return scene.memory().Of<&Streams::layer_joints>(0)->joint[1];
}

// Runs a frame of the scenario with these capsules.
void RunWith(Scenario& scenario, uint32_t frame, FurScene& scene, Executor& executor,
             const std::vector<CapsuleCollider>& capsules) {
  FrameInput input = scenario.PrepareFrame(frame, scene);
  input.capsule_count = uint32_t(capsules.size());
  std::copy(capsules.begin(), capsules.end(), input.capsule);
  RunInput(scene, input, executor);
}

// The capsule where last frame's palette has it, in double: the inverse bind matrix M of a joint
// takes the mesh to the joint, so M p = end is solved by Cramer's rule.
CapsuleCollider FreeAt(const FurScene& scene, const CapsuleCollider& bound) {
  CapsuleCollider capsule = bound;
  capsule.joint = CapsuleCollider::kFree;
  const auto& m = scene.memory().Of<&Streams::skeleton>(bound.character)->inverse_bind[bound.joint];
  const auto& world = scene.memory().Of<&Streams::palette>(bound.character)->matrix[bound.joint];
  const auto place = [&](const float(&end)[3], float(&to)[3]) {
    glm::dmat3 linear;
    glm::dvec3 rest;
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) linear[c][r] = m[4 * r + c];
      rest[r] = double(end[r]) - m[4 * r + 3];
    }
    const glm::dvec3 in_mesh = glm::inverse(linear) * rest;
    for (int r = 0; r < 3; ++r)
      to[r] = float(world[4 * r] * in_mesh.x + world[4 * r + 1] * in_mesh.y +
                    world[4 * r + 2] * in_mesh.z + world[4 * r + 3]);
  };
  place(bound.from, capsule.from);
  place(bound.to, capsule.to);
  return capsule;
}

PoseGate GateOf(const Scenario& scenario) {
  return PoseGate(scenario.ActorGrooms(), *FindKernels(BestIsa()));
}

SimulateParams Placed(const FurScene& scene, PoseGate& gate, const CapsuleCollider& capsule) {
  FrameInput input;
  input.capsule_count = 1;
  input.capsule[0] = capsule;
  SimulateParams params{};
  gate.Judge(scene.memory());
  PlaceCapsules(input, scene.memory(), gate, params);
  return params;
}

TEST(PlaceCapsules, ABoundOneFollowsItsJoint) {
  Scenario scenario = PairScenario();
  RunningScenario running(scenario, {});
  PoseGate gate = GateOf(scenario);
  SerialExecutor serial;
  const CapsuleCollider bound = BoundTo(1, AnyJoint(running.scene()));
  double walked = 0.0;
  CapsuleCollider before = bound;
  for (uint32_t f = 0; f < 12; ++f) {
    RunWith(scenario, f, running.scene(), serial, {});
    const SimulateParams params = Placed(running.scene(), gate, bound);
    const CapsuleCollider wanted = FreeAt(running.scene(), bound);
    ASSERT_EQ(params.capsule_count, 1u);
    const CapsuleParams& capsule = params.capsule[0];
    EXPECT_EQ(capsule.radius, 0.2f);
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(capsule.from[k], wanted.from[k], 1e-6);
      EXPECT_NEAR(capsule.from[k] + capsule.length * capsule.axis[k], wanted.to[k], 1e-6);
    }
    for (int k = 0; k < 3 && f > 0; ++k) walked += std::abs(wanted.to[k] - before.to[k]);
    before = wanted;
  }
  EXPECT_GT(walked, 1e-3) << "the joint moves";
}

// The ends as the frame has them.
struct Ends {
  float from[3], to[3];
};
Ends EndsOf(const CapsuleParams& capsule) {
  Ends ends;
  for (int k = 0; k < 3; ++k) {
    ends.from[k] = capsule.from[k];
    ends.to[k] = capsule.from[k] + capsule.axis[k] * capsule.length;
  }
  return ends;
}

TEST(PlaceCapsules, TheFrameIsThatOfAFreeOneAtItsPlaceWithItsVelocity) {
  Scenario scenario = PairScenario();
  RunningScenario bound(scenario, {}), free(scenario, {}), without(scenario, {});
  PoseGate gate = GateOf(scenario);
  LocalStoreExecutor local(PlanOptions{}.local_store_data_bytes);
  SerialExecutor serial;
  const CapsuleCollider capsule = BoundTo(0, AnyJoint(bound.scene()));
  Ends last{};
  float fastest = 0.0f;
  for (uint32_t f = 0; f < 12; ++f) {
    RunWith(scenario, f, without.scene(), serial, {});
    RunWith(scenario, f, bound.scene(), local, {capsule});
    CapsuleCollider same = FreeAt(without.scene(), capsule);
    const Ends ends = EndsOf(Placed(without.scene(), gate, same).capsule[0]);
    const float dt = float(scenario.PrepareFrame(f, free.scene()).dt_s);
    for (int k = 0; k < 3 && f > 0; ++k) {
      same.from_velocity[k] = (ends.from[k] - last.from[k]) / dt;
      same.to_velocity[k] = (ends.to[k] - last.to[k]) / dt;
      fastest = std::max(fastest, std::abs(same.to_velocity[k]));
    }
    last = ends;
    RunWith(scenario, f, free.scene(), serial, {same});
    EXPECT_EQ(bound.scene().DigestFrame(), free.scene().DigestFrame()) << f;
    if (f > 0) {
      EXPECT_NE(bound.scene().DigestFrame(), without.scene().DigestFrame()) << f;
    }
  }
  EXPECT_GT(fastest, 1e-3f) << "it moves";
  ExpectNoFaults(local);
}

// A refused pose is as if the last one had been given again: to the capsules too. Before there is
// one, they stand where the character was bound.
TEST(PlaceCapsules, OfACharacterThatKeepsItsPoseStay) {
  Scenario scenario = PairScenario();
  RunningScenario bad(scenario, {}), good(scenario, {});
  const std::vector<CapsuleCollider> capsules = {BoundTo(1, AnyJoint(bad.scene()))};
  PoseBlock last{};
  for (uint32_t f = 0; f < 8; ++f) {
    const bool spoiled = f % 3 == 2;
    FrameInput input = scenario.PrepareFrame(f, bad.scene());
    input.capsule_count = 1;
    input.capsule[0] = capsules[0];
    if (spoiled) bad.scene().Pose(1).root[3] = std::numeric_limits<float>::quiet_NaN();
    RunInput(bad.scene(), input);
    ASSERT_EQ(bad.scene().RefusedPoses().size(), spoiled ? 1u : 0u);
    scenario.PrepareFrame(f, good.scene());
    if (spoiled) good.scene().Pose(1) = last;
    last = good.scene().Pose(1);
    RunInput(good.scene(), input);
    ASSERT_EQ(bad.scene().DigestFrame(), good.scene().DigestFrame()) << f;
  }
}

TEST(PlaceCapsules, OneThatItsJointTakesTooFarIsLeftOut) {
  Scenario scenario = PairScenario();
  RunningScenario running(scenario, {});
  PoseGate gate = GateOf(scenario);
  scenario.PrepareFrame(0, running.scene());
  CapsuleCollider capsule = BoundTo(0, AnyJoint(running.scene()));
  EXPECT_EQ(Placed(running.scene(), gate, capsule).capsule_count, 1u);
  capsule.to[1] = 1e6f;
  for (float& root : running.scene().Pose(0).root) root *= 100.0f;
  EXPECT_EQ(Placed(running.scene(), gate, capsule).capsule_count, 0u);
}

}  // namespace
}  // namespace pelt::testing
