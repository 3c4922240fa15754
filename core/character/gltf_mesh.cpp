// Mesh: all skinned primitives of a document as one triangle list, repaired.
//
// Everything the frame relies on is established here: weights sum to 1 and descend, joints are skeleton nodes, normals
// and tangents are unit, no triangle is degenerate, nothing is NaN. Each repair that changes what the artist wrote is
// stated once, with its count.
// Source: glTF 2.0, 3.7.2 (geometry), 3.7.3 (skins).
#include <algorithm>
#include <cmath>
#include <map>

#include "core/character/gltf_accessor.hpp"
#include "core/character/gltf_bare.hpp"
#include "core/character/gltf_corners.hpp"
#include "core/character/gltf_read.hpp"
#include "core/character/mesh_repair.hpp"
#include "core/error.hpp"
#include "core/float_rules.hpp"

namespace pelt::gltf {
namespace {

constexpr float kLargestCoordinate = 1e15f;  // beyond, a float has no room for the sums of skinning
constexpr uint32_t kSetQuantised = kSetF32 | kSetI8 | kSetU8 | kSetI16 | kSetU16;
constexpr Wanted kUvsWanted{2, kSetQuantised, Scaling::kAsFlagged, false};

struct Influence {
  uint8_t joint = 0;
  double weight = 0.0;
};

// What was repaired, to be said once.
struct RepairCounts {
  size_t no_indices = 0, morphs = 0, negative = 0, extra = 0, not_one = 0, unweighted = 0;
  size_t bad_unused_joint = 0, no_uv = 0, no_image_uv = 0, no_material = 0;
  size_t unreadable = 0;         // attributes that a primitive can do without
  std::string first_unreadable;  // why
  // Vertices with something that is no finite number.
  size_t odd_weights = 0, odd_normals = 0, odd_tangents = 0, odd_uvs = 0;
};

class MeshReader {
 public:
  MeshReader(const Document& document, const SkeletonImport& skeleton,
             std::vector<std::string>* notes)
      : document_(document), skeleton_(skeleton), notes_(notes) {}

  Mesh Read() {
    for (const MeshUse& use : skeleton_.uses) {
      const MeshDesc& mesh = document_.meshes[size_t(use.mesh)];
      const std::string place = Place("mesh", size_t(use.mesh), mesh.name);
      if (mesh.primitives.empty()) Fail(document_, place, "has no primitives");
      is_bare_ = IsBareName(mesh.name) || IsBareName(document_.nodes[size_t(use.node)].name);
      for (size_t p = 0; p < mesh.primitives.size(); ++p)
        ReadPrimitive(mesh.primitives[p], skeleton_.bindings[size_t(use.binding)],
                      place + " primitive " + std::to_string(p));
    }
    Repair();
    return std::move(out_);
  }

 private:
  int Find(const Primitive& primitive, const char* attribute) const {
    const auto it = primitive.attributes.find(attribute);
    return it == primitive.attributes.end() ? -1 : it->second;
  }

  // Floats of an attribute that must have `count` elements; empty where the primitive has none.
  std::vector<float> ReadAttribute(const Primitive& primitive, const char* attribute,
                                   const Wanted& wanted, size_t count, const std::string& place) {
    const int accessor = Find(primitive, attribute);
    if (!primitive.attributes.count(attribute)) return {};
    const std::string where = place + " attribute " + attribute;
    CheckCount(accessor, count, where);
    return ReadFloats(document_, accessor, wanted, where);
  }

  // The same of one that the primitive can do without.
  std::vector<float> ReadOptional(const Primitive& primitive, const char* attribute,
                                  const Wanted& wanted, size_t count, const std::string& place) {
    try {
      return ReadAttribute(primitive, attribute, wanted, count, place);
    } catch (const Error& error) {
      const std::string_view reason = error.what();
      if (!repairs_.unreadable++)
        repairs_.first_unreadable = reason.substr(document_.name.size() + 2);
      return {};
    }
  }

  void CheckCount(int accessor, size_t count, const std::string& where) const {
    const uint64_t has = CountElements(document_, accessor, where);
    if (has != count)
      Fail(document_, where,
           "has " + std::to_string(has) + " elements, POSITION has " + std::to_string(count));
  }

