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
#include <set>

#include "core/character/gltf_accessor.hpp"
#include "core/character/gltf_read.hpp"
#include "core/character/pose.hpp"
#include "core/float_rules.hpp"
#include "core/format.hpp"

namespace pelt::gltf {
namespace {

constexpr size_t kMostSteps = 256;  // from a mesh up to what it hangs on

class SkeletonReader {
 public:
  SkeletonReader(const Document& document, std::vector<std::string>* notes)
      : document_(document), notes_(notes) {}

  SkeletonImport Read() {
    tree_ = ReadTree(document_, notes_);
    FindUses();
    AddNodes();
    for (SkinBinding& binding : out_.bindings) Bind(&binding);
    for (MeshUse& use : out_.uses) FindHolder(&use);
    return std::move(out_);
  }

 private:
  std::string PlaceOf(size_t node) const { return Place("node", node, document_.nodes[node].name); }

  // Why a node with a mesh and a skin cannot be read, or nothing.
  std::string WhyUnusable(const Node& node) const {
    if (node.mesh < 0 || size_t(node.mesh) >= document_.meshes.size())
      return "mesh " + std::to_string(node.mesh) + " does not exist";
    if (size_t(node.skin) >= document_.skins.size())
      return "skin " + std::to_string(node.skin) + " does not exist";
    const Skin& skin = document_.skins[size_t(node.skin)];
    if (std::none_of(skin.joints.begin(), skin.joints.end(), [&](int n) { return Exists(n); }))
      return Place("skin", size_t(node.skin), skin.name) + " has no joints";
    return {};
  }

  bool Exists(int node) const { return node >= 0 && size_t(node) < document_.nodes.size(); }

  void FindUses() {
    const std::vector<Node>& nodes = document_.nodes;
    size_t unskinned = 0, repeated = 0;
    std::string fault;  // the first
    std::vector<int> binding_of_skin(document_.skins.size(), -1);
    std::set<std::pair<int, int>> seen;
    for (size_t n = 0; n < nodes.size(); ++n) {
      const int mesh = nodes[n].mesh, skin = nodes[n].skin;
      if (mesh == -1 || !tree_.shown[n]) continue;
      if (skin == -1) {
        ++unskinned;
        continue;
      }
      if (const std::string why = WhyUnusable(nodes[n]); !why.empty()) {
        notes_->push_back(PlaceOf(n) + ": " + why + "; left out.");
        if (fault.empty()) fault = PlaceOf(n) + ": " + why;
        continue;
      }
      if (!seen.emplace(mesh, skin).second) {
        ++repeated;
        continue;
      }
      int& binding = binding_of_skin[size_t(skin)];
      if (binding < 0) {
        binding = int(out_.bindings.size());
        out_.bindings.push_back({skin, {}, glm::dmat4(1.0)});
      }
      out_.uses.push_back({mesh, binding, int(n)});
    }
    if (out_.uses.empty() && !fault.empty()) throw Error(document_.name + ": " + fault);
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
      size_t nowhere = 0;
      for (const int joint : skin.joints) {
        nowhere += !Exists(joint);
        for (int n = Exists(joint) ? joint : -1; n >= 0 && !needed[size_t(n)];
             n = tree_.parent[size_t(n)])
          needed[size_t(n)] = 1;
      }
      if (nowhere)
        notes_->push_back(Format("{}: {} joints do not exist; what hangs on them hangs elsewhere.",
                                 Place("skin", size_t(binding.skin), skin.name), nowhere));
    }
    out_.joint_of_node.assign(count, -1);
    std::vector<size_t> stack;
    for (size_t root = 0; root < count; ++root) {
      if (tree_.parent[root] >= 0 || !needed[root]) continue;
      stack.push_back(root);
      while (!stack.empty()) {
        const size_t n = stack.back();
        stack.pop_back();
        const int above = tree_.parent[n];
        const int parent = above < 0 ? -1 : out_.joint_of_node[size_t(above)];
        out_.joint_of_node[n] =
            AddJoint(document_.nodes[n].name, parent, RestOf(document_, n, notes_));
        const std::vector<int>& children = document_.nodes[n].children;
        for (size_t c = children.size(); c-- > 0;)
          if (Exists(children[c]) && needed[size_t(children[c])] &&
              tree_.parent[size_t(children[c])] == int(n) &&
              out_.joint_of_node[size_t(children[c])] < 0)
            stack.push_back(size_t(children[c]));
      }
    }
    bound_.assign(out_.skeleton.name.size(), 0);
  }

