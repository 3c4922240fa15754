#include "core/character/clip_loop.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/character/pose.hpp"
#include "core/float_rules.hpp"

namespace pelt {
namespace {

constexpr size_t kVertices = 256;  // that are looked at
constexpr int kPlaces = 32;        // in the clip where its pace is measured
constexpr double kStep_s = 1.0 / 60.0, kSteps = 4.0, kShare = 0.02;

// The skeleton and some of the mesh.
Character TakeFew(const Character& from) {
  Character few;
  few.skeleton = from.skeleton;
  const size_t count = from.mesh.position.size();
  const size_t step = std::max<size_t>(1, count / kVertices);
  for (size_t v = 0; v < count; v += step) {
    few.mesh.position.push_back(from.mesh.position[v]);
    few.mesh.normal.push_back(from.mesh.normal[v]);
    few.mesh.tangent.push_back(from.mesh.tangent[v]);
    few.mesh.joints.push_back(from.mesh.joints[v]);
    few.mesh.weights.push_back(from.mesh.weights[v]);
  }
  return few;
}

JointPose JointOf(const PoseBlock& pose, size_t j) {
  JointPose out{glm::vec3(0.0f), glm::quat(0.0f, 0.0f, 0.0f, 0.0f), glm::vec3(0.0f)};
  glm::vec4 q(0.0f);
  for (size_t k = 0; k < 4; ++k) {
    for (int c = 0; c < 3; ++c) {
      out.translation[c] += pose.translation_key[k][size_t(c)][j] * pose.translation_weight[k][j];
      out.scale[c] += pose.scale_key[k][size_t(c)][j] * pose.scale_weight[k][j];
    }
    for (int c = 0; c < 4; ++c)
      q[c] += pose.rotation_key[k][size_t(c)][j] * pose.rotation_weight[k][j];
  }
  const float length = std::sqrt(glm::dot(q, q));
  if (length > 0.0f) q /= length;
  out.rotation = glm::quat(q.w, q.x, q.y, q.z);
  return out;
}

// `few` posed, in the file's units.
std::vector<glm::vec3> PlacesAt(Character& few, const Skeleton& skeleton, const Clip& clip,
                                double time_s) {
  const auto pose =
      std::make_unique<PoseBlock>(MakePose(skeleton, &clip, time_s, false, glm::mat4(1.0f)));
  for (size_t j = 0; j < few.skeleton.rest.size(); ++j) few.skeleton.rest[j] = JointOf(*pose, j);
  return ComputeRestGeometry(few, 1.0f).position;
}

double LargestStep(const std::vector<glm::vec3>& from, const std::vector<glm::vec3>& to) {
  double largest = 0.0;
  for (size_t v = 0; v < from.size(); ++v) {
    const glm::dvec3 d = glm::dvec3(to[v]) - glm::dvec3(from[v]);
    largest = std::max(largest, std::sqrt(glm::dot(d, d)));
  }
  return largest;
}

}  // namespace

bool JumpsWhereItLoops(const Character& character, const Clip& clip) {
  const double end_s = double(clip.duration_s);
  if (clip.tracks.empty() || !(end_s > 0.0)) return false;
  Character few = TakeFew(character);
  const Skeleton& skeleton = character.skeleton;
  const double extent = BoundPlaces(ComputeRestGeometry(few, 1.0f).position).LargestSide();
  const double jump =
      LargestStep(PlacesAt(few, skeleton, clip, end_s), PlacesAt(few, skeleton, clip, 0.0));
  if (!(jump > kShare * extent)) return false;
  double pace = 0.0;
  for (int i = 0; i < kPlaces && jump > kSteps * pace; ++i) {
    const double at_s = std::max(end_s - kStep_s, 0.0) * i / (kPlaces - 1);
    pace = std::max(pace, LargestStep(PlacesAt(few, skeleton, clip, at_s),
                                      PlacesAt(few, skeleton, clip, at_s + kStep_s)));
  }
  return jump > kSteps * pace;
}

}  // namespace pelt
