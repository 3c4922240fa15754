// Mesh: all skinned primitives of a document as one triangle list, repaired.
//
// Everything the frame relies on is established here: weights sum to 1 and descend, joints are skeleton nodes, normals
// and tangents are unit, no triangle is degenerate, nothing is NaN. Each repair that changes what the artist wrote is
// stated once, with its count.
// Source: glTF 2.0, 3.7.2 (geometry), 3.7.3 (skins).
#include "core/character/gltf_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>

#include "core/character/mesh_repair.hpp"
#include "core/float_rules.hpp"

namespace pelt::gltf {
namespace {

// What a primitive's vertices have that is kept by corner of its triangles, so that vertices which differ in it alone
// are still one to fur.

// For triangles that have none yet, whose vertices begin at `first`. `size` numbers for each vertex, of which three are
// the colour and a fourth alpha; what is not there, or not finite, is white.
void StoreCornerColours(const std::vector<float>& colours, size_t size, size_t first, Mesh& mesh) {
  const auto colour_of = [&](size_t v) {
    glm::vec4 colour(1.0f);
    for (size_t c = 0; c < size && !colours.empty(); ++c)
      if (const float value = colours[(v - first) * size + c]; std::isfinite(value))
        colour[int(c)] = std::clamp(value, 0.0f, 1.0f);
    return colour;
  };
  for (size_t t = mesh.corner_colour.size(); t < mesh.triangles.size(); ++t) {
    const auto& v = mesh.triangles[t];
    mesh.corner_colour.push_back({colour_of(v[0]), colour_of(v[1]), colour_of(v[2])});
  }
}

constexpr float kLargestCoordinate = 1e15f;  // beyond, a float has no room for the sums of skinning
constexpr Wanted kUvsWanted{2, kSetF32 | kSetI8 | kSetU8 | kSetI16 | kSetU16, Scaling::kAsFlagged,
                            false};
// Of faulty primitives, and of colours and the like that are read again for every primitive that
// shares its vertices: far above any character, and a bound on the time that a file can cost.
constexpr size_t kMostFaults = 4096;
constexpr uint64_t kMostReadAgain = 1u << 27;

// What was repaired, to be said once.
struct RepairCounts {
  size_t no_indices = 0, morphs = 0, no_uv = 0, no_image_uv = 0;
  // Primitives left out; triangles left out; corners.
  size_t points_or_lines = 0, held = 0, nowhere = 0, far_out = 0, left_over = 0;
  size_t no_material = 0;
  // Vertices with something that is no finite number.
  size_t odd_normals = 0, odd_tangents = 0, odd_uvs = 0;
  WeightRepairs weights;
};

class MeshReader {
 public:
  MeshReader(const Document& document, SkeletonImport* skeleton, std::vector<std::string>* notes)
      : document_(document),
        skeleton_(*skeleton),
        notes_(notes),
        same_accessor_(FindSameAccessors(document)) {}

  Mesh Read() {
    for (const MeshUse& use : skeleton_.uses) {
      const MeshDesc& mesh = document_.meshes[size_t(use.mesh)];
      const std::string place = Place("mesh", size_t(use.mesh), mesh.name);
      is_bare_ = IsBareName(mesh.name) || IsBareName(document_.nodes[size_t(use.node)].name);
      for (size_t p = 0; p < mesh.primitives.size(); ++p)
        TryPrimitive(mesh.primitives[p], use, place + " primitive " + std::to_string(p));
    }
    if (out_.triangles.empty() && fault_) throw Error(document_.name + ": " + fault_.text);
    out_.joints = NarrowJoints(document_, out_, joints_, &skeleton_, notes_);
    // As if they were not shared: a groom does not change with how a file says the same.
    const std::vector<uint32_t> was = OrderByUse(primitive_ends_, &out_);
    const std::vector<uint8_t> lost = std::move(no_weights_);
    no_weights_.clear();
    for (const uint32_t v : was) no_weights_.push_back(lost[v]);
    Repair();
    return std::move(out_);
  }

 private:
  static int Find(const Primitive& primitive, const char* attribute) {
    const auto it = primitive.attributes.find(attribute);
    return it == primitive.attributes.end() ? -1 : it->second;
  }

