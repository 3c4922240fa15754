#include "core/groom/patches.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

#include "core/float_rules.hpp"
#include "core/groom/chain_order.hpp"
#include "core/groom/patch_index.hpp"

namespace pelt {
namespace {

// Parts of a path below this many strands are left as they come: they share a chunk anyway.
constexpr uint32_t kSmallestPart = 8;

using Point6 = std::array<float, 6>;

class Path {
 public:
  Path(std::span<const PatchStrand> strands, uint32_t chunk_strands)
      : strands_(strands), chunk_strands_(chunk_strands) {
    order_.resize(strands.size());
    FindTriangles();
    Lay(0, uint32_t(order_.size()));
  }

  std::vector<uint32_t> Take() const {
    std::vector<uint32_t> path(order_.size());
    for (size_t i = 0; i < path.size(); ++i) path[i] = order_[i].strand;
    return path;
  }

 private:
  struct Item {
    float key;
    uint32_t triangle, strand;
  };
  // Where the strands of a triangle stand, and which way they face, on the average.
  struct Triangle {
    glm::vec3 position, normal;
  };

  static bool IsBefore(const Item& a, const Item& b) {
    return std::tie(a.key, a.triangle, a.strand) < std::tie(b.key, b.triangle, b.strand);
  }

  // Triangles in the order of their vertices' numbers; strands in their own in each.
  void FindTriangles() {
    std::vector<uint32_t> by_triangle(strands_.size());
    std::iota(by_triangle.begin(), by_triangle.end(), 0u);
    std::ranges::stable_sort(by_triangle, {}, [&](uint32_t s) { return strands_[s].vertices; });
    for (size_t first = 0; first < by_triangle.size();) {
      const auto& vertices = strands_[by_triangle[first]].vertices;
      Triangle sum{};
      size_t last = first;
      for (; last < by_triangle.size() && strands_[by_triangle[last]].vertices == vertices;
           ++last) {
        const uint32_t s = by_triangle[last];
        order_[s] = {0.0f, uint32_t(triangles_.size()), s};
        sum.position += strands_[s].position;
        sum.normal += strands_[s].normal;
      }
      const float share = 1.0f / float(last - first);
      triangles_.push_back({sum.position * share, sum.normal * share});
      first = last;
    }
  }

  Point6 PlaceOf(const Item& item, float facing_scale) const {
    const Triangle& t = triangles_[item.triangle];
    return {t.position.x,
            t.position.y,
            t.position.z,
            t.normal.x * facing_scale,
            t.normal.y * facing_scale,
            t.normal.z * facing_scale};
  }

  void Lay(uint32_t first, uint32_t last) {
    const uint32_t count = last - first;
    if (count <= kSmallestPart) {
      SortPart(first, last);
      return;
    }
    const uint32_t chunks = (count + chunk_strands_ - 1) / chunk_strands_;
    const uint32_t left_count = chunks > 1 ? chunks / 2 * chunk_strands_ : count / 2;
    int axis;
    float facing_scale;
    ChooseAxis(first, last, axis, facing_scale);
    for (uint32_t i = first; i < last; ++i) {
      order_[i].key = PlaceOf(order_[i], facing_scale)[size_t(axis)];
    }
    // The end that is nearer to where the path stands comes first; whole chunks are counted from
    // it.
    if (StartsHigh(first, last, axis, facing_scale)) {
      for (uint32_t i = first; i < last; ++i) order_[i].key = -order_[i].key;
    }
    std::nth_element(order_.begin() + first, order_.begin() + first + left_count,
                     order_.begin() + last, IsBefore);
    Lay(first, first + left_count);
    Lay(first + left_count, last);
  }

  // Opposite sides count as far apart as two chunks are wide: sides of a thin thing part when the
  // part has become that small, and not before.
  void ChooseAxis(uint32_t first, uint32_t last, int& axis, float& facing_scale) const {
    Point6 low = PlaceOf(order_[first], 1.0f), high = low;
    float radius = strands_[order_[first].strand].radius;
    for (uint32_t i = first + 1; i < last; ++i) {
      const Point6 p = PlaceOf(order_[i], 1.0f);
      for (size_t k = 0; k < 6; ++k) {
        low[k] = std::min(low[k], p[k]);
        high[k] = std::max(high[k], p[k]);
      }
      radius = std::min(radius, strands_[order_[i].strand].radius);
    }
    const float strand_area = 3.4641016f * radius * radius;
    facing_scale = std::sqrt(strand_area * float(chunk_strands_));
    axis = 0;
    float widest = -1.0f;
    for (size_t k = 0; k < 6; ++k) {
      const float extent = (high[k] - low[k]) * (k < 3 ? 1.0f : facing_scale);
      if (extent > widest) {
        widest = extent;
        axis = int(k);
      }
    }
  }