  int AddJoint(const std::string& name, int parent, const JointPose& rest) {
    Skeleton& skeleton = out_.skeleton;
    skeleton.name.push_back(name);
    skeleton.parent.push_back(parent);
    skeleton.rest.push_back(rest);
    skeleton.inverse_bind.push_back(glm::mat4(1.0f));
    return int(skeleton.name.size()) - 1;
  }

  glm::mat4 InverseOfRest(int joint) {
    const Skeleton& skeleton = out_.skeleton;
    for (size_t j = rest_world_.size(); j <= size_t(joint); ++j) {
      const glm::dmat4 local = MatrixOf(skeleton.rest[j]);
      const int parent = skeleton.parent[j];
      rest_world_.push_back(parent < 0 ? local : rest_world_[size_t(parent)] * local);
    }
    const glm::dmat4& world = rest_world_[size_t(joint)];
    return IsInvertible(world) ? glm::mat4(glm::inverse(world)) : glm::mat4(1.0f);
  }

  std::vector<glm::mat4> ReadInverseBind(const Skin& skin, const std::string& place) {
    std::vector<glm::mat4> out(skin.joints.size(), glm::mat4(1.0f));
    if (skin.inverse_bind == -1) return out;
    Fault fault;
    const std::vector<float> m =
        ReadFloats(document_, skin.inverse_bind, {16, kSetF32, Scaling::kAsFlagged, false},
                   place + " inverseBindMatrices", fault);
    if (fault) notes_->push_back(fault.text + "; left out.");
    size_t made = 0;
    for (size_t j = 0; j < out.size(); ++j) {
      const auto first = m.begin() + std::ptrdiff_t(std::min(16 * j, m.size()));
      const bool whole = m.end() - first >= 16 && std::all_of(first, first + 16, [](float v) {
                           return std::abs(v) < 1e30f;
                         });
      for (int c = 0; whole && c < 4; ++c)
        for (int r = 0; r < 3; ++r) out[j][c][r] = first[4 * c + r];
      if (whole || !Exists(skin.joints[j])) continue;
      out[j] = InverseOfRest(out_.joint_of_node[size_t(skin.joints[j])]);
      ++made;
    }
    if (made)
      notes_->push_back(
          Format("{}: {} inverse bind matrices are missing or no numbers below 1e30; "
                 "those of the rest pose were taken.",
                 place, made));
    return out;
  }

  void Bind(SkinBinding* binding) {
    const Skin& skin = document_.skins[size_t(binding->skin)];
    const std::string place = Place("skin", size_t(binding->skin), skin.name);
    const std::vector<glm::mat4> inverse_bind = ReadInverseBind(skin, place);
    for (const glm::mat4& m : inverse_bind) largest_.Add(m);
    binding->to_bind = FindCommonTransform(skin, inverse_bind);
    const glm::dmat4 from_bind = glm::inverse(binding->to_bind);
    const bool moved = binding->to_bind != glm::dmat4(1.0);
    size_t own = 0;
    for (size_t j = 0; j < skin.joints.size(); ++j) {
      if (!Exists(skin.joints[j])) {
        binding->joint.push_back(-1);
        continue;
      }
      int joint = out_.joint_of_node[size_t(skin.joints[j])];
      const glm::mat4 wanted =
          moved ? glm::mat4(glm::dmat4(inverse_bind[j]) * from_bind) : inverse_bind[j];
      if (!bound_[size_t(joint)]) {
        bound_[size_t(joint)] = 1;
        out_.skeleton.inverse_bind[size_t(joint)] = wanted;
      } else if (!Near(out_.skeleton.inverse_bind[size_t(joint)], wanted, largest_)) {
        joint = AddJoint(
            out_.skeleton.name[size_t(joint)] + " of skin " + std::to_string(binding->skin), joint,
            JointPose{});
        bound_.push_back(1);
        out_.skeleton.inverse_bind[size_t(joint)] = wanted;
        ++own;
      }
      binding->joint.push_back(joint);
    }
    if (moved)
      notes_->push_back(place + " is bound from another mesh space; its vertices were moved.");
    if (own)
      notes_->push_back(place + " binds " + std::to_string(own) +
                        " shared joints differently; it got joints of its own.");
  }

