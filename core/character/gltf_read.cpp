#include "core/character/gltf_read.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/character/gltf_accessor.hpp"
#include "core/character/mesh_repair.hpp"
#include "core/chunk.hpp"
#include "core/float_rules.hpp"
#include "core/format.hpp"

namespace pelt::gltf {
namespace {

// How a node rests in its parent: its translation, rotation and scale, or a matrix taken apart.
class RestReader {
 public:
  RestReader(const std::string& place, std::vector<std::string>* notes)
      : place_(place), notes_(notes) {}

  // `size` finite numbers in float range, or nothing.
  bool ReadNumbers(const std::vector<double>& from, size_t size, const char* what,
                   double* to) const {
    if (from.empty()) return false;
    const bool usable = from.size() == size && std::all_of(from.begin(), from.end(), [](double v) {
                          return std::abs(v) < 1e30;
                        });
    if (!usable)
      notes_->push_back(
          Format("{}: {} is not {} numbers below 1e30; it was left out.", place_, what, size));
    else
      std::copy(from.begin(), from.end(), to);
    return usable;
  }

  JointPose Read(const Node& from) const {
    JointPose rest;
    double m[16];
    if (ReadNumbers(from.matrix, 16, "matrix", m)) return Decompose(m);
    double v[4];
    if (ReadNumbers(from.translation, 3, "translation", v))
      rest.translation = glm::vec3(glm::dvec3(v[0], v[1], v[2]));
    if (ReadNumbers(from.scale, 3, "scale", v))
      rest.scale = glm::vec3(glm::dvec3(v[0], v[1], v[2]));
    if (ReadNumbers(from.rotation, 4, "rotation", v)) {
      const double length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2] + v[3] * v[3]);
      if (!(length > 1e-12)) {
        notes_->push_back(place_ + ": rotation is zero; it was left out.");
        return rest;
      }
      if (std::abs(length - 1.0) > 1e-3)
        notes_->push_back(place_ + ": rotation was not of unit length; normalised.");
      rest.rotation = glm::quat(float(v[3] / length), float(v[0] / length), float(v[1] / length),
                                float(v[2] / length));
    }
    return rest;
  }

  // Column-major affine matrix to translation, rotation and scale; shear is dropped.
  JointPose Decompose(const double* m) const {
    JointPose rest;
    rest.translation = glm::vec3(glm::dvec3(m[12], m[13], m[14]));
    if (std::abs(m[3]) + std::abs(m[7]) + std::abs(m[11]) + std::abs(m[15] - 1.0) > 1e-6)
      notes_->push_back(place_ + ": the last row of matrix was not 0 0 0 1; ignored.");
    glm::dvec3 axis[3];
    double scale[3];
    for (int c = 0; c < 3; ++c) {
      axis[c] = glm::dvec3(m[4 * c], m[4 * c + 1], m[4 * c + 2]);
      scale[c] = std::sqrt(glm::dot(axis[c], axis[c]));
      if (scale[c] > 1e-30) axis[c] /= scale[c];
    }
    if (MakeAxes(scale, axis))
      notes_->push_back(place_ + ": matrix has shear, which a joint cannot have; dropped.");
    rest.rotation = ToQuaternion(axis);
    rest.scale = glm::vec3(glm::dvec3(scale[0], scale[1], scale[2]));
    return rest;
  }

  // Right-handed and at right angles; an axis of no length is what the others leave. Whether they
  // were not at right angles.
  static bool MakeAxes(double (&scale)[3], glm::dvec3 (&axis)[3]) {
    const auto is_flat = [&](int c) { return !(scale[c] > 1e-30); };
    const int flat = int(is_flat(0)) + int(is_flat(1)) + int(is_flat(2));
    for (int c = 0; c < 3; ++c)
      if (flat == 1 && is_flat(c)) {
        axis[c] = glm::cross(axis[(c + 1) % 3], axis[(c + 2) % 3]);
        scale[c] = 0.0;
      }
    if (flat > 1) {  // one direction, or none
      for (int c = 0; c < 3; ++c)
        if (!is_flat(c)) {
          axis[(c + 1) % 3] = PickTangent(axis[c]);
          axis[(c + 2) % 3] = glm::cross(axis[c], axis[(c + 1) % 3]);
        }
      if (flat == 3) axis[0] = {1, 0, 0}, axis[1] = {0, 1, 0}, axis[2] = {0, 0, 1};
    }
    if (glm::dot(glm::cross(axis[0], axis[1]), axis[2]) < 0.0) {
      scale[0] = -scale[0];
      axis[0] = -axis[0];
    }
    const double shear = std::abs(glm::dot(axis[0], axis[1])) +
                         std::abs(glm::dot(axis[1], axis[2])) +
                         std::abs(glm::dot(axis[2], axis[0]));
    if (!(shear > 1e-4)) return false;
    const glm::dvec3 z = glm::cross(axis[0], axis[1]);
    const double length = std::sqrt(glm::dot(z, z));
    axis[2] = length > 1e-9 ? z / length : PickTangent(axis[0]);
    axis[1] = glm::cross(axis[2], axis[0]);
    return true;
  }

