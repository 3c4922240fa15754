// What moves a primitive's vertices.
#include <algorithm>
#include <cmath>

#include "core/character/gltf_mesh.hpp"
#include "core/float_rules.hpp"
#include "core/format.hpp"

namespace pelt::gltf {
namespace {

constexpr int kMostSets = 64;

struct Influence {
  uint32_t joint = 0;
  double weight = 0.0;
};

// Four numbers a vertex each.
struct Set {
  std::vector<uint32_t> joints;
  std::vector<float> weights;
};

class InfluenceReader {
 public:
  InfluenceReader(const Document& document, const Primitive& primitive, const SkinBinding& binding,
                  size_t count, const std::string& place, WeightRepairs* repairs,
                  std::vector<std::string>* notes, Fault& fault)
      : document_(document),
        primitive_(primitive),
        binding_(binding),
        count_(count),
        place_(place),
        repairs_(repairs),
        notes_(notes),
        fault_(fault) {}

  Influences Read() {
    for (const int joint : binding_.joint)
      if (joint >= 0) {
        first_joint_ = uint32_t(joint);
        break;
      }
    ReadSets();
    if (fault_) return {};
    for (size_t v = 0; v < count_; ++v) ReadVertex(v);
    return std::move(out_);
  }

 private:
  // Every JOINTS_n, WEIGHTS_n pair of a primitive, one after the other.
  void ReadSets() {
    for (int n = 0; n < kMostSets; ++n) {
      const std::string suffix = std::to_string(n);
      const auto joints = primitive_.attributes.find("JOINTS_" + suffix);
      const auto weights = primitive_.attributes.find("WEIGHTS_" + suffix);
      const auto end = primitive_.attributes.end();
      if (joints == end && weights == end) return;
      if (joints == end || weights == end)
        notes_->push_back(Format("{}: attribute {}_{} has no {}_{}; it was left out.", place_,
                                 joints == end ? "WEIGHTS" : "JOINTS", n,
                                 joints == end ? "JOINTS" : "WEIGHTS", n));
      else
        sets_.push_back({ReadJoints(joints->second, joints->first),
                         ReadWeights(weights->second, weights->first)});
    }
  }

  bool CheckCount(int accessor, const std::string& where) const {
    const uint64_t has = CountElements(document_, accessor, where, fault_);
    if (!fault_ && has < count_)
      fault_.Say(where, Format("has {} elements, POSITION has {}", has, count_));
    return !fault_;
  }

  // Integers by the specification; some write them as floats.
  std::vector<uint32_t> ReadJoints(int accessor, const std::string& attribute) const {
    const std::string where = place_ + " attribute " + attribute;
    if (!CheckCount(accessor, where)) return {};
    if (document_.accessors[size_t(accessor)].component != int(Component::kF32))
      return ReadIntegers(document_, accessor,
                          {4, kSetAny & ~uint32_t(kSetF32), Scaling::kAsFlagged}, where, fault_);
    std::vector<uint32_t> joints;
    for (const float joint :
         ReadFloats(document_, accessor, {4, kSetF32, Scaling::kAsFlagged, false}, where, fault_))
      joints.push_back(joint >= 0.0f && joint < 1e9f ? uint32_t(joint + 0.5f) : ~0u);
    return joints;
  }

  std::vector<float> ReadWeights(int accessor, const std::string& attribute) const {
    const std::string where = place_ + " attribute " + attribute;
    if (!CheckCount(accessor, where)) return {};
    return ReadFloats(document_, accessor, {4, kSetAny, Scaling::kNormalised, false}, where,
                      fault_);
  }

  bool IsFinite(size_t v) const {
    return std::all_of(sets_.begin(), sets_.end(), [&](const Set& set) {
      const auto first = set.weights.begin() + std::ptrdiff_t(4 * v);
      return std::all_of(first, first + 4, [](float weight) { return std::isfinite(weight); });
    });
  }

  void ReadVertex(size_t v) {
    influences_.clear();
    const bool finite = IsFinite(v);
    repairs_->odd += !finite;
    size_t astray = 0;
    // Its other weights were meant to go with those that are lost.
    for (const Set& set : sets_)
      for (size_t i = 4 * v; finite && i < 4 * v + 4; ++i) {
        const float weight = set.weights[i];
        repairs_->negative += weight < 0.0f;
        const uint32_t joint = set.joints[i];
        const bool known = joint < binding_.joint.size() && binding_.joint[joint] >= 0;
        repairs_->bad_unused_joint += !known && !(weight > 0.0f);
        if (!(weight > 0.0f)) continue;
        astray += !known;
        if (known) Add(uint32_t(binding_.joint[joint]), double(weight));
      }
    repairs_->bad_joint += astray;
    const bool lost = !finite || (astray > 0 && influences_.empty());
    out_.lost.push_back(lost);
    if (lost) influences_.assign(1, {first_joint_, 1.0});
    Store(astray > 0);
  }

