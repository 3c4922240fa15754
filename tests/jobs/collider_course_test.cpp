// What a scene makes of the places and velocities of its colliders, frame by frame.
#include "jobs/collider_course.hpp"

#include <gtest/gtest.h>

namespace pelt {
namespace {

class Course {
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
  Course course;
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
  Course course;
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

}  // namespace
}  // namespace pelt
