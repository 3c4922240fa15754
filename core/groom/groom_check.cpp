// What the frame assumes of a groom and its types do not say: every index in range, every number
// finite, every part consistent with the others.
//
// Kernels have no checks of their own: they address the chunk's tables with the strand's bytes,
// walk the skeleton parents first, divide by segment lengths. A groom that passes here cannot make
// them read outside their blocks or produce a value that is not finite. Lanes that kernels read,
// padding up to the lane group included, are held to the rules of live ones.
//
// Indices are held to their range in every entry of their array, behind the live ones too: no count
// that comes from elsewhere (a pose's joints, a level of detail) can then make a kernel follow one
// out of its table. What breaks if only live entries are checked: a recorded pose of more joints
// than its groom walks parents that no check looked at.
//
// Every check returns whether all is well, and stops at the first fault: later ones trust what
// earlier ones found.

#include <algorithm>
#include <cmath>

#include "core/float_rules.hpp"
#include "core/format.hpp"
#include "core/groom/groom_fields.hpp"
#include "core/groom/groom_file.hpp"
#include "core/groom/patch_index.hpp"

namespace pelt {
namespace {

using namespace groom_file;

constexpr float kUnitTolerance = 0.05f;
constexpr float kSumTolerance = 1.0e-3f;
constexpr uint32_t kStrandsPerLayer = 1u << 24;

using Has = bool (*)(const LayerParams&);
using LayerCount = uint32_t GroomLayer::*;
constexpr LayerCount kPatches = &GroomLayer::patch_count, kChunks = &GroomLayer::chunk_count;

class Checker {
 public:
  Checker(const Groom& groom, const std::string& name) : groom_(groom), name_(name) {}

  // The text of the first fault, or empty.
  std::string FindFault() {
    bool well = CheckSkeleton() && CheckLayout();
    for (size_t layer = 0; well && layer < groom_.layers.size(); ++layer) well = CheckLayer(layer);
    return fault_;
  }

 private:
  // All Fail functions note the fault and return false, for the caller to return.
  bool FailAt(std::string_view section, uint64_t at, std::string_view reason) {
    fault_ = Format("groom '{}': section '{}', byte {}: {}", name_, section, at, reason);
    return false;
  }

  // Fails at a field of items[index], which tells its place in the file.
  template <class T>
  bool Fail(const std::vector<T>& items, size_t index, const void* field, std::string_view reason) {
    uint64_t at = kHeaderBytes + kSectionCount * kSectionEntryBytes + CountItemBytes(General{}) +
                  MeasureItem(groom_.skeleton);
    std::string_view section;
    ListSections(
        [&](std::string_view name, const auto& candidate) {
          if (!section.empty()) return;
          if (static_cast<const void*>(&candidate) == static_cast<const void*>(&items)) {
            section = name;
            return;
          }
          for (const auto& item : candidate) at += MeasureItem(item);
        },
        groom_);
    for (size_t i = 0; i < index; ++i) at += MeasureItem(items[i]);
    FieldLocator locator{.wanted = field};
    if (field) ListFields(locator, items[index]);
    return FailAt(section, at + locator.found_at,
                  Format("item {}{}: {}", index,
                         locator.name.empty() ? std::string()
                                              : Format(", {}[{}]", locator.name, locator.element),
                         reason));
  }
  // Fails at the section as a whole.
  template <class T>
  bool FailSection(const std::vector<T>& items, std::string_view reason) {
    uint64_t at = kHeaderBytes;
    std::string_view section;
    uint32_t index = 2;
    ListSections(
        [&](std::string_view name, const auto& candidate) {
          if (static_cast<const void*>(&candidate) == static_cast<const void*>(&items)) {
            section = name;
            at += index * kSectionEntryBytes;
          }
          ++index;
        },
        groom_);
    return FailAt(section, at, reason);
  }

  template <class T>
  [[nodiscard]] bool CheckRange(const std::vector<T>& items, size_t index, const float* values,
                                size_t count, float low, float high) {
    for (size_t i = 0; i < count; ++i) {
      if (!(values[i] >= low && values[i] <= high))
        return Fail(items, index, values + i,
                    Format("{} is not a number between {} and {}", values[i], low, high));
    }
    return true;
  }

