#include "core/groom/comb.hpp"

#include <algorithm>
#include <cmath>

#include "core/exact_math.hpp"
#include "core/float_rules.hpp"
#include "core/groom/growth.hpp"
#include "core/groom/setup_names.hpp"

namespace pelt {
namespace {

double Square(const glm::dvec3& v) { return glm::dot(v, v); }

glm::dvec3 UnitOr(const glm::dvec3& v, const glm::dvec3& fallback) {
  const double square = Square(v);
  return square > 1e-24 ? v / std::sqrt(square) : fallback;
}

// Rest-pose origin of a skeleton node in file units.
std::vector<glm::dvec3> FindJointOrigins(const Skeleton& skeleton) {
  std::vector<glm::dvec3> origin(skeleton.parent.size());
  std::vector<glm::dmat4> global(skeleton.parent.size());
  for (size_t j = 0; j < global.size(); ++j) {
    const JointPose& pose = skeleton.rest[j];
    const glm::dmat3 rotation(glm::mat3_cast(glm::dquat(pose.rotation)));
    glm::dmat4 local(1.0);
    for (int axis = 0; axis < 3; ++axis) {
      local[axis] = glm::dvec4(rotation[axis] * double(pose.scale[axis]), 0.0);
    }
    local[3] = glm::dvec4(glm::dvec3(pose.translation), 1.0);
    const int32_t parent = skeleton.parent[j];
    global[j] = parent >= 0 ? global[size_t(parent)] * local : local;
    origin[j] = glm::dvec3(global[j][3]);
  }
  return origin;
}

// From the joint to its first child; for the last of a limb from its parent.
glm::dvec3 FindJointDirection(const Skeleton& skeleton, size_t joint) {
  const std::vector<glm::dvec3> origin = FindJointOrigins(skeleton);
  for (size_t j = joint + 1; j < origin.size(); ++j) {
    if (skeleton.parent[j] != int32_t(joint)) continue;
    const glm::dvec3 direction = UnitOr(origin[j] - origin[joint], glm::dvec3(0.0));
    if (Square(direction) > 0.0) return direction;
  }
  const int32_t parent = skeleton.parent[joint];
  if (parent < 0) return glm::dvec3(0.0);
  return UnitOr(origin[joint] - origin[size_t(parent)], glm::dvec3(0.0));
}

}  // namespace

RootFrame MakeRootFrame(const glm::dvec3& normal, const glm::dvec3& tangent) {
  RootFrame frame;
  frame.normal = UnitOr(normal, glm::dvec3(0.0, 1.0, 0.0));
  const glm::dvec3 n = frame.normal;
  const glm::dvec3 across =
      std::abs(n.x) < 0.7 ? glm::dvec3(1.0, 0.0, 0.0) : glm::dvec3(0.0, 0.0, 1.0);
  const glm::dvec3 fallback = UnitOr(across - n * glm::dot(n, across), across);
  frame.tangent = UnitOr(tangent - n * glm::dot(n, tangent), fallback);
  frame.bitangent = glm::cross(frame.normal, frame.tangent);
  return frame;
}

Comb::Comb(const Character& character, const RestGeometry& rest, const FurSetup& setup,
           const LayerSetup& layer)
    : normal_weight_(std::clamp(double(layer.comb_normal_weight), 0.0, 1.0)) {
  for (const CombVector& vector : layer.comb) {
    const glm::dvec3 position(vector.position);
    // A comb vector belongs to the nearest surface.
    glm::dvec3 normal(0.0);
    double nearest = 1e300;
    for (size_t v = 0; v < rest.position.size(); ++v) {
      const double square = Square(glm::dvec3(rest.position[v]) - position);
      if (square < nearest) {
        nearest = square;
        normal = glm::dvec3(rest.normal[v]);
      }
    }
    const glm::dvec3 direction = UnitOr(glm::dvec3(vector.direction), glm::dvec3(0.0));
    if (vector.reach > 0.0f && Square(direction) > 0.0) {
      vectors_.push_back({position, direction, normal, double(vector.reach)});
    }
  }
  if (layer.comb_joint.empty()) return;
  const auto named = FindJoints(character.skeleton, setup, layer, "comb_joint", layer.comb_joint,
                                /*subtree=*/false);
  const size_t joint = size_t(std::find(named.begin(), named.end(), 1) - named.begin());
  joint_direction_ = FindJointDirection(character.skeleton, joint);
  if (Square(joint_direction_) == 0.0) {
    FailLayerKey(setup, layer, "comb_joint",
                 "joint '" + layer.comb_joint +
                     "' has neither a child nor a parent at another place, so no direction; name "
                     "another joint, or leave it out and use azimuth and elevation");
  }
  has_joint_ = true;
}

glm::dvec3 Comb::Direction(const glm::vec3& position, const RootFrame& frame, double azimuth,
                           double elevation) const {
  const glm::dvec3 up(0.0, 0.0, 1.0);
  glm::dvec3 heading;  // along the surface
  if (has_joint_) {
    // Not made unit: where the joint points out of the surface, the heading fades and the strand
    // stands up, instead of turning abruptly.
    heading = frame.ToFrame(joint_direction_);
    heading.z = 0.0;
  } else {
    heading = {exact::Cos(azimuth * exact::kRadiansPerDegree),
               exact::Sin(azimuth * exact::kRadiansPerDegree), 0.0};
  }
  const double raise = elevation * exact::kRadiansPerDegree;
  const glm::dvec3 fallback = UnitOr(heading * exact::Cos(raise) + up * exact::Sin(raise), up);

  glm::dvec3 combed(0.0);
  double left = 1.0;  // share of the direction that no vector has taken
  for (const Vector& vector : vectors_) {
    const double square = Square(glm::dvec3(position) - vector.position);
    if (square >= vector.reach * vector.reach) continue;
    const double near = 1.0 - square / (vector.reach * vector.reach);
    const double facing = std::max(0.0, glm::dot(vector.normal, frame.normal));
    const double weight = near * near * (1.0 - normal_weight_ * (1.0 - facing));
    combed += frame.ToFrame(vector.direction) * weight;
    left *= 1.0 - weight;
  }
  if (left == 1.0) return fallback;
  return UnitOr(UnitOr(combed, fallback) * (1.0 - left) + fallback * left, fallback);
}

}  // namespace pelt