  // From the columns of a rotation matrix; the largest of the four components is found first, so
  // nothing is divided by a small number.
  static glm::quat ToQuaternion(const glm::dvec3 (&a)[3]) {
    const double w = 1.0 + a[0].x + a[1].y + a[2].z, x = 1.0 + a[0].x - a[1].y - a[2].z;
    const double y = 1.0 - a[0].x + a[1].y - a[2].z, z = 1.0 - a[0].x - a[1].y + a[2].z;
    glm::dvec4 q;  // xyzw, of some length
    if (w >= x && w >= y && w >= z) {
      q = {a[1].z - a[2].y, a[2].x - a[0].z, a[0].y - a[1].x, w};
    } else if (x >= y && x >= z) {
      q = {x, a[0].y + a[1].x, a[0].z + a[2].x, a[1].z - a[2].y};
    } else if (y >= z) {
      q = {a[0].y + a[1].x, y, a[1].z + a[2].y, a[2].x - a[0].z};
    } else {
      q = {a[0].z + a[2].x, a[1].z + a[2].y, z, a[0].y - a[1].x};
    }
    q /= std::sqrt(glm::dot(q, q));
    return glm::quat(float(q.w), float(q.x), float(q.y), float(q.z));
  }

  const std::string place_;
  std::vector<std::string>* notes_;
};

}  // namespace

JointPose RestOf(const Document& document, size_t node, std::vector<std::string>* notes) {
  const Node& from = document.nodes[node];
  return RestReader(Place("node", node, from.name), notes).Read(from);
}

std::vector<int> FinishSkeleton(const Document& document, const std::vector<uint8_t>& used,
                                SkeletonImport* import, std::vector<std::string>* notes) {
  Skeleton& from = import->skeleton;
  const size_t count = from.name.size();
  const bool all = count <= kJointsPerCharacter;
  std::vector<uint8_t> kept(count, all);
  for (size_t j = count; j-- > 0;) {
    kept[j] |= used[j];
    if (kept[j] && from.parent[j] >= 0) kept[size_t(from.parent[j])] = 1;
  }
  std::vector<int> now(count, -1);
  Skeleton to;
  for (size_t j = 0; j < count; ++j) {
    if (!kept[j]) continue;
    now[j] = int(to.name.size());
    to.name.push_back(from.name[j]);
    to.parent.push_back(from.parent[j] < 0 ? -1 : now[size_t(from.parent[j])]);
    to.rest.push_back(from.rest[j]);
    to.inverse_bind.push_back(from.inverse_bind[j]);
  }
  if (to.name.size() > kJointsPerCharacter)
    Fail(document, "skins",
         Format("{} joints move vertices or what does; a character holds {}", to.name.size(),
                kJointsPerCharacter));
  if (!all)
    notes->push_back(Format("{} of {} joints move no vertex; they were left out.",
                            count - to.name.size(), count));
  for (int& joint : import->joint_of_node)
    if (joint >= 0) joint = now[size_t(joint)];
  from = std::move(to);
  std::vector<std::string*> names;
  for (std::string& name : from.name) names.push_back(&name);
  MakeNamesUnique("joint", names, notes);
  return now;
}

void MakeNamesUnique(const std::string& kind, std::vector<std::string*> names,
                     std::vector<std::string>* notes) {
  std::set<std::string> taken;
  std::map<std::string, size_t> copies;
  for (size_t n = 0; n < names.size(); ++n) {
    const bool unnamed = names[n]->empty();
    const std::string name = unnamed ? kind + " " + std::to_string(n) : *names[n];
    std::string unique = name;
    for (size_t& copy = copies[name]; taken.count(unique);)
      unique = name + " " + std::to_string(++copy + 1);
    taken.insert(unique);
    if (!unnamed && unique != name)
      notes->push_back(
          Format("two {}s are called '{}'; the second is now '{}'.", kind, name, unique));
    *names[n] = unique;
  }
}

std::string Place(const char* kind, size_t index, const std::string& name) {
  std::string place = std::string(kind) + " " + std::to_string(index);
  if (!name.empty()) place += " '" + name + "'";
  return place;
}

}  // namespace pelt::gltf
