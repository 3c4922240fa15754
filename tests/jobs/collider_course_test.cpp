// What a scene makes of the places and velocities of its colliders, frame by frame.
#include <gtest/gtest.h>

#include "core/bind_pose.hpp"
#include "jobs/colliders.hpp"
#include "tests/jobs/c_scene.hpp"

namespace pelt {
namespace {

class Colliders {
 public:
  const SimulateParams& Next(const FrameInput& in) {
    SimulateParams params{};
    params.dt = float(in.dt_s);
    params.use_ground = in.use_ground;
    std::copy_n(in.ground, 4, params.ground);
    params.sphere_count = in.sphere_count;
    std::copy_n(in.sphere[0], 4 * kSpheresPerScene, params.sphere[0]);
    params.capsule_count = in.capsule_count;
    CapsuleSources sources{};
    for (uint32_t c = 0; c < in.capsule_count; ++c) {
      sources[c] = c;
      std::copy_n(in.capsule[c].from, 3, params.capsule[c].from);
      params.capsule[c].radius = in.capsule[c].radius;
    }
    course_.Advance(in, {}, sources, begun_ ? &last_ : nullptr, nullptr, params);
    begun_ = true;
    return last_ = params;
  }

 private:
  ColliderCourse course_;
  SimulateParams last_{};
  bool begun_ = false;
};

TEST(ColliderCourse, VelocitiesAreWaysInTheFrame) {
  FrameInput in;
  in.dt_s = 0.125;
  in.use_ground = true;
  in.ground_velocity[1] = 2.0f;
  in.sphere_count = in.capsule_count = 2;
  in.sphere_velocity[1][0] = -8.0f;
  in.capsule[1].to_velocity[2] = 4.0f;
  Colliders course;
  for (int frame = 0; frame < 2; ++frame) {
    const SimulateParams& p = course.Next(in);
    EXPECT_EQ(p.ground_step.from[1], 0.25f);
    EXPECT_EQ(p.ground_step.moves, 1u);
    EXPECT_EQ(p.sphere_step[0].moves, 0u);
    EXPECT_EQ(p.sphere_step[1].from[0], -1.0f);
    EXPECT_EQ(p.sphere_step[1].to[0], -1.0f);
    EXPECT_EQ(p.sphere_step[1].moves, 1u);
    EXPECT_EQ(p.capsule_step[1].from[2], 0.0f);
    EXPECT_EQ(p.capsule_step[1].to[2], 0.5f);
    EXPECT_EQ(p.capsule_step[1].moves, 1u);
    EXPECT_EQ(p.capsule_step[0].moves + p.capsule_step[0].at_once, 0u);
  }
}

// Where something overlaps that is somewhere else than before, it may have come that way.
TEST(ColliderCourse, WhatMovesWithoutAVelocityPushesAtOnce) {
  FrameInput in;
  in.use_ground = true;
  in.sphere_count = in.capsule_count = 1;
  Colliders course;
  const auto pushes = [&](uint32_t ground, uint32_t sphere, uint32_t capsule, const char* when) {
    const SimulateParams& p = course.Next(in);
    EXPECT_EQ(p.ground_step.at_once, ground) << when;
    EXPECT_EQ(p.sphere_step[0].at_once, sphere) << when;
    EXPECT_EQ(p.capsule_step[0].at_once, capsule) << when;
  };
  pushes(0, 0, 0, "the first frame");
  pushes(0, 0, 0, "nothing moved");
  in.sphere[0][3] = 0.5f;
  pushes(0, 1, 0, "it grew");
  in.ground[3] = 0.5f;
  in.capsule[0].from[1] = 1.0f;
  pushes(1, 0, 1, "others moved");
  pushes(0, 0, 0, "nothing moved again");
  in.sphere[0][0] = 0.5f;
  in.sphere_velocity[0][0] = 30.0f;
  in.sphere_count = 2;
  pushes(0, 0, 0, "with a velocity, and one that was not there");
  EXPECT_EQ(course.Next(in).sphere_step[1].at_once, 0u);
}

// Three frames of a bar that sweeps through the fur, its far end at a speed of its own.
template <class NextDigest>
std::vector<uint64_t> Swept(float end_speed, const NextDigest& next) {
  std::vector<uint64_t> digests;
  for (int f = 0; f < 3; ++f)
    digests.push_back(next(f / 60.0, CapsuleCollider{.from = {-0.6f, 0.6f, 0.2f + 0.02f * float(f)},
                                                     .to = {0.6f, 0.6f, 0.2f + 0.02f * float(f)},
                                                     .radius = 0.2f,
                                                     .from_velocity = {0.0f, 0.0f, 1.2f},
                                                     .to_velocity = {0.0f, 0.5f, end_speed}}));
  return digests;
}

// Of a capsule on a joint. Faster than 100 m/s it was put where it is.
TEST(ColliderCourse, WhatIsPutElsewhereMeetsNothingOnItsWay) {
  Scenario scenario = testing::TinyScenario();
  RunningScenario running(scenario, {});
  FrameInput in;
  in.capsule_count = 1;
  in.capsule[0].joint = 1;
  for (const float way : {0.25f, 1.5f, 1.75f}) {
    ColliderCourse course;
    SimulateParams last{}, now{};
    last.dt = now.dt = 1.0f / 64.0f;
    last.capsule_count = now.capsule_count = 1;
    now.capsule[0].from[2] = way;
    course.Advance(in, running.scene().memory(), {}, nullptr, nullptr, last);
    course.Advance(in, running.scene().memory(), {}, &last, nullptr, now);
    EXPECT_EQ(now.capsule_step[0].from[2], 64.0f * way > 100.0f ? 0.0f : way) << way;
  }
}

TEST(ColliderCourse, BarsComeInByTheCInterface) {
  const Scenario scenario = testing::TinyScenario();
  const auto ours = [&](float end_speed) {
    RunningScenario own(const_cast<Scenario&>(scenario), {});
    FillBindPose(scenario.grooms[0], own.scene().Pose(0));
    return Swept(end_speed, [&](double time_s, const CapsuleCollider& bar) {
      FrameInput input;
      input.time_s = time_s;
      input.capsule_count = 1;
      input.capsule[0] = bar;
      testing::RunInput(own.scene(), input);
      return own.scene().DigestFrame();
    });
  };
  const testing::OwnScene made = testing::MakeCScene(nullptr);
  PeltScene* const scene = made.get();
  const auto theirs = Swept(1.2f, [&](double time_s, const CapsuleCollider& bar) {
    PeltCapsule capsule{};
    std::copy_n(bar.from, 3, capsule.from);
    std::copy_n(bar.to, 3, capsule.to);
    std::copy_n(bar.from_velocity, 3, capsule.from_velocity);
    std::copy_n(bar.to_velocity, 3, capsule.to_velocity);
    capsule.radius = bar.radius;
    capsule.joint = PELT_FREE;
    PeltFrame frame;
    pelt_default_frame(&frame);
    frame.time_s = time_s;
    frame.capsules = &capsule;
    frame.capsule_count = 1;
    EXPECT_EQ(pelt_begin(scene, &frame), nullptr);
    EXPECT_EQ(pelt_run(scene, nullptr), nullptr);
    return pelt_digest(scene);
  });
  EXPECT_EQ(theirs, ours(1.2f));
  EXPECT_NE(theirs, ours(0.0f));
}

}  // namespace
}  // namespace pelt
