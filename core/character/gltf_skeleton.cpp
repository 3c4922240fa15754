// Skeleton: skin joints and all their ancestors, parents first, from a node graph that may be
// anything.
//
// The frame knows one inverse bind matrix a joint; glTF lets every skin have its own. Where a
// second skin disagrees with the first by one common transform (the usual case: the same pose bound
// from another mesh space) its vertices are moved into the first one's space; where it disagrees
// joint by joint it gets joints of its own, children at the same place.
// Source: glTF 2.0, 3.5 (nodes), 3.7.3 (skins).
#include <algorithm>
#include <cmath>

#include "core/character/gltf_accessor.hpp"
#include "core/character/gltf_read.hpp"
#include "core/float_rules.hpp"

namespace pelt::gltf {
namespace {

class SkeletonReader {
 public:
  SkeletonReader(const Document& document, std::vector<std::string>* notes)
      : document_(document), notes_(notes) {}

  SkeletonImport Read() {
    FindParents();
    FindUses();
    AddNodes();
    for (SkinBinding& binding : out_.bindings) Bind(&binding);
    MakeNamesUnique();
    return std::move(out_);
  }

 private:
  std::string PlaceOf(size_t node) const { return Place("node", node, document_.nodes[node].name); }

  void FindParents() {
    const std::vector<Node>& nodes = document_.nodes;
    parent_.assign(nodes.size(), -1);
    for (size_t n = 0; n < nodes.size(); ++n) {
      for (int child : nodes[n].children) {
        if (child < 0 || size_t(child) >= nodes.size())
          Fail(document_, PlaceOf(n), "child " + std::to_string(child) + " does not exist");
        if (parent_[size_t(child)] >= 0)
          Fail(document_, PlaceOf(size_t(child)),
               "has two parents, nodes " + std::to_string(parent_[size_t(child)]) + " and " +
                   std::to_string(n));
        parent_[size_t(child)] = int(n);
      }
    }
    // With one parent each, a node is on or below a cycle exactly if its way up never ends.
    std::vector<uint8_t> ends(nodes.size(), 0);
    std::vector<size_t> way;
    for (size_t n = 0; n < nodes.size(); ++n) {
      way.clear();
      size_t at = n;
      while (!ends[at] && way.size() <= nodes.size()) {
        way.push_back(at);
        if (parent_[at] < 0) break;
        at = size_t(parent_[at]);
      }
      if (way.size() > nodes.size()) Fail(document_, PlaceOf(n), "is its own ancestor");
      for (size_t w : way) ends[w] = 1;
    }
  }

  void FindUses() {
    const std::vector<Node>& nodes = document_.nodes;
    size_t unskinned = 0, repeated = 0;
    std::vector<int> binding_of_skin(document_.skins.size(), -1);
    std::vector<std::pair<int, int>> seen;
    for (size_t n = 0; n < nodes.size(); ++n) {
      const int mesh = nodes[n].mesh, skin = nodes[n].skin;
      if (mesh < 0) continue;
      if (size_t(mesh) >= document_.meshes.size())
        Fail(document_, PlaceOf(n), "mesh " + std::to_string(mesh) + " does not exist");
      if (skin < 0) {
        ++unskinned;
        continue;
      }
      if (size_t(skin) >= document_.skins.size())
        Fail(document_, PlaceOf(n), "skin " + std::to_string(skin) + " does not exist");
      if (std::find(seen.begin(), seen.end(), std::pair(mesh, skin)) != seen.end()) {
        ++repeated;
        continue;
      }
      seen.emplace_back(mesh, skin);
      int& binding = binding_of_skin[size_t(skin)];
      if (binding < 0) {
        binding = int(out_.bindings.size());
        out_.bindings.push_back({skin, {}, glm::dmat4(1.0)});
      }
      out_.uses.push_back({mesh, binding, int(n)});
    }
    if (out_.uses.empty())
      Fail(document_, "nodes",
           document_.skins.empty() ? "the file has no skin; fur needs a skinned mesh"
                                   : "no node has both a mesh and a skin");
    if (unskinned)
      notes_->push_back(std::to_string(unskinned) + " mesh nodes without a skin were left out.");
    if (repeated)
      notes_->push_back(std::to_string(repeated) +
                        " nodes repeat a mesh with the same skin; they were left out.");
  }

