// What the frame does with a PoseBlock, written once more, slowly and in double: blend the keys,
// walk the hierarchy, skin. Independent of core's own rest-pose code.
#pragma once

#include <cmath>
#include <glm/glm.hpp>
#include <vector>

#include "core/character/character.hpp"
#include "core/chunk.hpp"

namespace pelt::test {

struct LocalPose {
  glm::dvec3 translation{0.0}, scale{0.0};
  glm::dvec4 rotation{0.0};  // unit xyzw
};

inline LocalPose BlendKeys(const PoseBlock& pose, size_t j) {
  LocalPose out;
  for (size_t k = 0; k < 4; ++k) {
    for (int c = 0; c < 3; ++c) {
      out.translation[c] += double(pose.translation_key[k][c][j]) * pose.translation_weight[k][j];
      out.scale[c] += double(pose.scale_key[k][c][j]) * pose.scale_weight[k][j];
    }
    for (int c = 0; c < 4; ++c)
      out.rotation[c] += double(pose.rotation_key[k][c][j]) * pose.rotation_weight[k][j];
  }
  out.rotation /= std::sqrt(glm::dot(out.rotation, out.rotation));
  return out;
}

inline glm::dvec3 Turn(const glm::dvec4& q, const glm::dvec3& v) {
  const glm::dvec3 u(q);
  return v + 2.0 * glm::cross(u, glm::cross(u, v) + q.w * v);
}

// Joint to skeleton space, with `root` applied.
inline std::vector<glm::dmat4> WalkHierarchy(const PoseBlock& pose, const SkeletonBlock& skeleton) {
  glm::dmat4 root(1.0);
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 4; ++c) root[c][r] = pose.root[4 * r + c];
  std::vector<glm::dmat4> out;
  for (size_t j = 0; j < pose.joint_count; ++j) {
    const LocalPose local = BlendKeys(pose, j);
    glm::dmat4 m(1.0);
    for (int c = 0; c < 3; ++c) {
      glm::dvec3 axis(0.0);
      axis[c] = local.scale[c];
      m[c] = glm::dvec4(Turn(local.rotation, axis), 0.0);
    }
    m[3] = glm::dvec4(local.translation, 1.0);
    const int parent = skeleton.parent[j];
    out.push_back((parent < 0 ? root : out[size_t(parent)]) * m);
  }
  return out;
}

inline std::vector<glm::dvec3> SkinPositions(const Mesh& mesh, const PoseBlock& pose,
                                             const SkeletonBlock& skeleton) {
  const std::vector<glm::dmat4> joint = WalkHierarchy(pose, skeleton);
  std::vector<glm::dvec3> out;
  for (size_t v = 0; v < mesh.position.size(); ++v) {
    glm::dvec3 sum(0.0);
    for (size_t i = 0; i < 4; ++i) {
      const size_t j = mesh.joints[v][i];
      const float* b = skeleton.inverse_bind[j];
      const glm::dvec3 p(mesh.position[v]);
      glm::dvec3 bound;
      for (int r = 0; r < 3; ++r)
        bound[r] = b[4 * r] * p.x + b[4 * r + 1] * p.y + b[4 * r + 2] * p.z + b[4 * r + 3];
      sum += double(mesh.weights[v][int(i)]) * glm::dvec3(joint[j] * glm::dvec4(bound, 1.0));
    }
    out.push_back(sum);
  }
  return out;
}

}  // namespace pelt::test