  // Holds all members of the block to the bounds that their rows give.
  template <class B>
  bool CheckBounds(const std::vector<B>& items, size_t index) {
    bool well = true;
    ForEachMember<B>([&]<class M>(const BlockMember<B, M>& row) {
      if constexpr (std::is_same_v<std::remove_all_extents_t<M>, float>)
        well = well && (!row.HasBounds() ||
                        CheckRange(items, index,
                                   reinterpret_cast<const float*>(&(items[index].*row.member)),
                                   sizeof(M) / sizeof(float), row.low, row.high));
    });
    return well;
  }

  [[nodiscard]] bool CheckSkeleton();
  [[nodiscard]] bool CheckLayout();
  [[nodiscard]] bool CheckLayer(size_t layer);
  [[nodiscard]] bool CheckLayerJoints(size_t layer, JointSet& moved);
  [[nodiscard]] bool CheckPatch(const GroomLayer& layer, uint32_t place, JointSet& used);
  [[nodiscard]] bool CheckMesh(size_t patch, JointSet& used);
  [[nodiscard]] bool CheckWeights(size_t patch, JointSet& used);
  [[nodiscard]] bool CheckChunk(const GroomLayer& layer, uint32_t place);
  [[nodiscard]] bool CheckHalo(const GroomLayer& layer, size_t chunk, JointSet& used);
  [[nodiscard]] bool CheckStrands(size_t chunk, const JointSet& used);
  template <class T>
  [[nodiscard]] bool CheckRest(const std::vector<T>& items, size_t index, uint32_t lanes);
  [[nodiscard]] bool CheckFinEdges(size_t index, uint32_t strands);
  [[nodiscard]] bool CheckDown(const std::vector<DownBlock>& items, size_t index, uint32_t lanes);
  size_t Count(LayerCount what, Has has, const GroomLayer* end = nullptr) const;