  void AddNodes() {
    const size_t count = document_.nodes.size();
    std::vector<uint8_t> needed(count, 0);
    for (const SkinBinding& binding : out_.bindings) {
      const Skin& skin = document_.skins[size_t(binding.skin)];
      const std::string place = Place("skin", size_t(binding.skin), skin.name);
      if (skin.joints.empty()) Fail(document_, place, "has no joints");
      for (size_t j = 0; j < skin.joints.size(); ++j) {
        const int node = skin.joints[j];
        if (node < 0 || size_t(node) >= count)
          Fail(document_, place,
               "joint " + std::to_string(j) + ": node " + std::to_string(node) + " does not exist");
        for (int n = node; n >= 0 && !needed[size_t(n)]; n = parent_[size_t(n)])
          needed[size_t(n)] = 1;
      }
    }
    out_.joint_of_node.assign(count, -1);
    std::vector<size_t> stack;
    for (size_t root = 0; root < count; ++root) {
      if (parent_[root] >= 0 || !needed[root]) continue;
      stack.push_back(root);
      while (!stack.empty()) {
        const size_t n = stack.back();
        stack.pop_back();
        const int parent = parent_[n] < 0 ? -1 : out_.joint_of_node[size_t(parent_[n])];
        out_.joint_of_node[n] = AddJoint(document_.nodes[n].name, parent, RestOf(n));
        const std::vector<int>& children = document_.nodes[n].children;
        for (size_t c = children.size(); c-- > 0;)
          if (needed[size_t(children[c])]) stack.push_back(size_t(children[c]));
      }
    }
    bound_.assign(out_.skeleton.name.size(), 0);
  }

  int AddJoint(const std::string& name, int parent, const JointPose& rest) {
    Skeleton& skeleton = out_.skeleton;
    if (skeleton.name.size() >= kJointsPerCharacter)
      Fail(document_, "skins",
           "the joints and their ancestors are more than " + std::to_string(kJointsPerCharacter) +
               " nodes");
    skeleton.name.push_back(name);
    skeleton.parent.push_back(parent);
    skeleton.rest.push_back(rest);
    skeleton.inverse_bind.push_back(glm::mat4(1.0f));
    return int(skeleton.name.size()) - 1;
  }

  // `size` finite numbers in float range, or nothing.
  bool ReadNumbers(const std::vector<double>& from, size_t size, size_t node, const char* what,
                   double* to) const {
    if (from.empty()) return false;
    if (from.size() != size)
      Fail(document_, PlaceOf(node),
           std::string(what) + " has " + std::to_string(from.size()) + " numbers, not " +
               std::to_string(size));
    for (size_t i = 0; i < size; ++i) {
      if (!(std::abs(from[i]) < 1e30))
        Fail(document_, PlaceOf(node), std::string(what) + " is not finite or beyond 1e30");
      to[i] = from[i];
    }
    return true;
  }

  JointPose RestOf(size_t node) {
    const Node& from = document_.nodes[node];
    JointPose rest;
    double m[16];
    if (ReadNumbers(from.matrix, 16, node, "matrix", m)) return Decompose(m, node);
    double v[4];
    if (ReadNumbers(from.translation, 3, node, "translation", v))
      rest.translation = glm::vec3(glm::dvec3(v[0], v[1], v[2]));
    if (ReadNumbers(from.scale, 3, node, "scale", v))
      rest.scale = glm::vec3(glm::dvec3(v[0], v[1], v[2]));
    if (ReadNumbers(from.rotation, 4, node, "rotation", v)) {
      const double length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2] + v[3] * v[3]);
      if (!(length > 1e-12)) Fail(document_, PlaceOf(node), "rotation is zero");
      if (std::abs(length - 1.0) > 1e-3)
        notes_->push_back(PlaceOf(node) + ": rotation was not of unit length; normalised.");
      rest.rotation = glm::quat(float(v[3] / length), float(v[0] / length), float(v[1] / length),
                                float(v[2] / length));
    }
    return rest;
  }

