#include "core/bind_pose.hpp"

#include <algorithm>
#include <cmath>

#include "core/float_environment.hpp"
#include "core/float_rules.hpp"

namespace pelt {
namespace {

// Row-major 3x4, in double: the same bits on every machine, and none lost to the inverse.
struct Affine {
  double m[3][4];
};

Affine Load(const float (&rows)[12]) {
  Affine a;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 4; ++c) a.m[r][c] = rows[4 * r + c];
  return a;
}

Affine Multiply(const Affine& a, const Affine& b) {
  Affine out;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 4; ++c)
      out.m[r][c] = a.m[r][0] * b.m[0][c] + a.m[r][1] * b.m[1][c] + a.m[r][2] * b.m[2][c] +
                    (c == 3 ? a.m[r][3] : 0.0);
  return out;
}

double Determinant(const Affine& a) {
  const auto& m = a.m;
  return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
         m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
         m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

// A matrix that flattens space has no inverse; the joint then stays where its parent is.
Affine Invert(const Affine& a) {
  const double determinant = Determinant(a);
  Affine out{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
  if (determinant == 0.0) return out;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) {
      const int r1 = (c + 1) % 3, r2 = (c + 2) % 3, c1 = (r + 1) % 3, c2 = (r + 2) % 3;
      out.m[r][c] = (a.m[r1][c1] * a.m[r2][c2] - a.m[r1][c2] * a.m[r2][c1]) / determinant;
    }
  for (int r = 0; r < 3; ++r)
    out.m[r][3] = -(out.m[r][0] * a.m[0][3] + out.m[r][1] * a.m[1][3] + out.m[r][2] * a.m[2][3]);
  return out;
}

// Of a rotation matrix (Shepperd 1978: from the largest of the four).
void FillQuaternion(const double (&m)[3][3], float (&xyzw)[4]) {
  const double trace = m[0][0] + m[1][1] + m[2][2];
  double q[4];
  if (trace > 0.0) {
    q[3] = 1.0 + trace;
    for (int i = 0; i < 3; ++i) q[i] = m[(i + 2) % 3][(i + 1) % 3] - m[(i + 1) % 3][(i + 2) % 3];
  } else {
    int i = m[1][1] > m[0][0] ? 1 : 0;
    if (m[2][2] > m[i][i]) i = 2;
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    q[i] = 1.0 + m[i][i] - m[j][j] - m[k][k];
    q[j] = m[j][i] + m[i][j];
    q[k] = m[k][i] + m[i][k];
    q[3] = m[k][j] - m[j][k];
  }
  const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  for (int i = 0; i < 4; ++i) xyzw[i] = float(q[i] / length);
}

// Translation, rotation and scale; shear, which joints do not have, is lost.
JointTransform Decompose(const Affine& local) {
  JointTransform out;
  const double side = Determinant(local) < 0.0 ? -1.0 : 1.0;
  double rotation[3][3];
  for (int c = 0; c < 3; ++c) {
    const double length = std::sqrt(local.m[0][c] * local.m[0][c] + local.m[1][c] * local.m[1][c] +
                                    local.m[2][c] * local.m[2][c]);
    out.translation[c] = float(local.m[c][3]);
    out.scale[c] = float(side * length);
    for (int r = 0; r < 3; ++r)
      rotation[r][c] = length > 0.0 ? side * local.m[r][c] / length : (r == c ? 1.0 : 0.0);
  }
  FillQuaternion(rotation, out.rotation);
  return out;
}

}  // namespace

void SetJoint(PoseBlock& pose, uint32_t joint, const JointTransform& local) {
  for (int key = 0; key < 4; ++key) {
    const bool used = key == 0;
    for (int c = 0; c < 3; ++c)
      pose.translation_key[key][c][joint] = used ? local.translation[c] : 0;
    for (int c = 0; c < 4; ++c) pose.rotation_key[key][c][joint] = used ? local.rotation[c] : 0;
    for (int c = 0; c < 3; ++c) pose.scale_key[key][c][joint] = used ? local.scale[c] : 0;
    pose.translation_weight[key][joint] = used;
    pose.rotation_weight[key][joint] = used;
    pose.scale_weight[key][joint] = used;
  }
}

void PlaceInMesh(const SkeletonBlock& skeleton, uint32_t joint, const float (&point)[3],
                 double (&in_mesh)[3]) {
  const FloatEnvironment guard;
  const Affine bind = Invert(Load(skeleton.inverse_bind[joint]));
  for (int r = 0; r < 3; ++r)
    in_mesh[r] =
        bind.m[r][0] * point[0] + bind.m[r][1] * point[1] + bind.m[r][2] * point[2] + bind.m[r][3];
}

void FillBindPose(const Groom& groom, PoseBlock& pose) {
  const FloatEnvironment guard;
  const SkeletonBlock& skeleton = groom.skeleton;
  pose.joint_count = groom.joint_count;
  pose.teleported = 0;
  std::fill_n(pose.root, 12, 0.0f);
  for (int axis = 0; axis < 3; ++axis) pose.root[5 * axis] = groom.unit_scale;
  for (uint32_t j = 0; j < groom.joint_count; ++j) {
    Affine local = Invert(Load(skeleton.inverse_bind[j]));
    if (skeleton.parent[j] >= 0)
      local = Multiply(Load(skeleton.inverse_bind[skeleton.parent[j]]), local);
    SetJoint(pose, j, Decompose(local));
  }
  // Kernels read whole groups of lanes.
  for (uint32_t j = groom.joint_count; j < kJointsPerCharacter; ++j) SetJoint(pose, j, {});
}

}  // namespace pelt