  void ReadPrimitive(const Primitive& primitive, const SkinBinding& binding,
                     const std::string& place) {
    if (primitive.mode != kTriangles)
      Fail(document_, place, "mode " + std::to_string(primitive.mode) + " is not triangles (4)");
    for (const char* attribute : {"POSITION", "JOINTS_0", "WEIGHTS_0"})
      if (!primitive.attributes.count(attribute))
        Fail(document_, place, std::string("attribute ") + attribute + " is missing");
    const std::string where = place + " attribute POSITION";
    const int position = Find(primitive, "POSITION");
    const size_t count = CountElements(document_, position, where);
    if (out_.position.size() + count > kMaxVertices)
      Fail(document_, where, "brings the file above " + std::to_string(kMaxVertices) + " vertices");
    repairs_.morphs += primitive.morphs;
    const size_t first = out_.position.size();
    ReadPositions(primitive, binding, count, place);
    ReadFrames(primitive, binding, count, place);
    ReadUvs(primitive, count, place);
    const std::vector<float> colours = ReadColours(primitive, count, place);
    ReadInfluences(primitive, binding, count, place);
    ReadTriangles(primitive, first, count, place);
    StoreColours(colours, first);
  }

  void ReadPositions(const Primitive& primitive, const SkinBinding& binding, size_t count,
                     const std::string& place) {
    const std::vector<float> p =
        ReadAttribute(primitive, "POSITION", {3, kSetQuantised, Scaling::kAsFlagged}, count, place);
    const bool moved = binding.to_bind != glm::dmat4(1.0);
    for (size_t v = 0; v < count; ++v) {
      glm::vec3 at(p[3 * v], p[3 * v + 1], p[3 * v + 2]);
      if (moved) at = glm::vec3(glm::dvec3(binding.to_bind * glm::dvec4(glm::dvec3(at), 1.0)));
      for (int c = 0; c < 3; ++c)
        if (!(std::abs(at[c]) < kLargestCoordinate))
          Fail(document_, place + " attribute POSITION",
               "vertex " + std::to_string(v) + " lies beyond 1e15");
      out_.position.push_back(at);
    }
  }

  static glm::vec3 Unit(const glm::dvec3& v) {
    const double length = std::sqrt(glm::dot(v, v));
    return length > 1e-12 ? glm::vec3(v / length) : glm::vec3(0.0f);
  }

  // Whether the attribute is there and finite for vertex v; counts those that are not finite.
  static bool IsFinite(const std::vector<float>& values, size_t v, size_t components, size_t& odd) {
    if (values.empty()) return false;
    const auto first = values.begin() + std::ptrdiff_t(v * components);
    const bool finite = std::all_of(first, first + std::ptrdiff_t(components),
                                    [](float value) { return std::isfinite(value); });
    odd += !finite;
    return finite;
  }

  // Normals and tangents; zero where the file has none or has zeros.
  void ReadFrames(const Primitive& primitive, const SkinBinding& binding, size_t count,
                  const std::string& place) {
    const std::vector<float> n =
        ReadOptional(primitive, "NORMAL",
                     {3, kSetF32 | kSetI8 | kSetI16, Scaling::kNormalised, false}, count, place);
    const std::vector<float> t =
        ReadOptional(primitive, "TANGENT",
                     {4, kSetF32 | kSetI8 | kSetI16, Scaling::kNormalised, false}, count, place);
    const glm::dmat3 linear(binding.to_bind);
    const glm::dmat3 for_normals = glm::transpose(glm::inverse(linear));
    for (size_t v = 0; v < count; ++v) {
      glm::dvec3 normal(0.0);
      glm::dvec4 tangent(0.0);
      if (IsFinite(n, v, 3, repairs_.odd_normals)) normal = {n[3 * v], n[3 * v + 1], n[3 * v + 2]};
      if (IsFinite(t, v, 4, repairs_.odd_tangents))
        tangent = {t[4 * v], t[4 * v + 1], t[4 * v + 2], t[4 * v + 3]};
      out_.normal.push_back(Unit(for_normals * normal));
      out_.tangent.push_back(
          glm::vec4(Unit(linear * glm::dvec3(tangent)), tangent.w < 0.0 ? -1.0f : 1.0f));
    }
  }

  bool HasMaterial(const Primitive& primitive) const {
    return primitive.material >= 0 && size_t(primitive.material) < document_.materials.size();
  }

