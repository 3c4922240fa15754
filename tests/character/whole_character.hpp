// What must hold of every character that an import lets through.
#pragma once

#include <gtest/gtest.h>

#include <cmath>

#include "core/character/pose.hpp"
#include "tests/character/pose_reference.hpp"

namespace pelt::test {

inline bool IsFinite(const glm::vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

inline void ExpectWhole(const Character& c) {
  const Mesh& m = c.mesh;
  const size_t count = m.position.size(), joints = c.skeleton.name.size();
  ASSERT_GT(count, 0u);
  ASSERT_GT(m.triangles.size(), 0u);
  ASSERT_EQ(m.normal.size(), count);
  ASSERT_EQ(m.tangent.size(), count);
  ASSERT_EQ(m.joints.size(), count);
  ASSERT_EQ(m.weights.size(), count);
  ASSERT_TRUE(m.uv.empty() || m.uv.size() == count);
  ASSERT_EQ(m.triangle_material.size(), m.triangles.size());
  for (size_t v = 0; v < count; ++v) {
    ASSERT_TRUE(IsFinite(m.position[v])) << v;
    ASSERT_NEAR(glm::dot(m.normal[v], m.normal[v]), 1.0f, 1e-5f) << v;
    const glm::vec3 t(m.tangent[v]);
    ASSERT_NEAR(glm::dot(t, t), 1.0f, 1e-5f) << v;
    ASSERT_NEAR(glm::dot(t, m.normal[v]), 0.0f, 1e-5f) << v;
    double sum = 0.0;
    for (int i = 0; i < 4; ++i) {
      ASSERT_GE(m.weights[v][i], 0.0f);
      if (i > 0) {
        ASSERT_LE(m.weights[v][i], m.weights[v][i - 1]);
      }
      ASSERT_LT(m.joints[v][size_t(i)], joints);
      sum += double(m.weights[v][i]);
    }
    ASSERT_NEAR(sum, 1.0, 1e-6) << v;
  }
  for (size_t t = 0; t < m.triangles.size(); ++t) {
    for (uint32_t corner : m.triangles[t]) ASSERT_LT(corner, count);
    ASSERT_LT(m.triangle_material[t], m.materials.size());
  }
  ASSERT_LE(joints, size_t(kJointsPerCharacter));
  ASSERT_EQ(c.skeleton.parent.size(), joints);
  ASSERT_EQ(c.skeleton.rest.size(), joints);
  ASSERT_EQ(c.skeleton.inverse_bind.size(), joints);
  for (size_t j = 0; j < joints; ++j) {
    ASSERT_LT(c.skeleton.parent[j], int32_t(j));
    ASSERT_GE(c.skeleton.parent[j], -1);
    ASSERT_TRUE(IsFinite(c.skeleton.rest[j].translation));
    ASSERT_TRUE(IsFinite(c.skeleton.rest[j].scale));
    ASSERT_NEAR(glm::dot(c.skeleton.rest[j].rotation, c.skeleton.rest[j].rotation), 1.0f, 1e-5f);
  }
  for (const Clip& clip : c.clips) {
    for (const Track& track : clip.tracks) {
      ASSERT_LT(track.joint, joints);
      const size_t per_key = track.interpolation == Interpolation::kCubicSpline ? 3 : 1;
      ASSERT_EQ(track.value.size(), track.time_s.size() * per_key);
      for (size_t k = 1; k < track.time_s.size(); ++k)
        ASSERT_LT(track.time_s[k - 1], track.time_s[k]);
      ASSERT_LE(track.time_s.back(), clip.duration_s);
      for (const glm::vec4& v : track.value)
        for (int i = 0; i < 4; ++i) ASSERT_TRUE(std::isfinite(v[i]));
    }
  }
}

// The rest pose by FillPose and the hierarchy is the rest pose by ComputeRestGeometry.
inline void ExpectRestAgrees(const Character& c, float unit_scale) {
  const RestGeometry rest = ComputeRestGeometry(c, unit_scale);
  const PoseBlock pose =
      MakePose(c.skeleton, nullptr, 0.0, false, PlaceCharacter(glm::mat4(1.0f), unit_scale));
  const std::vector<glm::dvec3> skinned =
      SkinPositions(c.mesh, pose, MakeSkeletonBlock(c.skeleton));
  ASSERT_EQ(rest.position.size(), skinned.size());
  for (size_t v = 0; v < skinned.size(); ++v) {
    for (int i = 0; i < 3; ++i) ASSERT_NEAR(rest.position[v][i], skinned[v][i], 1e-5) << v;
    ASSERT_NEAR(glm::dot(rest.normal[v], rest.normal[v]), 1.0f, 1e-5f) << v;
    ASSERT_NEAR(glm::dot(rest.tangent[v], rest.tangent[v]), 1.0f, 1e-5f) << v;
    ASSERT_NEAR(glm::dot(rest.normal[v], rest.tangent[v]), 0.0f, 1e-5f) << v;
  }
}

}  // namespace pelt::test