  // One that is faulty does not take the others with it.
  void TryPrimitive(const Primitive& primitive, const MeshUse& use, const std::string& place) {
    const size_t vertices = out_.position.size();
    const RepairCounts before = repairs_;
    Fault fault;
    if (ReadPrimitive(primitive, use, place, fault)) {
      primitive_ends_.push_back(out_.triangles.size());
      return;
    }
    if (!fault_) fault_ = fault;
    NoteFault(fault, "the primitive was left out.");
    repairs_ = before;
    std::erase_if(shared_, [&](const auto& known) { return known.second >= vertices; });
    Cut(vertices);
  }

  void NoteFault(const Fault& fault, const char* what_became) {
    if (++faults_ > kMostFaults) throw Error(document_.name + ": " + fault.text);
    notes_->push_back(fault.text + "; " + what_became);
  }

  void Cut(size_t vertices) {
    out_.position.resize(vertices);
    out_.normal.resize(vertices);
    out_.tangent.resize(vertices);
    out_.uv.resize(vertices);
    out_.weights.resize(vertices);
    joints_.resize(vertices);
    no_weights_.resize(vertices);
    far_out_.resize(vertices);
  }

  // Floats of an attribute that must have `count` elements; empty where the primitive has none.
  std::vector<float> ReadAttribute(const Primitive& primitive, const char* attribute,
                                   const Wanted& wanted, size_t count, const std::string& place,
                                   Fault& fault) const {
    if (!primitive.attributes.count(attribute)) return {};
    const int accessor = Find(primitive, attribute);
    const std::string where = place + " attribute " + attribute;
    const uint64_t has = CountElements(document_, accessor, where, fault);
    if (!fault && has < count)
      fault.Say(where,
                "has " + std::to_string(has) + " elements, POSITION has " + std::to_string(count));
    if (fault) return {};
    return ReadFloats(document_, accessor, wanted, where, fault);
  }

  // The same of one that a primitive can do without.
  std::vector<float> ReadOptional(const Primitive& primitive, const char* attribute,
                                  const Wanted& wanted, size_t count, const std::string& place) {
    Fault fault;
    std::vector<float> values = ReadAttribute(primitive, attribute, wanted, count, place, fault);
    if (fault) NoteFault(fault, "the attribute was left out.");
    return values;
  }

  bool ReadPrimitive(const Primitive& primitive, const MeshUse& use, const std::string& place,
                     Fault& fault) {
    if (primitive.mode >= 0 && primitive.mode < kTriangles) {
      ++repairs_.points_or_lines;
      return true;
    }
    if (primitive.mode < 0 || primitive.mode > kTriangleFan)
      return fault.Say(place, "mode " + std::to_string(primitive.mode) + " is none");
    const bool held = !HasInfluences(primitive);
    if (!primitive.attributes.count("POSITION"))
      return fault.Say(place, "attribute POSITION is missing");
    if (held && use.holder < 0)
      return fault.Say(place,
                       std::string("attribute ") +
                           (primitive.attributes.count("JOINTS_0") ? "WEIGHTS_0" : "JOINTS_0") +
                           " is missing, and its node hangs on no joint");
    const size_t count =
        CountElements(document_, Find(primitive, "POSITION"), place + " attribute POSITION", fault);
    if (fault) return false;
    out_.uv_sets = std::max(out_.uv_sets, CountUvSets(primitive));
    repairs_.morphs += primitive.morphs;
    const MaterialLook look = LookOf(primitive);
    repairs_.no_image_uv += look.image >= 0 && CountUvSets(primitive) > 0 &&
                            UvSetOf(primitive) != "TEXCOORD_" + std::to_string(look.uv_set);
    repairs_.held += held;
    const auto [known, is_new] =
        shared_.try_emplace(KeyOf(primitive, use, held), out_.position.size());
    if (is_new && !ReadVertices(primitive, use, held, count, place, fault)) return false;
    const size_t first = known->second;
    if (!is_new && (read_again_ += count) > kMostReadAgain)
      return fault.Say(place, "names the same vertices again and again");
    const std::vector<float> colours = ReadColours(primitive, count, place);
    if (!StoreTriangles(primitive, first, count, place, fault)) return false;
    StoreColours(colours, first);
    return true;
  }