  // Of the set that the material's images are laid by, or of the first that there is; as they move it.
  void ReadUvs(const Primitive& primitive, size_t count, const std::string& place) {
    MaterialLook look;
    TextureTransform transform;
    if (HasMaterial(primitive)) {
      look = document_.looks[size_t(primitive.material)];
      transform = document_.transforms[size_t(primitive.material)];
    }
    size_t sets = 0;
    std::string attribute = "TEXCOORD_" + std::to_string(look.uv_set), first;
    for (const auto& [name, accessor] : primitive.attributes)
      if (name.starts_with("TEXCOORD_") && !sets++) first = name;
    out_.uv_sets = std::max(out_.uv_sets, uint32_t(sets));
    if (sets && !primitive.attributes.count(attribute)) {
      repairs_.no_image_uv += look.image >= 0;
      attribute = first;
    }
    const std::vector<float> uv =
        ReadOptional(primitive, attribute.c_str(), kUvsWanted, count, place);
    has_uv_ |= !uv.empty();
    if (uv.empty()) repairs_.no_uv += count;
    const bool moved = transform != TextureTransform{};
    for (size_t v = 0; v < count; ++v) {
      glm::vec2 at(0.0f);
      if (!uv.empty()) at = {uv[2 * v], uv[2 * v + 1]};
      if (moved)
        at = {glm::dot(transform.u, glm::vec3(at, 1.0f)),
              glm::dot(transform.v, glm::vec3(at, 1.0f))};
      const bool finite = std::isfinite(at.x) && std::isfinite(at.y);
      repairs_.odd_uvs += !finite;
      out_.uv.push_back(finite && !uv.empty() ? at : glm::vec2(0.0f));
    }
  }

  // Four, or three, numbers a vertex; empty where the primitive has none.
  std::vector<float> ReadColours(const Primitive& primitive, size_t count,
                                 const std::string& place) {
    const int accessor = Find(primitive, "COLOR_0");
    const bool known = accessor >= 0 && size_t(accessor) < document_.accessors.size();
    colour_size_ = known && document_.accessors[size_t(accessor)].components == 3 ? 3 : 4;
    return ReadOptional(primitive, "COLOR_0",
                        {colour_size_, kSetF32 | kSetU8 | kSetU16, Scaling::kNormalised, false},
                        count, place);
  }

  void StoreColours(const std::vector<float>& colours, size_t first) {
    has_colour_ |= !colours.empty();
    StoreCornerColours(colours, size_t(colour_size_), first, out_);
  }

  // Every JOINTS_n, WEIGHTS_n pair of a primitive, one after the other.
  void ReadInfluences(const Primitive& primitive, const SkinBinding& binding, size_t count,
                      const std::string& place) {
    std::vector<std::vector<uint32_t>> joints;
    std::vector<std::vector<float>> weights;
    for (int set = 0; set < 64; ++set) {
      const std::string suffix = std::to_string(set);
      const std::string joints_name = "JOINTS_" + suffix, weights_name = "WEIGHTS_" + suffix;
      const bool has_joints = primitive.attributes.count(joints_name) > 0;
      if (has_joints != (primitive.attributes.count(weights_name) > 0))
        Fail(document_, place,
             "attribute " + (has_joints ? weights_name : joints_name) + " is missing");
      if (!has_joints) break;
      const std::string where = place + " attribute " + joints_name;
      const int accessor = Find(primitive, joints_name.c_str());
      CheckCount(accessor, count, where);
      joints.push_back(
          ReadIntegers(document_, accessor, {4, kSetU8 | kSetU16, Scaling::kAsFlagged}, where));
      weights.push_back(ReadAttribute(primitive, weights_name.c_str(),
                                      {4, kSetF32 | kSetU8 | kSetU16, Scaling::kNormalised, false},
                                      count, place));
    }
    std::vector<Influence> influences;
    for (size_t v = 0; v < count; ++v) {
      influences.clear();
      bool finite = true;
      for (size_t set = 0; set < joints.size() && finite; ++set)
        finite = IsFinite(weights[set], v, 4, repairs_.odd_weights);
      no_weights_.push_back(!finite);
      // Its other weights were meant to go with those that are lost.
      for (size_t set = 0; set < joints.size() && finite; ++set) {
        for (size_t i = 4 * v; i < 4 * v + 4; ++i) {
          const float weight = weights[set][i];
          repairs_.negative += weight < 0.0f;
          const bool known = joints[set][i] < binding.joint.size();
          repairs_.bad_unused_joint += !known && !(weight > 0.0f);
          if (!(weight > 0.0f)) continue;
          if (!known)
            Fail(document_, place + " attribute JOINTS_" + std::to_string(set),
                 "vertex " + std::to_string(v) + ": joint " + std::to_string(joints[set][i]) +
                     " is out of range (the skin has " + std::to_string(binding.joint.size()) +
                     ")");
          AddInfluence(&influences, binding.joint[joints[set][i]], double(weight));
        }
      }
      if (!finite) influences.assign(1, {binding.joint[0], 1.0});
      StoreInfluences(&influences, binding.joint[0]);
    }
  }

