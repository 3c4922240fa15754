// FillPose against values worked out by hand and against an independent slerp.
#include "core/character/pose.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "core/random.hpp"
#include "tests/character/pose_reference.hpp"

namespace pelt::test {
namespace {

Skeleton TwoJoints() {
  Skeleton s;
  s.name = {"base", "tip"};
  s.parent = {-1, 0};
  s.rest.resize(2);
  s.rest[1].translation = {0, 1, 0};
  s.rest[1].rotation = glm::quat(0.8f, 0.6f, 0, 0);
  s.rest[1].scale = {1, 2, 3};
  s.inverse_bind.assign(2, glm::mat4(1.0f));
  s.inverse_bind[1][3] = glm::vec4(4, 5, 6, 1);
  return s;
}

Clip OneTrack(Channel channel, Interpolation how, std::vector<float> times,
              std::vector<glm::vec4> values) {
  Clip clip;
  clip.duration_s = times.back();
  clip.tracks.push_back({1, channel, how, std::move(times), std::move(values)});
  return clip;
}

LocalPose Sample(const Clip& clip, double t, bool loop = false) {
  return BlendKeys(MakePose(TwoJoints(), &clip, t, loop, glm::mat4(1.0f)), 1);
}

TEST(Pose, RestWithoutClip) {
  glm::mat4 root(1.0f);
  root[3] = glm::vec4(7, 8, 9, 1);
  const PoseBlock pose = MakePose(TwoJoints(), nullptr, 1.0, true, root);
  EXPECT_EQ(pose.joint_count, 2u);
  EXPECT_EQ(pose.root[3], 7.0f);
  EXPECT_EQ(pose.root[11], 9.0f);
  EXPECT_EQ(pose.root[0], 1.0f);
  const LocalPose tip = BlendKeys(pose, 1);
  EXPECT_EQ(tip.translation, glm::dvec3(0, 1, 0));
  EXPECT_EQ(tip.scale, glm::dvec3(1, 2, 3));
  EXPECT_NEAR(tip.rotation.x, 0.6, 1e-7);
  // Lanes that complete the group of 16 are copies of the last joint.
  for (size_t j = 2; j < 16; ++j) {
    EXPECT_EQ(pose.scale_key[0][2][j], 3.0f);
    EXPECT_EQ(pose.rotation_weight[0][j], 1.0f);
  }
  EXPECT_EQ(pose.rotation_weight[0][16], 0.0f);
}

TEST(Pose, StepHoldsUntilTheNextKey) {
  const Clip clip = OneTrack(Channel::kTranslation, Interpolation::kStep, {1, 2, 3},
                             {{1, 0, 0, 0}, {2, 0, 0, 0}, {3, 0, 0, 0}});
  const double at[][2] = {{0, 1}, {1, 1}, {1.999, 1}, {2, 2}, {2.5, 2}, {3, 3}, {9, 3}};
  for (auto [t, x] : at) EXPECT_EQ(Sample(clip, t).translation.x, x) << t;
}

TEST(Pose, LinearByHand) {
  const Clip clip = OneTrack(Channel::kScale, Interpolation::kLinear, {1, 2, 4},
                             {{1, 2, 3, 0}, {3, 2, 1, 0}, {7, 2, 1, 0}});
  EXPECT_EQ(Sample(clip, 0.0).scale, glm::dvec3(1, 2, 3));
  EXPECT_EQ(Sample(clip, 1.25).scale, glm::dvec3(1.5, 2, 2.5));
  EXPECT_EQ(Sample(clip, 2.0).scale, glm::dvec3(3, 2, 1));
  EXPECT_EQ(Sample(clip, 3.0).scale, glm::dvec3(5, 2, 1));
  EXPECT_EQ(Sample(clip, 4.0).scale, glm::dvec3(7, 2, 1));
}

TEST(Pose, CubicByHand) {
  // glTF appendix C: p = (2s3 - 3s2 + 1) v0 + dt (s3 - 2s2 + s) b0 + (3s2 - 2s3) v1 + dt (s3 - s2)
  // a1.
  const Clip clip = OneTrack(
      Channel::kTranslation, Interpolation::kCubicSpline, {0, 2},
      {{99, 0, 0, 0}, {1, 0, 0, 0}, {4, 0, 0, 0}, {-6, 0, 0, 0}, {5, 0, 0, 0}, {99, 0, 0, 0}});
  // s = 0.5: 0.5 * 1 + 2 * 0.125 * 4 + 0.5 * 5 + 2 * -0.125 * -6 = 0.5 + 1 + 2.5 + 1.5.
  EXPECT_NEAR(Sample(clip, 1.0).translation.x, 5.5, 1e-6);
  // s = 0.25: 0.84375 + 2 * 0.140625 * 4 + 0.15625 * 5 + 2 * -0.046875 * -6.
  EXPECT_NEAR(Sample(clip, 0.5).translation.x, 0.84375 + 1.125 + 0.78125 + 0.5625, 1e-6);
  EXPECT_EQ(Sample(clip, 0.0).translation.x, 1.0);
  EXPECT_EQ(Sample(clip, 2.0).translation.x, 5.0);
}

TEST(Pose, SlerpAgainstTrigonometry) {
  Random random(3);
  for (int i = 0; i < 2000; ++i) {
    // Every tenth pair is nearly parallel: the lerp path.
    const double spread = i % 10 == 0 ? 1e-3 : 1.0;
    glm::dvec4 a, b;
    for (int c = 0; c < 4; ++c) {
      a[c] = random.Uniform(-1, 1);
      b[c] = random.Uniform(-1, 1);
    }
    a /= std::sqrt(glm::dot(a, a));
    b = spread == 1.0 ? b : a + b * spread;
    b /= std::sqrt(glm::dot(b, b));
    const Clip clip =
        OneTrack(Channel::kRotation, Interpolation::kLinear, {0, 1}, {glm::vec4(a), glm::vec4(b)});
    const double t = random.Uniform();
    if (glm::dot(a, b) < 0) b = -b;
    const double angle = std::acos(std::min(glm::dot(a, b), 1.0));
    const glm::dvec4 want =
        angle < 1e-9 ? a
                     : (std::sin((1 - t) * angle) * a + std::sin(t * angle) * b) / std::sin(angle);
    const glm::dvec4 got = Sample(clip, t).rotation;
    for (int c = 0; c < 4; ++c) ASSERT_NEAR(got[c], want[c], 1e-6) << i;
  }
}

TEST(Pose, SlerpSurvivesOppositeKeys) {
  const Clip clip =
      OneTrack(Channel::kRotation, Interpolation::kLinear, {0, 1}, {{0, 0, 0, 1}, {0, 0, 0, -1}});
  EXPECT_NEAR(std::abs(Sample(clip, 0.5).rotation.w), 1.0, 1e-7);
  const Clip half = OneTrack(Channel::kRotation, Interpolation::kLinear, {0, 1},
                             {{0, 0, 0, 1}, {1, 0, 0, 0}});  // 180 degrees
  EXPECT_NEAR(Sample(half, 0.5).rotation.x, std::sqrt(0.5), 1e-6);
}

TEST(Pose, LoopWraps) {
  const Clip clip =
      OneTrack(Channel::kTranslation, Interpolation::kLinear, {0, 2}, {{0, 0, 0, 0}, {2, 0, 0, 0}});
  EXPECT_EQ(Sample(clip, 2.5, true).translation.x, 0.5);
  EXPECT_EQ(Sample(clip, -0.5, true).translation.x, 1.5);
  EXPECT_EQ(Sample(clip, 2.0, true).translation.x, 0.0);
  EXPECT_NEAR(Sample(clip, 2e6 + 0.5, true).translation.x, 0.5, 1e-6);
  EXPECT_EQ(Sample(clip, 2.5, false).translation.x, 2.0);
  EXPECT_EQ(Sample(clip, -1.0, false).translation.x, 0.0);
  EXPECT_EQ(Sample(clip, NAN, true).translation.x, 0.0);
}

TEST(Pose, HeldKeysDoNotMoveABit) {
  const glm::vec4 q(0.1f, 0.7f, 0.3f, 0.640312f);
  const Clip clip =
      OneTrack(Channel::kRotation, Interpolation::kLinear, {0, 1, 2}, {{0, 0, 0, 1}, q, q});
  const PoseBlock first = MakePose(TwoJoints(), &clip, 1.0, false, glm::mat4(1.0f));
  for (double t : {1.1, 1.37, 1.9, 2.0, 5.0}) {
    const PoseBlock later = MakePose(TwoJoints(), &clip, t, false, glm::mat4(1.0f));
    EXPECT_EQ(std::memcmp(&first, &later, sizeof first), 0) << t;
  }
}

// What an earlier clip wrote is gone when the next one plays.
TEST(Pose, RefillLeavesNothingBehind) {
  const Clip moving = OneTrack(Channel::kRotation, Interpolation::kCubicSpline, {0, 1},
                               std::vector<glm::vec4>(6, glm::vec4(0.5f)));
  PoseBlock reused = MakePose(TwoJoints(), &moving, 0.3, true, glm::mat4(2.0f));
  FillPose(TwoJoints(), nullptr, 0.0, false, glm::mat4(1.0f), &reused);
  const PoseBlock fresh = MakePose(TwoJoints(), nullptr, 0.0, false, glm::mat4(1.0f));
  EXPECT_EQ(std::memcmp(&reused, &fresh, sizeof fresh), 0);
}

TEST(Pose, SkeletonBlockIsRowMajor) {
  const SkeletonBlock block = MakeSkeletonBlock(TwoJoints());
  EXPECT_EQ(block.parent[0], -1);
  EXPECT_EQ(block.parent[1], 0);
  EXPECT_EQ(block.inverse_bind[1][3], 4.0f);
  EXPECT_EQ(block.inverse_bind[1][7], 5.0f);
  EXPECT_EQ(block.inverse_bind[1][11], 6.0f);
  EXPECT_EQ(block.inverse_bind[200][5], 1.0f);
}

Character Rod(float length) {
  Character c;
  c.skeleton = TwoJoints();
  c.skeleton.rest[1] = JointPose{};
  c.skeleton.inverse_bind[1] = glm::mat4(1.0f);
  c.mesh.position = {{0, 0, 0}, {length, 0, 0}, {0, length / 10, 0}};
  c.mesh.normal.assign(3, {0, 0, 1});
  c.mesh.tangent.assign(3, {1, 0, 0, 1});
  c.mesh.joints.assign(3, {0, 0, 0, 0});
  c.mesh.weights.assign(3, {1, 0, 0, 0});
  c.mesh.triangles = {{0, 1, 2}};
  c.mesh.triangle_material = {0};
  return c;
}

TEST(Pose, UnitScaleIsAPowerOfTenIntoReach) {
  const double at[][2] = {{1.5, 1.0},   {155, 0.01},    {2.99, 1.0}, {3.0, 0.1}, {0.3, 1.0},
                          {0.29, 10.0}, {0.018, 100.0}, {1e9, 1e-9}, {1e-9, 1e9}};
  for (auto [length, scale] : at) {
    const UnitScale got = DefaultUnitScale(Rod(float(length)));
    if (length == 0.3) {  // as a float just above
      EXPECT_NEAR(got.metres_per_unit, scale, 1e-6);
      continue;
    }
    EXPECT_FLOAT_EQ(got.metres_per_unit, float(scale)) << length;
    const double metres = length * double(got.metres_per_unit);
    EXPECT_GE(metres, 0.29999);
    EXPECT_LT(metres, 3.00001);
    EXPECT_NE(got.sentence.find("unit_scale"), std::string::npos);
  }
}

TEST(Pose, PlaceCharacterScalesBeforePlacing) {
  glm::mat4 placement(1.0f);
  placement[3] = glm::vec4(1, 2, 3, 1);
  const glm::vec4 p = PlaceCharacter(placement, 0.5f) * glm::vec4(2, 4, 6, 1);
  EXPECT_EQ(p, glm::vec4(2, 4, 6, 1));
}

}  // namespace
}  // namespace pelt::test