  // Only smallest and largest keys are looked at: a sum would depend on the order that the standard
  // library's partition left.
  bool StartsHigh(uint32_t first, uint32_t last, int axis, float facing_scale) const {
    if (first == 0) return false;
    const float here = PlaceOf(order_[first - 1], facing_scale)[size_t(axis)];
    float low = order_[first].key, high = low;
    for (uint32_t i = first; i < last; ++i) {
      low = std::min(low, order_[i].key);
      high = std::max(high, order_[i].key);
    }
    return std::abs(high - here) < std::abs(low - here);
  }

  // Strand order: a complete rule, so it does not matter in which order the standard library's partition left them.
  void SortPart(uint32_t first, uint32_t last) {
    std::sort(order_.begin() + first, order_.begin() + last,
              [](const Item& a, const Item& b) { return a.strand < b.strand; });
  }

  std::span<const PatchStrand> strands_;
  uint32_t chunk_strands_;
  std::vector<Item> order_;
  std::vector<Triangle> triangles_;
};

// Cuts as many strands from the front of a path as fit a chunk.
class ChunkCutter {
 public:
  ChunkCutter(std::span<const PatchStrand> strands, const ChunkLimits& limits)
      : strands_(strands), limits_(limits) {
    for (const PatchStrand& strand : strands)
      for (const uint32_t v : strand.vertices)
        if (v >= seen_.size()) seen_.resize(v + 1, 0);
  }

  ChunkPart CutFirst(std::span<const uint32_t> path) {
    const auto part = path.first(CountFitting(path));
    ChunkPart chunk{{part.begin(), part.end()}, {}};
    std::sort(chunk.strands.begin(), chunk.strands.end());
    ++stamp_;
    for (const uint32_t s : chunk.strands)
      for (const uint32_t v : strands_[s].vertices)
        if (IsFresh(v)) chunk.vertices.push_back(v);
    return chunk;
  }

 private:
  bool IsFresh(uint32_t vertex) { return std::exchange(seen_[vertex], stamp_) != stamp_; }

  uint32_t CountFitting(std::span<const uint32_t> path) {
    ++stamp_;
    uint32_t vertices = 0, count = 0;
    for (; count < path.size() && count < limits_.strands; ++count) {
      uint32_t fresh = 0;
      for (const uint32_t v : strands_[path[count]].vertices) fresh += IsFresh(v);
      if (vertices + fresh > limits_.vertices) break;
      vertices += fresh;
    }
    return count;
  }

  std::span<const PatchStrand> strands_;
  ChunkLimits limits_;
  std::vector<uint32_t> seen_;
  uint32_t stamp_ = 0;
};

// Sets of joints of one patch, as bits of its own numbering.
constexpr uint32_t kPatchJoints = 64;

struct UsedVertex {
  uint32_t vertex;
  double live_from;
};

// Orders the vertices of a patch.
class PatchBuilder {
 public:
  // `first` as PackVertices has it.
  PatchBuilder(const Mesh& mesh, std::span<const uint8_t> first) : mesh_(mesh), first_(first) {}

  // False when the weight rows do not suffice.
  bool Build(std::span<const UsedVertex> part, VertexPatch& patch) {
    patch = {};
    ListVertices(part);
    if (!NumberJoints()) return false;
    uint64_t group_joints = 0;
    for (uint32_t bucket = 0; bucket < kTaken; ++bucket) {
      uint32_t left = 0;
      for (const PatchVertex& v : vertices_) left += v.bucket == bucket;
      for (; left > 0; --left) {
        const bool opens = patch.vertices.size() % kLaneGroup == 0;
        if (opens) group_joints = 0;
        PatchVertex& chosen = ChooseNext(bucket, opens, group_joints);
        group_joints |= chosen.joints;
        chosen.bucket = kTaken;
        patch.vertices.push_back(chosen.vertex);
        if (opens) patch.groups.emplace_back();
        const bool closes =
            patch.vertices.size() % kLaneGroup == 0 || patch.vertices.size() == vertices_.size();
        if (closes) SetJoints(patch.groups.back(), group_joints);
      }
    }
    size_t rows = 0;
    for (const VertexGroup& group : patch.groups) rows += group.joints.size();
    return rows <= kInfluenceRows;
  }

 private:
  struct PatchVertex {
    uint32_t vertex;
    uint32_t bucket;  // by level, the coarsest first, and in each by use
    uint64_t joints;
  };

  void ListVertices(std::span<const UsedVertex> part) {
    std::vector<ChainPlace> places;
    for (const UsedVertex& used : part) {
      const double from = used.live_from + 1e-5;  // LiveFrom is a little below
      uint32_t use = uint32_t(from >= 0.125) + (from >= 0.25) + (from >= 0.5);
      if (!first_.empty()) use = first_[used.vertex] ? 0 : use + 1;
      const glm::vec3 p = mesh_.position[used.vertex], n = mesh_.normal[used.vertex];
      places.push_back({{p.x, p.y, p.z}, {n.x, n.y, n.z}, use});
    }
    const std::vector<uint32_t> levels = FindChainLevels(places);
    vertices_.clear();
    for (size_t i = 0; i < part.size(); ++i)
      vertices_.push_back(
          {part[i].vertex, (kChainLevels - 1 - levels[i]) * kUses + places[i].use, 0});
  }