  static void AddInfluence(std::vector<Influence>* influences, uint8_t joint, double weight) {
    for (Influence& known : *influences) {
      if (known.joint != joint) continue;
      known.weight += weight;
      return;
    }
    influences->push_back({joint, weight});
  }

  void StoreInfluences(std::vector<Influence>* influences, uint8_t first_joint) {
    double sum = 0.0;
    for (const Influence& i : *influences) sum += i.weight;
    if (!(sum > 1e-9)) {
      ++repairs_.unweighted;
      influences->assign(1, {first_joint, 1.0});
    } else if (std::abs(sum - 1.0) > 0.01) {  // four bytes of weight can be 0.008 off
      ++repairs_.not_one;
    }
    std::stable_sort(influences->begin(), influences->end(),
                     [](const Influence& a, const Influence& b) { return a.weight > b.weight; });
    if (influences->size() > 4) {
      ++repairs_.extra;
      influences->resize(4);
    }
    sum = 0.0;
    for (const Influence& i : *influences) sum += i.weight;
    std::array<uint8_t, 4> joints{};
    glm::vec4 weights(0.0f);
    for (size_t i = 0; i < influences->size(); ++i) {
      joints[i] = (*influences)[i].joint;
      weights[int(i)] = float((*influences)[i].weight / sum);
    }
    out_.joints.push_back(joints);
    out_.weights.push_back(weights);
  }

  void ReadTriangles(const Primitive& primitive, size_t first, size_t count,
                     const std::string& place) {
    const std::string where = place + " indices";
    const uint16_t material = MaterialOf(primitive, place);
    std::vector<uint32_t> indices;
    size_t corners = count;
    if (primitive.indices >= 0) {
      corners = CountElements(document_, primitive.indices, where);
      indices = ReadIntegers(document_, primitive.indices,
                             {1, kSetU8 | kSetU16 | kSetU32, Scaling::kAsFlagged}, where);
    } else {
      ++repairs_.no_indices;
    }
    if (corners % 3 != 0)
      Fail(document_, where, std::to_string(corners) + " corners are not whole triangles");
    if (out_.triangles.size() + corners / 3 > kMaxTriangles)
      Fail(document_, where,
           "brings the file above " + std::to_string(kMaxTriangles) + " triangles");
    for (size_t i = 0; i < corners; i += 3) {
      std::array<uint32_t, 3> triangle;
      for (size_t c = 0; c < 3; ++c) {
        const size_t index = indices.empty() ? i + c : indices[i + c];
        if (index >= count)
          Fail(document_, where,
               "index " + std::to_string(index) + " is out of range (" + std::to_string(count) +
                   " vertices)");
        triangle[c] = uint32_t(first + index);
      }
      out_.triangles.push_back(triangle);
      out_.triangle_material.push_back(material);
    }
  }

  uint16_t MaterialOf(const Primitive& primitive, const std::string& place) {
    const bool none = !HasMaterial(primitive);
    repairs_.no_material += none && primitive.material >= 0;
    const int number = none ? -1 : primitive.material;
    const size_t next = out_.materials.size();
    const auto [known, is_new] = material_of_.try_emplace({number, is_bare_}, next);
    if (!is_new) return uint16_t(known->second);
    if (next >= 65535) Fail(document_, place, "more than 65535 materials");
    std::string name = none ? "default" : document_.materials[size_t(number)];
    if (name.empty()) name = "material " + std::to_string(number);
    out_.materials.push_back(name);
    out_.looks.push_back(none ? MaterialLook{} : document_.looks[size_t(number)]);
    out_.looks.back().bare = is_bare_ || IsBareName(name);
    return uint16_t(next);
  }