  const Groom& groom_;
  const std::string& name_;
  std::string fault_;
};

bool HasVertexRest(const LayerParams& p) { return p.chain == ChainKind::kVertex; }
bool HasShells(const LayerParams& p) { return p.output == Output::kShells; }
bool HasFins(const LayerParams& p) { return p.fins; }
bool HasVertexDown(const LayerParams& p) { return p.sag_free && HasVertexRest(p); }
bool HasStrandDown(const LayerParams& p) { return p.sag_free && !HasVertexRest(p); }
bool HasStrandTraits(const LayerParams& p) { return p.traits; }
bool HasVertexTraits(const LayerParams& p) { return p.traits && HasVertexRest(p); }
template <uint32_t kPoints>
bool HasStrandRest(const LayerParams& p) {
  return p.points == kPoints && !HasShells(p);
}

bool Checker::CheckSkeleton() {
  const uint64_t general_at = kHeaderBytes + kSectionCount * kSectionEntryBytes;
  if (!(groom_.unit_scale >= 1e-6f && groom_.unit_scale <= 1e6f))
    return FailAt(kSectionNames[0], general_at,
                  Format("unit scale {} is not between 1e-6 and 1e6", groom_.unit_scale));
  if (groom_.joint_count < 1 || groom_.joint_count > kJointsPerCharacter) {
    return FailAt(
        kSectionNames[0], general_at + 4,
        Format("{} joints; 1 to {} are allowed", groom_.joint_count, kJointsPerCharacter));
  }
  if (groom_.joint_names.size() != groom_.joint_count)
    return FailSection(groom_.joint_names, Format("{} names for {} joints",
                                                  groom_.joint_names.size(), groom_.joint_count));
  for (size_t i = 0; i < groom_.joint_names.size(); ++i)
    if (!IsPrintable(groom_.joint_names[i]))
      return Fail(groom_.joint_names, i, nullptr, "a joint's name holds control characters");
  const uint64_t skeleton_at = general_at + CountItemBytes(General{});
  const auto fail = [&](const void* field, std::string_view reason) {
    FieldLocator locator{.wanted = field};
    ListFields(locator, groom_.skeleton);
    return FailAt(kSectionNames[1], skeleton_at + locator.found_at,
                  Format("{}[{}]: {}", locator.name, locator.element, reason));
  };
  for (uint32_t j = 0; j < kJointsPerCharacter; ++j) {
    const int32_t parent = groom_.skeleton.parent[j];
    if (parent < -1 || parent >= int32_t(j))
      return fail(&groom_.skeleton.parent[j],
                  Format("parent {} of joint {} does not come before it", parent, j));
    for (const float& value : groom_.skeleton.inverse_bind[j]) {
      if (!(std::fabs(value) <= kLargest)) return fail(&value, "not finite, or absurdly large");
    }
  }
  return true;
}

// Which blocks there are.
bool Checker::CheckLayout() {
  const auto& layers = groom_.layers;
  if (layers.empty() || layers.size() > kLayersPerScene) {
    return FailSection(layers,
                       Format("{} layers; 1 to {} are allowed", layers.size(), kLayersPerScene));
  }
  uint64_t patches = 0, chunks = 0;
  for (size_t i = 0; i < layers.size(); ++i) {
    const GroomLayer& layer = layers[i];
    if (layer.name.empty() || !IsPrintable(layer.name))
      return Fail(layers, i, nullptr, "its name is empty or holds control characters");
    const std::string bad = FindBadParam(layer.params, layer.strand_texture.get());
    if (!bad.empty()) return Fail(layers, i, &layer.params.sort_bias, bad);
    const auto follow = [&](std::string_view kind, const uint32_t& first, const uint32_t& count,
                            uint32_t size, uint64_t& before) {
      if (first != before)
        return Fail(layers, i, &first, Format("{} begin at {}, expected {}", kind, first, before));
      if (count > kStrandsPerLayer / size)
        return Fail(layers, i, &count, Format("{} {}", count, kind));
      before += count;
      return true;
    };
    if (!follow("patches", layer.first_patch, layer.patch_count, kVerticesPerChunk, patches) ||
        !follow("chunks", layer.first_chunk, layer.chunk_count, kStrandsPerChunk, chunks))
      return false;
  }
  const auto expect = [&](const auto& items, uint64_t count) {
    return items.size() == count ||
           FailSection(items, Format("{} items where the layers need {}", items.size(), count));
  };
  return expect(groom_.layer_joints, layers.size()) && expect(groom_.mesh, patches) &&
         expect(groom_.strands, chunks) && expect(groom_.halo, chunks) &&
         expect(groom_.vertex_rest, Count(kPatches, HasVertexRest)) &&
         expect(groom_.strand_rest4, Count(kChunks, HasStrandRest<4>)) &&
         expect(groom_.strand_rest5, Count(kChunks, HasStrandRest<5>)) &&
         expect(groom_.strand_uv, chunks) &&
         expect(groom_.shell_skin, Count(kPatches, HasShells)) &&
         expect(groom_.fin_edges, Count(kChunks, HasFins)) &&
         expect(groom_.vertex_down, Count(kPatches, HasVertexDown)) &&
         expect(groom_.strand_down, Count(kChunks, HasStrandDown)) &&
         expect(groom_.strand_rest9, Count(kChunks, HasStrandRest<9>)) &&
         expect(groom_.vertex_traits, Count(kPatches, HasVertexTraits)) &&
         expect(groom_.strand_traits, Count(kChunks, HasStrandTraits));
}

// Patches or chunks of the layers that have the block in question. Of the layers before `end`: the
// place among such blocks of the first that `end` has.
size_t Checker::Count(LayerCount what, Has has, const GroomLayer* end) const {
  size_t count = 0;
  for (const GroomLayer& layer : groom_.layers) {
    if (&layer == end) break;
    if (has(layer.params)) count += layer.*what;
  }
  return count;
}

bool Checker::CheckPatch(const GroomLayer& layer, uint32_t place, JointSet& used) {
  const size_t patch = layer.first_patch + place;
  if (!CheckMesh(patch, used)) return false;
  const uint32_t vertices = groom_.mesh[patch].vertex_count;
  const auto index = [&](Has has) { return Count(kPatches, has, &layer) + place; };
  if (HasVertexRest(layer.params) && !CheckRest(groom_.vertex_rest, index(HasVertexRest), vertices))
    return false;
  if (HasVertexDown(layer.params) && !CheckDown(groom_.vertex_down, index(HasVertexDown), vertices))
    return false;
  if (HasVertexTraits(layer.params) && !CheckBounds(groom_.vertex_traits, index(HasVertexTraits)))
    return false;
  return !HasShells(layer.params) || CheckBounds(groom_.shell_skin, index(HasShells));
}

bool Checker::CheckChunk(const GroomLayer& layer, uint32_t place) {
  const size_t chunk = layer.first_chunk + place;
  const StrandBlock& block = groom_.strands[chunk];
  JointSet used;
  if (!CheckHalo(layer, chunk, used) || !CheckStrands(chunk, used)) return false;
  if (block.first_strand != place * kStrandsPerChunk)
    return Fail(groom_.strands, chunk, &block.first_strand,
                Format("{}, expected {}", block.first_strand, place * kStrandsPerChunk));
  const auto index = [&](Has has) { return Count(kChunks, has, &layer) + place; };
  if (!HasShells(layer.params) && !WithPoints(layer.params.points, [&]<uint32_t kPoints> {
        // Among blocks of as many points.
        return CheckRest(StrandRestOf<kPoints>(groom_), index(HasStrandRest<kPoints>),
                         block.strand_count);
      }))
    return false;
  if (HasStrandTraits(layer.params) && !CheckBounds(groom_.strand_traits, index(HasStrandTraits)))
    return false;
  if (HasFins(layer.params) && !CheckFinEdges(index(HasFins), block.strand_count)) return false;
  return !HasStrandDown(layer.params) ||
         CheckDown(groom_.strand_down, index(HasStrandDown), block.strand_count);
}

bool Checker::CheckLayer(size_t index) {
  const GroomLayer& layer = groom_.layers[index];
  JointSet moved;
  if (!CheckLayerJoints(index, moved)) return false;
  for (uint32_t p = 0; p < layer.patch_count; ++p) {
    JointSet used;
    if (!CheckPatch(layer, p, used)) return false;
    if ((used & ~moved).any())
      return Fail(groom_.layer_joints, index, groom_.layer_joints[index].joint,
                  Format("a joint that moves patch {} is missing", layer.first_patch + p));
  }
  uint64_t strands = 0;
  float longest = 0.0f;
  for (uint32_t c = 0; c < layer.chunk_count; ++c) {
    if (!CheckChunk(layer, c)) return false;
    const StrandBlock& block = groom_.strands[layer.first_chunk + c];
    strands += block.strand_count;
    for (uint32_t i = 0; i < block.strand_count; ++i) longest = std::max(longest, block.length[i]);
  }
  if (layer.strand_count != strands)
    return Fail(groom_.layers, index, &layer.strand_count,
                Format("{} strands, its chunks have {}", layer.strand_count, strands));
  if (!(layer.length_max >= longest * 0.999f && layer.length_max <= kLongest_m)) {
    return Fail(groom_.layers, index, &layer.length_max,
                Format("{} m; its longest strand has {} m", layer.length_max, longest));
  }
  return true;
}

bool Checker::CheckLayerJoints(size_t index, JointSet& moved) {
  const auto& items = groom_.layer_joints;
  const LayerJointBlock& block = items[index];
  if (block.count > kJointsPerCharacter)
    return Fail(items, index, &block.count, Format("{} joints", block.count));
  for (uint32_t i = 0; i < kJointsPerCharacter; ++i) {
    const bool live = i < block.count;
    if (block.joint[i] >= groom_.joint_count || (live && moved[block.joint[i]])) {
      return Fail(items, index, &block.joint[i],
                  Format("joint {} is unknown or named twice", block.joint[i]));
    }
    if (live) moved.set(block.joint[i]);
  }
  if (!CheckBounds(items, index)) return false;
  for (int axis = 0; axis < 3; ++axis) {
    for (uint32_t i = 0; i < kJointsPerCharacter; ++i) {
      if (block.low[axis][i] > block.high[axis][i]) {
        return Fail(items, index, &block.low[axis][i], "the box is inside out");
      }
    }
  }
  return true;
}

// `used`: the joints that move a vertex of the patch.
bool Checker::CheckMesh(size_t patch, JointSet& used) {
  const auto& items = groom_.mesh;
  const MeshBlock& block = items[patch];
  if (block.vertex_count < 1 || block.vertex_count > kVerticesPerChunk) {
    return Fail(items, patch, &block.vertex_count, Format("{} vertices", block.vertex_count));
  }
  if (!CheckBounds(items, patch)) return false;
  const auto is_unit = [&](const float(&row)[3][kVerticesPerChunk], uint32_t v) {
    const float square = row[0][v] * row[0][v] + row[1][v] * row[1][v] + row[2][v] * row[2][v];
    return std::fabs(square - 1.0f) <= kUnitTolerance ||
           Fail(items, patch, &row[0][v], "not a unit vector");
  };
  for (uint32_t v = 0; v < RoundUpToLaneGroups(block.vertex_count); ++v)
    if (!is_unit(block.normal, v) || !is_unit(block.tangent, v)) return false;
  return CheckWeights(patch, used);
}

bool Checker::CheckWeights(size_t patch, JointSet& used) {
  const auto& items = groom_.mesh;
  const MeshBlock& block = items[patch];
  for (uint32_t g = 0; g <= kVertexGroups; ++g) {
    const uint16_t row = block.group_first_row[g];
    if (row > kInfluenceRows || (g > 0 && row < block.group_first_row[g - 1])) {
      return Fail(items, patch, &block.group_first_row[g],
                  Format("{}: rows must ascend, up to {}", row, kInfluenceRows));
    }
  }
  for (const uint8_t& joint : block.row_joint)
    if (joint >= groom_.joint_count)
      return Fail(items, patch, &joint, Format("joint {} is unknown or out of order", joint));
  for (uint32_t g = 0; g < kVertexGroups; ++g) {
    const uint32_t begin = block.group_first_row[g], end = block.group_first_row[g + 1];
    float sum[kLaneGroup] = {};
    for (uint32_t row = begin; row < end; ++row) {
      const uint8_t joint = block.row_joint[row];
      if (row > begin && joint <= block.row_joint[row - 1]) {
        return Fail(items, patch, &block.row_joint[row],
                    Format("joint {} is unknown or out of order", joint));
      }
      for (uint32_t lane = 0; lane < kLaneGroup; ++lane) {
        sum[lane] += block.weight[row][lane];
        if (block.weight[row][lane] > 0.0f) used.set(joint);
      }
    }
    if (g * kLaneGroup >= block.vertex_count) continue;
    for (uint32_t lane = 0; lane < kLaneGroup; ++lane) {
      if (std::fabs(sum[lane] - 1.0f) > kSumTolerance) {
        return Fail(items, patch, &block.weight[std::min(begin, kInfluenceRows - 1)][lane],
                    Format("weights of vertex {} sum to {}", g * kLaneGroup + lane, sum[lane]));
      }
    }
  }
  return true;
}

// `used`: the joints that move a vertex of the halo.
bool Checker::CheckHalo(const GroomLayer& layer, size_t chunk, JointSet& used) {
  const HaloBlock& halo = groom_.halo[chunk];
  const uint32_t& count = groom_.strands[chunk].vertex_count;
  if (count < 1 || count > kVerticesPerChunk)
    return Fail(groom_.strands, chunk, &count, Format("{} vertices", count));
  for (uint32_t i = 0; i < kVerticesPerChunk; ++i) {
    const uint32_t place = halo.vertex[i];
    if (i >= count && place == ~0u) continue;
    const uint32_t patch = place / kVerticesPerChunk, lane = place % kVerticesPerChunk;
    if (i >= count || patch >= layer.patch_count ||
        lane >= groom_.mesh[layer.first_patch + patch].vertex_count)
      return Fail(groom_.halo, chunk, &halo.vertex[i],
                  Format("{}: no vertex of the layer, or behind the {} in use", place, count));
    used |= FindJoints(groom_.mesh[layer.first_patch + patch], lane);
  }
  return true;
}

bool Checker::CheckStrands(size_t chunk, const JointSet& used) {
  const auto& items = groom_.strands;
  const StrandBlock& block = items[chunk];
  const auto fail = [&](const void* field, std::string_view reason) {
    return Fail(items, chunk, field, reason);
  };
  if (block.strand_count < 1 || block.strand_count > kStrandsPerChunk) {
    return fail(&block.strand_count, Format("{} strands", block.strand_count));
  }
  const uint32_t lanes = RoundUpToLaneGroups(block.strand_count);
  if (block.control_count % kLaneGroup != 0 || block.control_count > lanes) {
    return fail(&block.control_count, Format("{} control strands", block.control_count));
  }
  if (!CheckBounds(items, chunk)) return false;
  const uint32_t controls = block.control_count ? block.control_count : lanes;
  for (uint32_t i = 0; i < kStrandsPerChunk; ++i) {
    for (const auto& corner : block.vertex)
      if (corner[i] >= block.vertex_count)
        return fail(&corner[i], Format("no vertex {}", corner[i]));
    if (block.control[i] >= controls) {
      return fail(&block.control[i], Format("strand {} is no control strand", block.control[i]));
    }
  }
  for (uint32_t i = 0; i < lanes; ++i) {
    const float sum = block.bary[0][i] + block.bary[1][i] + block.bary[2][i];
    if (std::fabs(sum - 1.0f) > kSumTolerance) {
      return fail(&block.bary[0][i], Format("barycentrics sum to {}", sum));
    }
    if (!(block.length[i] > 0.0f)) return fail(&block.length[i], "not above 0");
  }
  for (uint32_t joint = 0; joint < kJointsPerCharacter; ++joint) {
    const uint32_t& word = block.joint_mask[joint / 32];
    const bool set = word >> joint % 32 & 1;
    if (set && joint >= groom_.joint_count) return fail(&word, Format("no joint {}", joint));
    if (!set && used[joint]) {
      return fail(&word, Format("joint {} moves the chunk and is missing", joint));
    }
  }
  return true;
}

template <class T>
bool Checker::CheckRest(const std::vector<T>& items, size_t index, uint32_t count) {
  const T& block = items[index];
  if (!CheckBounds(items, index)) return false;
  for (uint32_t i = 0; i < RoundUpToLaneGroups(count); ++i) {
    if (!(block.segment_length[i] > 0.0f)) {
      return Fail(items, index, &block.segment_length[i], "not above 0");
    }
  }
  return true;
}

bool Checker::CheckFinEdges(size_t index, uint32_t strands) {
  const FinEdgeBlock& block = groom_.fin_edges[index];
  for (uint32_t t = 0; t < kStrandsPerChunk; ++t) {
    const uint32_t& owned = block.owned[t];
    if ((owned & 0x010101u) * 255u != owned)
      return Fail(groom_.fin_edges, index, &owned,
                  Format("{:#x}: three bytes of 0 or 255 are allowed", owned));
    if (t >= strands && owned != 0)
      return Fail(groom_.fin_edges, index, &owned, "no triangle has these edges");
  }
  return true;
}

bool Checker::CheckDown(const std::vector<DownBlock>& items, size_t index, uint32_t count) {
  const DownBlock& block = items[index];
  if (!CheckBounds(items, index)) return false;
  for (uint32_t i = 0; i < RoundUpToLaneGroups(count); ++i) {
    float square = 0.0f;
    for (const auto& row : block.down) square += row[i] * row[i];
    if (!(std::fabs(square - 1.0f) < kUnitTolerance))
      return Fail(items, index, &block.down[0][i], "not a direction of length 1");
  }
  return true;
}

}  // namespace

std::string FindGroomFault(const Groom& groom, const std::string& name) {
  return Checker(groom, name).FindFault();
}

}  // namespace pelt