  // The largest numbers of matrices that are compared with each other: files are in millimetres as
  // in metres, and a difference counts by the size of what differs.
  struct Largest {
    float turn = 0.0f, place = 0.0f;
    void Add(const glm::mat4& m) {
      for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c) turn = std::max(turn, std::abs(m[c][r]));
        place = std::max(place, std::abs(m[3][r]));
      }
    }
  };

  // A tenth of a millimetre for a body of a metre.
  static bool Near(const glm::mat4& a, const glm::mat4& b, const Largest& largest) {
    constexpr float kShare = 1e-4f;
    const float place = kShare * largest.place + 1e-7f * largest.turn;
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c)
        if (!(std::abs(a[c][r] - b[c][r]) <= kShare * largest.turn)) return false;
      if (!(std::abs(a[3][r] - b[3][r]) <= place)) return false;
    }
    return true;
  }

  // Whether it is, independent of the units.
  static bool IsInvertible(const glm::dmat4& m) {
    double largest = 0.0;
    for (int c = 0; c < 3; ++c)
      for (int r = 0; r < 3; ++r) largest = std::max(largest, std::abs(m[c][r]));
    return std::abs(glm::determinant(glm::dmat3(m))) > 1e-9 * largest * largest * largest;
  }

  // M with inverse_bind[j] = bound[j] * M for every joint bound before, or the identity.
  glm::dmat4 FindCommonTransform(const Skin& skin,
                                 const std::vector<glm::mat4>& inverse_bind) const {
    glm::dmat4 common(1.0);
    Largest in_mesh;  // of M: its places are of the mesh, which the others are the inverse of
    bool found = false;
    for (size_t j = 0; j < skin.joints.size(); ++j) {
      if (!Exists(skin.joints[j])) continue;
      const size_t joint = size_t(out_.joint_of_node[size_t(skin.joints[j])]);
      if (!bound_[joint]) continue;
      const glm::dmat4 bound(out_.skeleton.inverse_bind[joint]);
      if (!IsInvertible(bound)) return glm::dmat4(1.0);
      const glm::dmat4 inverse = glm::inverse(bound);
      const glm::dmat4 m = inverse * glm::dmat4(inverse_bind[j]);
      if (!found) {
        common = m;
        in_mesh.Add(glm::mat4(inverse));
        in_mesh.place = std::max(in_mesh.place, in_mesh.turn * largest_.place);
        in_mesh.turn = 0.0f;
        in_mesh.Add(glm::mat4(m));
      }
      if (found && !Near(glm::mat4(common), glm::mat4(m), in_mesh)) return glm::dmat4(1.0);
      found = true;
    }
    const bool usable =
        found && IsInvertible(common) && !Near(glm::mat4(common), glm::mat4(1.0f), in_mesh);
    return usable ? common : glm::dmat4(1.0);
  }

  // The next node of the skeleton, at it or above.
  void FindHolder(MeshUse* use) {
    glm::dmat4 local(1.0);
    int node = use->node;
    for (size_t steps = 0; node >= 0 && out_.joint_of_node[size_t(node)] < 0; ++steps) {
      if (steps == kMostSteps) return;
      local = MatrixOf(RestOf(document_, size_t(node), notes_)) * local;
      node = tree_.parent[size_t(node)];
    }
    if (node < 0) return;
    const int joint = out_.joint_of_node[size_t(node)];
    const glm::dmat4 inverse_bind(out_.skeleton.inverse_bind[size_t(joint)]);
    if (!IsInvertible(inverse_bind)) return;
    use->holder = joint;
    use->to_holder = glm::inverse(inverse_bind) * local;
  }

  const Document& document_;
  std::vector<std::string>* notes_;
  NodeTree tree_;
  std::vector<glm::dmat4> rest_world_;  // of the first joints, made when asked for
  std::vector<uint8_t> bound_;          // joint has its inverse bind matrix
  Largest largest_;                     // of the matrices that skins were bound by so far
  SkeletonImport out_;
};

}  // namespace

SkeletonImport ReadSkeleton(const Document& document, std::vector<std::string>* notes) {
  return SkeletonReader(document, notes).Read();
}

}  // namespace pelt::gltf