  void Note(size_t count, const std::string& what) {
    if (count) notes_->push_back(std::to_string(count) + " " + what);
  }

  void Repair() {
    if (!has_uv_) {
      out_.uv.clear();
    } else {
      Note(repairs_.no_uv, "vertices have no UVs although others do; theirs are (0, 0).");
    }
    Note(repairs_.morphs, "primitives have morph targets; they were left out.");
    Note(repairs_.odd_uvs, "vertices had UVs that are no finite numbers; theirs are (0, 0).");
    Note(repairs_.odd_normals, "vertices had a normal that is no finite number; made anew.");
    Note(repairs_.odd_tangents, "vertices had a tangent that is no finite number; made anew.");
    if (!has_colour_) out_.corner_colour.clear();
    Note(repairs_.no_material, "primitives name a material that is not there; they have none.");
    Note(repairs_.unreadable, "attributes could not be read and were left out; the first: " +
                                  repairs_.first_unreadable + ".");
    Note(repairs_.no_image_uv,
         "primitives lack the UVs that their image is laid by; the first ones were taken.");
    const size_t borrowed = BorrowWeights(&out_, no_weights_);
    Note(borrowed,
         "vertices had skin weights that are no finite numbers; a neighbour's were taken.");
    Note(repairs_.odd_weights - borrowed,
         "vertices had skin weights that are no finite numbers, and no neighbour with others; "
         "bound to the first joint.");
    Note(repairs_.negative, "skin weights were negative; taken as 0.");
    Note(repairs_.bad_unused_joint, "joint indices of weight 0 were out of range; ignored.");
    Note(repairs_.unweighted, "vertices had no skin weight at all; bound to the first joint.");
    Note(repairs_.not_one, "vertices had skin weights that did not sum to 1; scaled.");
    Note(repairs_.extra, "vertices had more than 4 influences; the 4 largest stay, scaled.");
    Note(DropDegenerateTriangles(&out_), "triangles without area were dropped.");
    if (out_.triangles.empty()) Fail(document_, "meshes", "no triangle with area is left");
    const size_t before = out_.position.size();
    const size_t welded = WeldVertices(&out_);
    if (repairs_.no_indices)
      notes_->push_back("no indices in " + std::to_string(repairs_.no_indices) + " primitives; " +
                        std::to_string(before) + " vertices welded to " +
                        std::to_string(before - welded) + ".");
    Note(GenerateNormals(&out_), "vertices had no normal; made from the triangles around them.");
    Note(GenerateTangents(&out_), out_.uv.empty()
                                      ? "vertices have no tangent and no UVs; a fixed direction "
                                        "across the normal was taken."
                                      : "vertices had no tangent; made from the UVs.");
    // With normals and tangents in place more vertices can be equal.
    WeldVertices(&out_);
    SettleBare(&out_);
    SettleHoles();
  }

  void SettleHoles() {
    constexpr size_t kNamesShown = 4;
    std::string names;
    size_t count = 0;
    for (size_t m = 0; m < out_.looks.size(); ++m) {
      MaterialLook& look = out_.looks[m];
      const bool varies = look.alpha_image >= 0 || has_colour_;
      if (!look.IsTransparent() && !varies) look.alpha_cutoff = 0.0f;
      if (!look.IsCut() || look.IsTransparent() || count++ >= kNamesShown) continue;
      names += (names.empty() ? "'" : ", '") + out_.materials[m] + "'";
    }
    if (count > kNamesShown) names += " and " + std::to_string(count - kNamesShown) + " more";
    if (count) notes_->push_back("No fur grows where alpha leaves holes in " + names + ".");
  }

  const Document& document_;
  const SkeletonImport& skeleton_;
  std::vector<std::string>* notes_;
  bool is_bare_ = false;                                // the mesh that is read
  std::map<std::pair<int, bool>, size_t> material_of_;  // by the file's, of bare meshes or not
  bool has_uv_ = false, has_colour_ = false;
  int colour_size_ = 4;  // numbers a vertex
  RepairCounts repairs_;
  std::vector<uint8_t> no_weights_;  // of each vertex: its weights were not finite
  Mesh out_;
};

}  // namespace

Mesh ReadMesh(const Document& document, const SkeletonImport& skeleton,
              std::vector<std::string>* notes) {
  return MeshReader(document, skeleton, notes).Read();
}

}  // namespace pelt::gltf