  // Column-major affine matrix to translation, rotation and scale; shear is dropped.
  JointPose Decompose(const double* m, size_t node) {
    JointPose rest;
    rest.translation = glm::vec3(glm::dvec3(m[12], m[13], m[14]));
    if (std::abs(m[3]) + std::abs(m[7]) + std::abs(m[11]) + std::abs(m[15] - 1.0) > 1e-6)
      notes_->push_back(PlaceOf(node) + ": the last row of matrix was not 0 0 0 1; ignored.");
    glm::dvec3 axis[3];
    double scale[3];
    for (int c = 0; c < 3; ++c) {
      axis[c] = glm::dvec3(m[4 * c], m[4 * c + 1], m[4 * c + 2]);
      scale[c] = std::sqrt(glm::dot(axis[c], axis[c]));
      if (!(scale[c] > 1e-12)) Fail(document_, PlaceOf(node), "matrix is singular");
      axis[c] /= scale[c];
    }
    if (glm::dot(glm::cross(axis[0], axis[1]), axis[2]) < 0.0) {
      scale[0] = -scale[0];
      axis[0] = -axis[0];
    }
    const double shear = std::abs(glm::dot(axis[0], axis[1])) +
                         std::abs(glm::dot(axis[1], axis[2])) +
                         std::abs(glm::dot(axis[2], axis[0]));
    if (shear > 1e-4) {
      notes_->push_back(PlaceOf(node) + ": matrix has shear, which a joint cannot have; dropped.");
      const glm::dvec3 z = glm::cross(axis[0], axis[1]);
      const double length = std::sqrt(glm::dot(z, z));
      if (!(length > 1e-9)) Fail(document_, PlaceOf(node), "matrix is singular");
      axis[2] = z / length;
      axis[1] = glm::cross(axis[2], axis[0]);
    }
    rest.rotation = ToQuaternion(axis);
    rest.scale = glm::vec3(glm::dvec3(scale[0], scale[1], scale[2]));
    return rest;
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

  std::vector<glm::mat4> ReadInverseBind(const Skin& skin, const std::string& place) const {
    std::vector<glm::mat4> out(skin.joints.size(), glm::mat4(1.0f));
    if (skin.inverse_bind < 0) return out;
    const std::string where = place + " inverseBindMatrices";
    const std::vector<float> m =
        ReadFloats(document_, skin.inverse_bind, {16, kSetF32, Scaling::kAsFlagged}, where);
    if (m.size() < 16 * out.size())
      Fail(document_, where,
           std::to_string(m.size() / 16) + " matrices for " + std::to_string(out.size()) +
               " joints");
    for (size_t j = 0; j < out.size(); ++j) {
      for (int c = 0; c < 4; ++c)
        for (int r = 0; r < 4; ++r) {
          const float v = m[16 * j + 4 * size_t(c) + size_t(r)];
          if (!(std::abs(v) < 1e30f))
            Fail(document_, where, "matrix " + std::to_string(j) + " is beyond 1e30");
          out[j][c][r] = r == 3 ? (c == 3 ? 1.0f : 0.0f) : v;
        }
    }
    return out;
  }

  void Bind(SkinBinding* binding) {
    const Skin& skin = document_.skins[size_t(binding->skin)];
    const std::string place = Place("skin", size_t(binding->skin), skin.name);
    const std::vector<glm::mat4> inverse_bind = ReadInverseBind(skin, place);
    binding->to_bind = FindCommonTransform(skin, inverse_bind);
    const glm::dmat4 from_bind = glm::inverse(binding->to_bind);
    const bool moved = binding->to_bind != glm::dmat4(1.0);
    size_t own = 0;
    std::vector<uint8_t> taken(out_.skeleton.name.size(), 0);
    for (size_t j = 0; j < skin.joints.size(); ++j) {
      int joint = out_.joint_of_node[size_t(skin.joints[j])];
      if (taken[size_t(joint)])
        Fail(document_, place, "joint " + std::to_string(j) + " repeats an earlier one");
      taken[size_t(joint)] = 1;
      const glm::mat4 wanted =
          moved ? glm::mat4(glm::dmat4(inverse_bind[j]) * from_bind) : inverse_bind[j];
      if (!bound_[size_t(joint)]) {
        bound_[size_t(joint)] = 1;
        out_.skeleton.inverse_bind[size_t(joint)] = wanted;
      } else if (!Near(out_.skeleton.inverse_bind[size_t(joint)], wanted)) {
        joint = AddJoint(
            out_.skeleton.name[size_t(joint)] + " of skin " + std::to_string(binding->skin), joint,
            JointPose{});
        bound_.push_back(1);
        taken.push_back(1);
        out_.skeleton.inverse_bind[size_t(joint)] = wanted;
        ++own;
      }
      binding->joint.push_back(uint8_t(joint));
    }
    if (moved)
      notes_->push_back(place + " is bound from another mesh space; its vertices were moved.");
    if (own)
      notes_->push_back(place + " binds " + std::to_string(own) +
                        " shared joints differently; it got joints of its own.");
  }

  static bool Near(const glm::mat4& a, const glm::mat4& b) {
    for (int c = 0; c < 4; ++c)
      for (int r = 0; r < 4; ++r)
        if (std::abs(a[c][r] - b[c][r]) > 1e-5f * (1.0f + std::abs(a[c][r]))) return false;
    return true;
  }

  // M with inverse_bind[j] = bound[j] * M for every joint bound before, or the identity.
  glm::dmat4 FindCommonTransform(const Skin& skin,
                                 const std::vector<glm::mat4>& inverse_bind) const {
    glm::dmat4 common(1.0);
    bool found = false;
    for (size_t j = 0; j < skin.joints.size(); ++j) {
      const size_t joint = size_t(out_.joint_of_node[size_t(skin.joints[j])]);
      if (!bound_[joint]) continue;
      const glm::dmat4 bound(out_.skeleton.inverse_bind[joint]);
      if (!(std::abs(glm::determinant(bound)) > 1e-30)) return glm::dmat4(1.0);
      const glm::dmat4 m = glm::inverse(bound) * glm::dmat4(inverse_bind[j]);
      if (found && !Near(glm::mat4(common), glm::mat4(m))) return glm::dmat4(1.0);
      if (!found) common = m;
      found = true;
    }
    const bool usable = found && std::abs(glm::determinant(common)) > 1e-12 &&
                        !Near(glm::mat4(common), glm::mat4(1.0f));
    return usable ? common : glm::dmat4(1.0);
  }

  void MakeNamesUnique() {
    std::vector<std::string>& names = out_.skeleton.name;
    for (size_t n = 0; n < names.size(); ++n) {
      std::string name = names[n].empty() ? "joint " + std::to_string(n) : names[n];
      auto used = [&](const std::string& s) {
        return std::find(names.begin(), names.begin() + ptrdiff_t(n), s) !=
               names.begin() + ptrdiff_t(n);
      };
      std::string unique = name;
      for (int copy = 2; used(unique); ++copy) unique = name + " " + std::to_string(copy);
      if (!names[n].empty() && unique != name)
        notes_->push_back("two joints are called '" + name + "'; the second is now '" + unique +
                          "'.");
      names[n] = unique;
    }
  }

  const Document& document_;
  std::vector<std::string>* notes_;
  std::vector<int> parent_;
  std::vector<uint8_t> bound_;  // joint has its inverse bind matrix
  SkeletonImport out_;
};

}  // namespace

SkeletonImport ReadSkeleton(const Document& document, std::vector<std::string>* notes) {
  return SkeletonReader(document, notes).Read();
}

std::string Place(const char* kind, size_t index, const std::string& name) {
  std::string place = std::string(kind) + " " + std::to_string(index);
  if (!name.empty()) place += " '" + name + "'";
  return place;
}

}  // namespace pelt::gltf