  void Add(uint32_t joint, double weight) {
    for (Influence& known : influences_) {
      if (known.joint != joint) continue;
      known.weight += weight;
      return;
    }
    influences_.push_back({joint, weight});
  }

  double Sum() const {
    double sum = 0.0;
    for (const Influence& i : influences_) sum += i.weight;
    return sum;
  }

  void Store(bool scaled) {
    const double sum = Sum();
    if (!(sum > 1e-9)) {
      ++repairs_->unweighted;
      influences_.assign(1, {first_joint_, 1.0});
    } else if (!scaled && std::abs(sum - 1.0) > 0.01) {  // four bytes of weight can be 0.008 off
      ++repairs_->not_one;
    }
    std::stable_sort(influences_.begin(), influences_.end(),
                     [](const Influence& a, const Influence& b) { return a.weight > b.weight; });
    if (influences_.size() > 4) {
      ++repairs_->extra;
      influences_.resize(4);
    }
    const double kept = Sum();
    std::array<uint32_t, 4> joints{};
    glm::vec4 weights(0.0f);
    for (size_t i = 0; i < influences_.size(); ++i) {
      joints[i] = influences_[i].joint;
      weights[int(i)] = float(influences_[i].weight / kept);
    }
    out_.joints.push_back(joints);
    out_.weights.push_back(weights);
  }

  const Document& document_;
  const Primitive& primitive_;
  const SkinBinding& binding_;
  const size_t count_;
  const std::string& place_;
  WeightRepairs* repairs_;
  std::vector<std::string>* notes_;
  Fault& fault_;
  uint32_t first_joint_ = 0;
  std::vector<Set> sets_;
  std::vector<Influence> influences_;  // of one vertex
  Influences out_;
};

}  // namespace

bool HasInfluences(const Primitive& primitive) {
  for (int n = 0; n < kMostSets; ++n)
    if (primitive.attributes.count("JOINTS_" + std::to_string(n)) &&
        primitive.attributes.count("WEIGHTS_" + std::to_string(n)))
      return true;
  return false;
}

Influences ReadInfluences(const Document& document, const Primitive& primitive,
                          const SkinBinding& binding, size_t count, const std::string& place,
                          WeightRepairs* repairs, std::vector<std::string>* notes, Fault& fault) {
  return InfluenceReader(document, primitive, binding, count, place, repairs, notes, fault).Read();
}

std::vector<std::array<uint8_t, 4>> NarrowJoints(const Document& document, const Mesh& mesh,
                                                 const std::vector<std::array<uint32_t, 4>>& joints,
                                                 SkeletonImport* skeleton,
                                                 std::vector<std::string>* notes) {
  std::vector<uint8_t> used(skeleton->skeleton.name.size(), 0);
  for (const auto& triangle : mesh.triangles)
    for (const uint32_t v : triangle)
      for (int i = 0; i < 4; ++i)
        if (mesh.weights[v][i] > 0.0f) used[joints[v][size_t(i)]] = 1;
  const std::vector<int> now = FinishSkeleton(document, used, skeleton, notes);
  std::vector<std::array<uint8_t, 4>> narrow(joints.size());
  for (size_t v = 0; v < joints.size(); ++v)
    for (size_t i = 0; i < 4; ++i)
      if (mesh.weights[v][int(i)] > 0.0f) narrow[v][i] = uint8_t(std::max(now[joints[v][i]], 0));
  return narrow;
}

void NoteWeights(const WeightRepairs& repairs, size_t lost, size_t borrowed,
                 std::vector<std::string>* notes) {
  const auto note = [notes](size_t count, const char* what) {
    if (count) notes->push_back(Format("{} {}", count, what));
  };
  note(borrowed, repairs.bad_joint ? "vertices had skin weights that are no finite numbers or on "
                                     "joints that do not exist; a neighbour's were taken."
                                   : "vertices had skin weights that are no finite numbers; a "
                                     "neighbour's were taken.");
  note(lost - borrowed,
       "vertices had skin weights that are of no use, and no neighbour with others; bound to the "
       "first joint.");
  note(repairs.bad_joint, "skin weights are on joints that do not exist; taken as 0.");
  note(repairs.negative, "skin weights were negative; taken as 0.");
  note(repairs.bad_unused_joint, "joint indices of weight 0 were out of range; ignored.");
  note(repairs.unweighted, "vertices had no skin weight at all; bound to the first joint.");
  note(repairs.not_one, "vertices had skin weights that did not sum to 1; scaled.");
  note(repairs.extra, "vertices had more than 4 influences; the 4 largest stay, scaled.");
}

}  // namespace pelt::gltf
