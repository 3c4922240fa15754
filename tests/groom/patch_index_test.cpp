// What a scene finds out about patches: for any share of living strands, every vertex that a
// kernel reads is among those that are skinned, and hardly more are.
#include "core/groom/patch_index.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <span>

#include "core/kernels/activate.hpp"
#include "core/random.hpp"
#include "tests/groom/groom_validator.hpp"
#include "tests/groom/torus_character.hpp"

namespace pelt::test {
namespace {

// A chunk uses a vertex from the group of its lanes on that begins with `lane`.
struct Use {
  uint32_t chunk, lane, patch, vertex;
};

// Lanes without a strand are worked on too, up to whole groups.
std::vector<Use> ListUses(const Groom& groom, const GroomLayer& layer) {
  std::vector<Use> uses;
  for (uint32_t c = 0; c < layer.chunk_count; ++c) {
    const StrandBlock& strands = groom.strands[layer.first_chunk + c];
    const HaloBlock& halo = groom.halo[layer.first_chunk + c];
    std::set<uint32_t> seen;
    for (uint32_t i = 0; i < RoundUpToLaneGroups(strands.strand_count); ++i)
      for (const auto& corner : strands.vertex) {
        const uint32_t place = halo.vertex[corner[i]];
        if (seen.insert(place).second)
          uses.push_back({c, i / kLaneGroup * kLaneGroup, place / kVerticesPerChunk,
                          place % kVerticesPerChunk});
      }
  }
  return uses;
}

// A thousand, and those where one more group of some chunk is worked on, with their neighbours.
std::set<float> ListShares(const Groom& groom, const GroomLayer& layer) {
  std::set<float> shares = {1e-9f, 1e-4f};
  for (int i = 1; i <= 1000; ++i) shares.insert(float(i) / 1000.0f);
  std::set<uint32_t> counts;
  for (uint32_t c = 0; c < layer.chunk_count; ++c)
    counts.insert(groom.strands[layer.first_chunk + c].strand_count);
  for (const uint32_t count : counts)
    for (uint32_t lane = kLaneGroup; lane < count; lane += kLaneGroup) {
      float below = float(lane) / float(count), above = below;
      shares.insert(below);
      for (int i = 0; i < 4; ++i) {
        shares.insert(below = std::nextafter(below, 0.0f));
        shares.insert(above = std::nextafter(above, 1.0f));
      }
    }
  return shares;
}

// Lanes of each chunk that kernels work on, by the arithmetic of `activate`.
std::vector<uint32_t> CountLanes(const Groom& groom, const GroomLayer& layer, float share) {
  std::vector<uint32_t> lanes;
  for (uint32_t c = 0; c < layer.chunk_count; ++c) {
    const uint32_t count = groom.strands[layer.first_chunk + c].strand_count;
    const float exact = share * float(count);
    lanes.push_back(RoundUpToLaneGroups(activate_detail::CountLive(exact, count)));
  }
  return lanes;
}

// Of each patch, one more than the last vertex that is used; 0: none is.
std::vector<uint32_t> FindEnds(const Groom& groom, const GroomLayer& layer,
                               std::span<const Use> uses, float share) {
  const std::vector<uint32_t> lanes = CountLanes(groom, layer, share);
  std::vector<uint32_t> ends(layer.patch_count, 0);
  for (const Use& use : uses)
    if (use.lane < lanes[use.chunk]) ends[use.patch] = std::max(ends[use.patch], use.vertex + 1);
  return ends;
}

void ExpectCounts(const Groom& groom, const GroomLayer& layer, const PatchIndex& index) {
  const std::vector<Use> uses = ListUses(groom, layer);
  for (const float share : ListShares(groom, layer)) {
    const std::vector<uint32_t> ends = FindEnds(groom, layer, uses, share);
    // Where only rounding keeps a group of lanes from being worked on, its vertices may be counted.
    const std::vector<uint32_t> more = FindEnds(groom, layer, uses, share * 1.00001f);
    for (uint32_t p = 0; p < layer.patch_count; ++p) {
      const uint32_t counted = activate_detail::CountVertices(index.patches[p], share);
      const uint32_t there = groom.mesh[layer.first_patch + p].vertex_count;
      ASSERT_GE(counted, ends[p]) << "patch " << p << ", share " << share;
      ASSERT_LE(counted, std::min(RoundUpToLaneGroups(more[p]), there))
          << "patch " << p << ", share " << share;
    }
  }
}

void ExpectBlocks(const Groom& groom, const GroomLayer& layer, const PatchIndex& index) {
  for (uint32_t p = 0; p < layer.patch_count; ++p) {
    SCOPED_TRACE(p);
    const MeshBlock& mesh = groom.mesh[layer.first_patch + p];
    const PatchBlock& patch = index.patches[p];
    ASSERT_EQ(patch.vertex_count, mesh.vertex_count);
    ASSERT_TRUE(std::ranges::is_sorted(patch.live_from));
    ASSERT_GE(patch.live_from[0], 0.0f);
    ASSERT_LE(patch.live_from[kVertexGroups - 1], 1.0f);
    JointSet all;
    for (uint32_t lane = 0; lane < mesh.vertex_count; ++lane) {
      JointSet joints;
      for (const auto& [joint, weight] : WeightsOf(mesh, lane)) joints.set(joint);
      ASSERT_EQ(FindJoints(mesh, lane), joints);
      all |= joints;
    }
    for (uint32_t joint = 0; joint < kJointsPerCharacter; ++joint)
      ASSERT_EQ((patch.joint_mask[joint / 32] >> joint % 32 & 1) != 0, all[joint]) << joint;
  }
}

void ExpectLists(const Groom& groom, const GroomLayer& layer, const PatchIndex& index) {
  for (uint32_t c = 0; c < layer.chunk_count; ++c) {
    SCOPED_TRACE(c);
    std::set<uint32_t> patches;  // ascending
    for (uint32_t i = 0; i < groom.strands[layer.first_chunk + c].vertex_count; ++i)
      patches.insert(groom.halo[layer.first_chunk + c].vertex[i] / kVerticesPerChunk);
    auto next = patches.begin();
    for (uint32_t i = 0; i < kListedPatches; ++i)
      ASSERT_EQ(index.chunks[c].patch[i], next == patches.end() ? ~0u : *next++) << i;
    ASSERT_EQ(index.chunks[c].patch[kListedPatches] != ~0u, patches.size() > kListedPatches);
  }
}

PatchIndex ExpectIndex(const Groom& groom, const GroomLayer& layer) {
  const PatchIndex index = IndexPatches(groom, layer);
  EXPECT_EQ(index.patches.size(), layer.patch_count);
  EXPECT_EQ(index.chunks.size(), layer.chunk_count);
  if (testing::Test::HasFailure()) return index;
  ExpectBlocks(groom, layer, index);
  ExpectLists(groom, layer, index);
  ExpectCounts(groom, layer, index);
  return index;
}

LayerSetup NewLayer(const char* name, float density) {
  LayerSetup layer;
  layer.name = name;
  layer.density = density;
  return layer;
}

TEST(PatchIndex, AgreesWithBakedGrooms) {
  std::vector<LayerSetup> layers = {NewLayer("sparse", 300.0f), NewLayer("mean", 4000.0f),
                                    NewLayer("dense", 20000.0f), NewLayer("shells", 1.0f)};
  layers[1].params.chain = ChainKind::kStrand;
  layers[3].params.output = Output::kShells;
  const Groom groom = BakeTorus(layers);
  ASSERT_EQ(groom.layers.size(), layers.size());
  for (const GroomLayer& layer : groom.layers) {
    SCOPED_TRACE(layer.name);
    ExpectIndex(groom, layer);
  }
}

TEST(PatchIndex, FewStrandsNeedFewVertices) {
  const Groom groom = BakeTorus(NewLayer("sparse", 300.0f));
  const PatchIndex index = IndexPatches(groom, groom.layers[0]);
  uint32_t all = 0, few = 0;
  for (const PatchBlock& patch : index.patches) {
    all += patch.vertex_count;
    few += activate_detail::CountVertices(patch, 0.1f);
    EXPECT_EQ(activate_detail::CountVertices(patch, 1.0f), patch.vertex_count);
  }
  EXPECT_LT(double(few), 0.6 * double(all));
}

// ---- Made by hand -------------------------------------------------------------------------------

void FillWeights(MeshBlock& mesh, Random& random) {
  uint32_t row = 0;
  for (uint32_t g = 0; g < kVertexGroups; ++g) {
    mesh.group_first_row[g] = uint16_t(row);
    if (g * kLaneGroup >= mesh.vertex_count) continue;
    const uint32_t joint = random.Below(100);
    mesh.row_joint[row] = uint8_t(joint);
    mesh.row_joint[row + 1] = uint8_t(joint + 1 + random.Below(100));
    // Of a few vertices one joint moves nothing, and so of some groups.
    const uint32_t mixed = random.Below(3);
    for (uint32_t i = 0; i < kLaneGroup; ++i) {
      const float share = float(random.Below(mixed + 1)) / 2.0f;
      mesh.weight[row][i] = 1.0f - share;
      mesh.weight[row + 1][i] = share;
    }
    row += 2;
  }
  mesh.group_first_row[kVertexGroups] = uint16_t(row);
}

enum class Order { kByShare, kDrawn };

// Behind a layer of one patch and one chunk one whose chunks have so many strands. Each group of a
// chunk's lanes has two vertices of its own, and uses some of the group before.
Groom MakeByHand(std::span<const uint32_t> counts, Order order) {
  constexpr uint32_t kEach = kVerticesPerChunk - 11;  // of a patch: not whole groups
  Random random(17);
  struct Vertex {
    uint32_t chunk, group, number;
    double share;
  };
  std::vector<Vertex> vertices;
  for (uint32_t c = 0; c < counts.size(); ++c)
    for (uint32_t i = 0; i < 2 * RoundUpToLaneGroups(counts[c]) / kLaneGroup; ++i)
      vertices.push_back({c, i / 2, i, double(i / 2 * kLaneGroup) / double(counts[c])});
  for (size_t i = vertices.size(); i > 1; --i)
    std::swap(vertices[i - 1], vertices[random.Below(uint32_t(i))]);
  if (order == Order::kByShare) std::ranges::stable_sort(vertices, {}, &Vertex::share);

  Groom groom;
  groom.layers.resize(2);
  groom.mesh.resize(1);
  groom.strands.resize(1 + counts.size());
  groom.halo.resize(1 + counts.size());
  for (HaloBlock& halo : groom.halo) std::fill(std::begin(halo.vertex), std::end(halo.vertex), ~0u);
  for (uint32_t at = 0; at < vertices.size(); ++at) {
    const uint32_t patch = at / kEach, lane = at % kEach;
    if (lane == 0) groom.mesh.emplace_back();
    groom.mesh.back().vertex_count = uint16_t(lane + 1);
    groom.halo[1 + vertices[at].chunk].vertex[vertices[at].number] =
        patch * kVerticesPerChunk + lane;
  }
  for (size_t p = 1; p < groom.mesh.size(); ++p) FillWeights(groom.mesh[p], random);
  for (uint32_t c = 0; c < counts.size(); ++c) {
    StrandBlock& strands = groom.strands[1 + c];
    strands.strand_count = counts[c];
    strands.vertex_count = 2 * RoundUpToLaneGroups(counts[c]) / kLaneGroup;
    for (uint32_t i = 0; i < kStrandsPerChunk; ++i) {
      const uint32_t source = std::min(i, counts[c] - 1), group = source / kLaneGroup;
      const uint32_t before = group == 0 ? 0 : 2 * group - 1 - source % 2;
      const uint32_t corners[3] = {before, 2 * group, 2 * group + 1};
      for (uint32_t k = 0; k < 3; ++k) strands.vertex[(k + source) % 3][i] = uint8_t(corners[k]);
    }
  }
  groom.layers[0].patch_count = groom.layers[0].chunk_count = 1;
  groom.layers[1].first_patch = groom.layers[1].first_chunk = 1;
  groom.layers[1].patch_count = uint32_t(groom.mesh.size() - 1);
  groom.layers[1].chunk_count = uint32_t(counts.size());
  return groom;
}

TEST(PatchIndex, AgreesWithChunksOfEverySize) {
  std::vector<uint32_t> counts;
  for (uint32_t count = 1; count <= kStrandsPerChunk; ++count) counts.push_back(count);
  for (const Order order : {Order::kByShare, Order::kDrawn}) {
    SCOPED_TRACE(order == Order::kByShare);
    const Groom groom = MakeByHand(counts, order);
    ExpectIndex(groom, groom.layers[1]);
  }
}

TEST(PatchIndex, AgreesWithChunksOfOneSize) {
  for (const uint32_t count : {1u, 15u, 16u, 17u, 49u, 63u, kStrandsPerChunk}) {
    SCOPED_TRACE(count);
    const std::vector<uint32_t> counts(40, count);
    const Groom groom = MakeByHand(counts, Order::kByShare);
    const PatchIndex index = ExpectIndex(groom, groom.layers[1]);
    // Nothing is behind the last vertex.
    const PatchBlock& last = index.patches.back();
    for (uint32_t g = RoundUpToLaneGroups(last.vertex_count) / kLaneGroup; g < kVertexGroups; ++g)
      EXPECT_EQ(last.live_from[g], 1.0f);
  }
}

// Weights of lanes that no vertex has do not count.
TEST(PatchIndex, JointsAreThoseOfVertices) {
  Groom groom = MakeByHand(std::array{33u}, Order::kByShare);
  MeshBlock& mesh = groom.mesh[1];
  ASSERT_EQ(mesh.vertex_count, 6u);
  mesh.row_joint[0] = 3;
  mesh.row_joint[1] = 200;
  for (uint32_t i = 0; i < kLaneGroup; ++i) {
    mesh.weight[0][i] = i < 6 ? 1.0f : 0.0f;
    mesh.weight[1][i] = i < 6 ? 0.0f : 1.0f;
  }
  const PatchBlock patch = ExpectIndex(groom, groom.layers[1]).patches[0];
  EXPECT_EQ(patch.joint_mask[0], 1u << 3);
  EXPECT_EQ(patch.joint_mask[200 / 32], 0u);
}

// Chunks whose vertices lie in so many patches, some of them in one alone.
TEST(PatchIndex, ListsAsManyPatchesAsFit) {
  for (const uint32_t patches : {1u, 2u, 30u, 31u, 32u, 33u, 40u}) {
    SCOPED_TRACE(patches);
    Groom groom;
    groom.mesh.resize(45);
    for (MeshBlock& mesh : groom.mesh) mesh.vertex_count = kLaneGroup;
    StrandBlock& strands = groom.strands.emplace_back();
    HaloBlock& halo = groom.halo.emplace_back();
    std::fill(std::begin(halo.vertex), std::end(halo.vertex), ~0u);
    // Descending, and the first of them twice.
    strands.vertex_count = patches + 1;
    for (uint32_t i = 0; i < patches; ++i) halo.vertex[i] = (44 - i) * kVerticesPerChunk + i % 16;
    halo.vertex[patches] = 44 * kVerticesPerChunk + 15;
    strands.strand_count = kStrandsPerChunk;
    for (uint32_t i = 0; i < kStrandsPerChunk; ++i)
      for (auto& corner : strands.vertex) corner[i] = uint8_t(i % (patches + 1));
    GroomLayer& layer = groom.layers.emplace_back();
    layer.patch_count = 45;
    layer.chunk_count = 1;
    const PatchListBlock list = ExpectIndex(groom, layer).chunks[0];
    EXPECT_EQ(list.patch[0], 45 - patches);
    EXPECT_EQ(list.patch[kListedPatches] == ~0u, patches <= 31);
  }
}

}  // namespace
}  // namespace pelt::test