  // Ascending numbers for the joints of the patch; false when there are more than fit.
  bool NumberJoints() {
    uint64_t used[kJointsPerCharacter / 64] = {};
    for (const PatchVertex& v : vertices_) {
      for (int i = 0; i < 4; ++i) {
        const uint8_t joint = mesh_.joints[v.vertex][size_t(i)];
        if (mesh_.weights[v.vertex][i] > 0.0f) used[joint / 64] |= uint64_t(1) << joint % 64;
      }
    }
    uint8_t number[kJointsPerCharacter];
    patch_joint_.clear();
    for (uint32_t joint = 0; joint < kJointsPerCharacter; ++joint) {
      if (!(used[joint / 64] >> joint % 64 & 1)) continue;
      if (patch_joint_.size() == kPatchJoints) return false;
      number[joint] = uint8_t(patch_joint_.size());
      patch_joint_.push_back(uint8_t(joint));
    }
    for (PatchVertex& v : vertices_) {
      for (int i = 0; i < 4; ++i) {
        if (mesh_.weights[v.vertex][i] > 0.0f) {
          v.joints |= uint64_t(1) << number[mesh_.joints[v.vertex][size_t(i)]];
        }
      }
    }
    return true;
  }

  // Fewest joints that the group does not have yet, then most that it has; a group opens with the
  // largest set, so that its subsets follow for nothing.
  PatchVertex& ChooseNext(uint32_t bucket, bool opens, uint64_t group_joints) {
    PatchVertex* best = nullptr;
    int best_score = 0;
    for (PatchVertex& v : vertices_) {
      if (v.bucket != bucket) continue;
      const int size = std::popcount(v.joints);
      const int fresh = std::popcount(v.joints & ~group_joints);
      const int score = opens ? size : size - 256 * fresh;
      if (!best || score > best_score || (score == best_score && v.vertex < best->vertex)) {
        best = &v;
        best_score = score;
      }
    }
    return *best;
  }

  void SetJoints(VertexGroup& group, uint64_t joints) const {
    group.joints.clear();
    for (; joints; joints &= joints - 1) {
      group.joints.push_back(patch_joint_[size_t(std::countr_zero(joints))]);
    }
  }

  static constexpr uint32_t kUses = 5, kTaken = kChainLevels * kUses;
  const Mesh& mesh_;
  std::span<const uint8_t> first_;
  std::vector<PatchVertex> vertices_;
  std::vector<uint8_t> patch_joint_;
};

// In the order of their first use.
std::vector<UsedVertex> ListUsed(const Mesh& mesh, std::span<const PatchStrand> strands,
                                 std::span<const ChunkPart> chunks) {
  std::vector<UsedVertex> used;
  std::vector<uint32_t> place(mesh.position.size(), ~0u);
  for (const ChunkPart& chunk : chunks) {
    for (const uint32_t v : chunk.vertices) {
      if (place[v] != ~0u) continue;
      place[v] = uint32_t(used.size());
      used.push_back({v, 1.0});
    }
    const uint32_t count = uint32_t(chunk.strands.size());
    for (uint32_t i = 0; i < count; ++i)
      for (const uint32_t v : strands[chunk.strands[i]].vertices) {
        double& from = used[place[v]].live_from;
        from = std::min(from, LiveFrom(i, count));
      }
  }
  return used;
}

}  // namespace

std::vector<ChunkPart> CutChunks(std::span<const PatchStrand> strands, const ChunkLimits& limits) {
  const std::vector<uint32_t> path = Path(strands, limits.strands).Take();
  ChunkCutter cutter(strands, limits);
  std::vector<ChunkPart> chunks;
  for (std::span<const uint32_t> rest = path; !rest.empty();) {
    chunks.push_back(cutter.CutFirst(rest));
    rest = rest.subspan(chunks.back().strands.size());
  }
  return chunks;
}

std::vector<VertexPatch> PackVertices(const Mesh& mesh, std::span<const PatchStrand> strands,
                                      std::span<const ChunkPart> chunks,
                                      std::span<const uint8_t> first) {
  const std::vector<UsedVertex> used = ListUsed(mesh, strands, chunks);
  const size_t parts = (used.size() + kVerticesPerChunk - 1) / kVerticesPerChunk;
  const size_t each = RoundUpToLaneGroups(uint32_t((used.size() + parts - 1) / parts));
  PatchBuilder builder(mesh, first);
  std::vector<VertexPatch> patches;
  for (std::span<const UsedVertex> rest = used; !rest.empty();) {
    size_t count = std::min(each, rest.size());
    VertexPatch& patch = patches.emplace_back();
    // One vertex always fits: four joints.
    while (!builder.Build(rest.first(count), patch))
      count = count > kLaneGroup ? (count - 1) / kLaneGroup * kLaneGroup : count - 1;
    rest = rest.subspan(count);
  }
  return patches;
}

}  // namespace pelt