  // What primitives have in common that share their vertices: what moves them, and all that is kept
  // by vertex.
  using VertexKey =
      std::pair<std::pair<const void*, bool>, std::vector<std::pair<std::string, int>>>;
  VertexKey KeyOf(const Primitive& primitive, const MeshUse& use, bool held) const {
    const void* mover =
        held ? static_cast<const void*>(&use) : &skeleton_.bindings[size_t(use.binding)];
    VertexKey key{{mover, held}, {}};
    const std::string uv_set = UvSetOf(primitive);
    for (const auto& [name, accessor] : primitive.attributes) {
      const bool left_out =
          name.starts_with("COLOR_") || (name.starts_with("TEXCOORD_") && name != uv_set);
      if (left_out) continue;  // kept by corner, or not at all
      const bool exists = accessor >= 0 && size_t(accessor) < same_accessor_.size();
      key.second.emplace_back(name, exists ? same_accessor_[size_t(accessor)] : accessor);
    }
    // The first material that moves its images alike.
    const auto& transforms = document_.transforms;
    const auto alike = std::find(transforms.begin(), transforms.end(), TransformOf(primitive));
    key.second.emplace_back("transform",
                            alike == transforms.end() ? -1 : int(alike - transforms.begin()));
    return key;
  }

  static uint32_t CountUvSets(const Primitive& primitive) {
    return uint32_t(std::ranges::count_if(primitive.attributes, [](const auto& attribute) {
      return attribute.first.starts_with("TEXCOORD_");
    }));
  }

  bool ReadVertices(const Primitive& primitive, const MeshUse& use, bool held, size_t count,
                    const std::string& place, Fault& fault) {
    if (out_.position.size() + count > LimitOf(document_))
      return fault.Say(place + " attribute POSITION",
                       "brings the file above " + std::to_string(LimitOf(document_)) + " vertices");
    const SkinBinding& binding = skeleton_.bindings[size_t(use.binding)];
    const glm::dmat4& to_bind = held ? use.to_holder : binding.to_bind;
    if (!ReadPositions(primitive, to_bind, count, place, fault)) return false;
    ReadFrames(primitive, to_bind, count, place);
    ReadUvs(primitive, count, place);
    if (held) {
      joints_.resize(joints_.size() + count, {uint32_t(use.holder), 0, 0, 0});
      out_.weights.resize(out_.weights.size() + count, glm::vec4(1, 0, 0, 0));
      no_weights_.resize(no_weights_.size() + count, 0);
      return true;
    }
    const Influences influences = ReadInfluences(document_, primitive, binding, count, place,
                                                 &repairs_.weights, notes_, fault);
    joints_.insert(joints_.end(), influences.joints.begin(), influences.joints.end());
    out_.weights.insert(out_.weights.end(), influences.weights.begin(), influences.weights.end());
    no_weights_.insert(no_weights_.end(), influences.lost.begin(), influences.lost.end());
    return !fault;
  }

  bool ReadPositions(const Primitive& primitive, const glm::dmat4& to_bind, size_t count,
                     const std::string& place, Fault& fault) {
    const std::vector<float> p = ReadAttribute(
        primitive, "POSITION", {3, kSetAny, Scaling::kAsFlagged, false}, count, place, fault);
    if (fault) return false;
    const bool moved = to_bind != glm::dmat4(1.0);
    for (size_t v = 0; v < count; ++v) {
      glm::vec3 at(p[3 * v], p[3 * v + 1], p[3 * v + 2]);
      if (moved) at = glm::vec3(glm::dvec3(to_bind * glm::dvec4(glm::dvec3(at), 1.0)));
      bool far_out = false;
      for (int c = 0; c < 3; ++c) far_out |= !(std::abs(at[c]) < kLargestCoordinate);
      far_out_.push_back(far_out);
      out_.position.push_back(far_out ? glm::vec3(0.0f) : at);
    }
    return true;
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
  void ReadFrames(const Primitive& primitive, const glm::dmat4& to_bind, size_t count,
                  const std::string& place) {
    const std::vector<float> n =
        ReadOptional(primitive, "NORMAL", {3, kSetAny, Scaling::kNormalised, false}, count, place);
    const std::vector<float> t =
        ReadOptional(primitive, "TANGENT", {4, kSetAny, Scaling::kNormalised, false}, count, place);
    const glm::dmat3 linear(to_bind);
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
  MaterialLook LookOf(const Primitive& primitive) const {
    return HasMaterial(primitive) ? document_.looks[size_t(primitive.material)] : MaterialLook{};
  }
  TextureTransform TransformOf(const Primitive& primitive) const {
    return HasMaterial(primitive) ? document_.transforms[size_t(primitive.material)]
                                  : TextureTransform{};
  }

  // The set that the material's images are laid by, or the first that there is.
  std::string UvSetOf(const Primitive& primitive) const {
    const std::string wanted = "TEXCOORD_" + std::to_string(LookOf(primitive).uv_set);
    if (primitive.attributes.count(wanted)) return wanted;
    const auto first = primitive.attributes.lower_bound("TEXCOORD_");
    const bool any = first != primitive.attributes.end() && first->first.starts_with("TEXCOORD_");
    return any ? first->first : wanted;
  }

  // As the material's images move it.
  void ReadUvs(const Primitive& primitive, size_t count, const std::string& place) {
    const TextureTransform transform = TransformOf(primitive);
    const std::vector<float> uv =
        ReadOptional(primitive, UvSetOf(primitive).c_str(), kUvsWanted, count, place);
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

  bool StoreTriangles(const Primitive& primitive, size_t first, size_t count,
                      const std::string& place, Fault& fault) {
    repairs_.no_indices += primitive.indices == -1;
    const Triangles triangles =
        ReadTriangles(document_, primitive, std::span(far_out_).subspan(first, count),
                      LimitOf(document_) - out_.triangles.size(), place, fault);
    if (fault) return false;
    if ((corners_ += triangles.corners) > kMostReadAgain)
      return fault.Say(place, "names the same indices again and again");
    repairs_.nowhere += triangles.nowhere;
    repairs_.far_out += triangles.unusable;
    repairs_.left_over += triangles.left_over;
    const uint16_t material = MaterialOf(primitive, place);
    for (const auto& [a, b, c] : triangles.of) {
      out_.triangles.push_back({uint32_t(first + a), uint32_t(first + b), uint32_t(first + c)});
      out_.triangle_material.push_back(material);
    }
    return true;
  }

  uint16_t MaterialOf(const Primitive& primitive, const std::string& place) {
    const bool none = !HasMaterial(primitive);
    repairs_.no_material += none && primitive.material != -1;
    const size_t next = out_.materials.size();
    const auto [known, is_new] =
        material_of_.try_emplace({none ? -1 : primitive.material, is_bare_}, next);
    if (!is_new) return uint16_t(known->second);
    if (next >= 65535) Fail(document_, place, "more than 65535 materials");
    std::string name = none ? "default" : document_.materials[size_t(primitive.material)];
    if (name.empty()) name = "material " + std::to_string(primitive.material);
    out_.materials.push_back(name);
    out_.looks.push_back(none ? MaterialLook{} : document_.looks[size_t(primitive.material)]);
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
    Note(repairs_.no_material, "primitives name a material that is not there; they have none.");
    if (!has_colour_) out_.corner_colour.clear();
    Note(repairs_.no_image_uv,
         "primitives lack the UVs that their image is laid by; the first ones were taken.");
    const size_t lost = size_t(std::count(no_weights_.begin(), no_weights_.end(), 1));
    NoteWeights(repairs_.weights, lost, BorrowWeights(&out_, no_weights_), notes_);
    Note(repairs_.points_or_lines, "primitives of points or lines were left out.");
    Note(repairs_.held, "primitives have no joints; each hangs on its node.");
    Note(repairs_.nowhere, "triangles had vertices that do not exist; they were left out.");
    Note(repairs_.far_out,
         "triangles had vertices that are no finite numbers or beyond 1e15; they were left out.");
    Note(repairs_.left_over, "corners were left over that make no whole triangle.");
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
  SkeletonImport& skeleton_;
  std::vector<std::string>* notes_;
  const std::vector<int> same_accessor_;
  bool is_bare_ = false;                                // the mesh that is read
  std::map<std::pair<int, bool>, size_t> material_of_;  // by the file's, of bare meshes or not
  bool has_uv_ = false, has_colour_ = false;
  int colour_size_ = 4;  // numbers a vertex
  RepairCounts repairs_;
  std::map<VertexKey, size_t> shared_;  // the first of vertices that primitives share
  std::vector<size_t> primitive_ends_;  // in the triangles
  uint64_t read_again_ = 0, corners_ = 0;
  size_t faults_ = 0;
  Fault fault_;  // the first, of a primitive that was left out
  // Of each vertex: its joints, in the whole skeleton; its weights are of no use; it lies nowhere.
  std::vector<std::array<uint32_t, 4>> joints_;
  std::vector<uint8_t> no_weights_, far_out_;
  Mesh out_;
};

}  // namespace

Mesh ReadMesh(const Document& document, SkeletonImport* skeleton, std::vector<std::string>* notes) {
  return MeshReader(document, skeleton, notes).Read();
}

}  // namespace pelt::gltf
