// Patches and chunks: every limit, every promise of chunk.hpp, full chunks, shared borders.
#include "core/groom/chunk_builder.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/random.hpp"
#include "tests/groom/groom_validator.hpp"
#include "tests/groom/torus_character.hpp"

namespace pelt::test {
namespace {

// A sheet of quads whose vertices follow `joints_of(vertex)`.
template <class F>
Mesh MakeSheet(uint32_t side, F joints_of) {
  Mesh mesh;
  for (uint32_t v = 0; v < side * side; ++v) {
    mesh.position.push_back({float(v % side), 0.0f, float(v / side)});
    mesh.normal.push_back({0.0f, 1.0f, 0.0f});
    mesh.joints.push_back(joints_of(v));
    mesh.weights.push_back({0.4f, 0.3f, 0.2f, 0.1f});
  }
  for (uint32_t y = 0; y + 1 < side; ++y) {
    for (uint32_t x = 0; x + 1 < side; ++x) {
      const uint32_t a = y * side + x;
      mesh.triangles.push_back({a, a + 1, a + side});
      mesh.triangles.push_back({a + side, a + 1, a + side + 1});
    }
  }
  return mesh;
}

std::vector<PatchStrand> SpreadOver(const Mesh& mesh, uint32_t count, uint64_t seed) {
  Random random(seed);
  const float area = 0.5f * float(mesh.triangles.size());
  const float radius = std::sqrt(area / float(count) / 3.4641016f);
  std::vector<PatchStrand> strands;
  for (uint32_t i = 0; i < count; ++i) {
    const auto& v = mesh.triangles[random.Below(uint32_t(mesh.triangles.size()))];
    const glm::vec3 middle =
        (mesh.position[v[0]] + mesh.position[v[1]] + mesh.position[v[2]]) / 3.0f;
    strands.push_back({middle, {0, 1, 0}, v, radius});
  }
  return strands;
}

std::array<uint8_t, 4> OneSet(uint32_t) { return {1, 2, 3, 4}; }

void ExpectChunks(std::span<const PatchStrand> strands, std::span<const ChunkPart> chunks,
                  const ChunkLimits& limits) {
  std::set<uint32_t> seen;
  for (const ChunkPart& chunk : chunks) {
    ASSERT_FALSE(chunk.strands.empty());
    ASSERT_LE(chunk.strands.size(), limits.strands);
    ASSERT_LE(chunk.vertices.size(), limits.vertices);
    ASSERT_TRUE(std::is_sorted(chunk.strands.begin(), chunk.strands.end()));
    std::vector<uint32_t> used;  // in the order of the first use
    for (const uint32_t s : chunk.strands) {
      ASSERT_TRUE(seen.insert(s).second) << "strand " << s << " twice";
      for (const uint32_t v : strands[s].vertices)
        if (std::ranges::find(used, v) == used.end()) used.push_back(v);
    }
    ASSERT_EQ(chunk.vertices, used);
  }
  ASSERT_EQ(seen.size(), strands.size());
}

// Where each vertex comes in the order in which the chunks use them.
std::map<uint32_t, size_t> FindOrder(std::span<const ChunkPart> chunks) {
  std::map<uint32_t, size_t> order;
  for (const ChunkPart& chunk : chunks)
    for (const uint32_t v : chunk.vertices) order.emplace(v, order.size());
  return order;
}

void ExpectPatches(const Mesh& mesh, std::span<const ChunkPart> chunks,
                   std::span<const VertexPatch> patches) {
  const std::map<uint32_t, size_t> order = FindOrder(chunks);
  std::set<uint32_t> seen;
  for (const VertexPatch& patch : patches) {
    ASSERT_FALSE(patch.vertices.empty());
    ASSERT_LE(patch.vertices.size(), kVerticesPerChunk);
    const size_t first = seen.size();  // patches follow each other in that order
    for (const uint32_t v : patch.vertices) {
      ASSERT_TRUE(seen.insert(v).second) << "vertex " << v << " twice";
      const auto found = order.find(v);
      ASSERT_NE(found, order.end()) << "no strand uses vertex " << v;
      ASSERT_GE(found->second, first);
      ASSERT_LT(found->second, first + patch.vertices.size());
    }
    ASSERT_EQ(patch.groups.size(),
              RoundUpToLaneGroups(uint32_t(patch.vertices.size())) / kLaneGroup);
    size_t rows = 0;
    for (size_t g = 0; g < patch.groups.size(); ++g) {
      std::set<uint8_t> joints;
      for (size_t i = g * kLaneGroup; i < std::min((g + 1) * kLaneGroup, patch.vertices.size());
           ++i) {
        for (const uint8_t j : mesh.joints[patch.vertices[i]]) joints.insert(j);
      }
      ASSERT_EQ(patch.groups[g].joints, std::vector<uint8_t>(joints.begin(), joints.end()));
      rows += joints.size();
    }
    ASSERT_LE(rows, kInfluenceRows);
  }
  ASSERT_EQ(seen.size(), order.size());
}

TEST(CutChunks, DenseLayersFillEveryChunkButTheLast) {
  const Mesh mesh = MakeSheet(10, OneSet);
  for (const uint32_t count : {1u, 127u, 128u, 129u, 5000u, 12345u}) {
    const auto strands = SpreadOver(mesh, count, 1);
    const auto chunks = CutChunks(strands);
    ExpectChunks(strands, chunks, {});
    EXPECT_EQ(chunks.size(), (count + kStrandsPerChunk - 1) / kStrandsPerChunk);
    ExpectPatches(mesh, chunks, PackVertices(mesh, strands, chunks));
  }
}

TEST(CutChunks, SparseLayersFillTheirVertices) {
  const Mesh mesh = MakeSheet(120, OneSet);
  const auto strands = SpreadOver(mesh, 6000, 2);
  const auto chunks = CutChunks(strands);
  ExpectChunks(strands, chunks, {});
  size_t vertices = 0;
  for (const ChunkPart& chunk : chunks) vertices += chunk.vertices.size();
  EXPECT_GT(double(vertices) / double(chunks.size() * kVerticesPerChunk), 0.95);
  ExpectPatches(mesh, chunks, PackVertices(mesh, strands, chunks));
}

// A mesh of so many joints that its weights fill patches before its vertices do.
Mesh MakeSheetOfManyJoints() {
  Random random(3);
  return MakeSheet(40, [&](uint32_t) {
    std::array<uint8_t, 4> joints;
    for (size_t i = 0; i < 4; ++i) joints[i] = uint8_t(4 * random.Below(64) + uint32_t(i));
    return joints;
  });
}

TEST(CutChunks, KeepsToEveryLimit) {
  const Mesh mesh = MakeSheetOfManyJoints();
  const auto strands = SpreadOver(mesh, 3000, 4);
  for (const ChunkLimits& limits : {ChunkLimits{}, ChunkLimits{32, 128}, ChunkLimits{128, 20},
                                    ChunkLimits{128, 3}, ChunkLimits{1, 128}}) {
    ExpectChunks(strands, CutChunks(strands, limits), limits);
  }
}

TEST(CutChunks, ChunksAreCompact) {
  const Mesh mesh = MakeSheet(33, OneSet);
  const auto strands = SpreadOver(mesh, 64 * kStrandsPerChunk, 5);
  double extent = 0.0;
  const auto chunks = CutChunks(strands);
  for (const ChunkPart& chunk : chunks) {
    glm::vec3 low(1e9f), high(-1e9f);
    for (const uint32_t s : chunk.strands) {
      low = glm::min(low, strands[s].position);
      high = glm::max(high, strands[s].position);
    }
    extent += double(std::max(high.x - low.x, high.z - low.z));
  }
  // 64 square chunks of a 32 x 32 sheet would have a side of 4.
  EXPECT_LT(extent / double(chunks.size()), 5.0);
}

TEST(CutChunks, TrianglesStayWhole) {
  const Mesh mesh = MakeSheet(33, OneSet);
  const auto strands = SpreadOver(mesh, 64 * kStrandsPerChunk, 10);
  const auto chunks = CutChunks(strands);
  std::map<std::array<uint32_t, 3>, std::set<const ChunkPart*>> chunks_of;
  size_t uses = 0;
  for (const ChunkPart& chunk : chunks) {
    uses += chunk.vertices.size();
    for (const uint32_t s : chunk.strands) chunks_of[strands[s].vertices].insert(&chunk);
  }
  size_t cut = 0;
  for (const auto& [triangle, of] : chunks_of) cut += of.size() - 1;
  // A halving cuts one triangle at most; 64 squares of 4 have 25 vertices each.
  EXPECT_LE(cut, chunks.size() - 1);
  EXPECT_LT(double(uses) / double(chunks.size()), 30.0);
}

TEST(CutChunks, TwoSidesOfAThinSheetPart) {
  const Mesh mesh = MakeSheet(33, OneSet);
  auto strands = SpreadOver(mesh, 64 * kStrandsPerChunk, 6);
  for (size_t i = 0; i < strands.size(); ++i) {
    if (i % 2 == 0) {
      strands[i].normal.y = -1.0f;
      std::swap(strands[i].vertices[1], strands[i].vertices[2]);  // the triangle's other side
    }
    strands[i].radius *= 1.41421356f;  // half as many on each side
  }
  uint32_t mixed = 0;
  const auto chunks = CutChunks(strands);
  for (const ChunkPart& chunk : chunks) {
    uint32_t above = 0;
    for (const uint32_t s : chunk.strands) above += strands[s].normal.y > 0.0f;
    mixed += above > 0 && above < chunk.strands.size();
  }
  EXPECT_LE(mixed, chunks.size() / 4);
}

TEST(PackVertices, PatchesAreOfOneSize) {
  for (const uint32_t side : {4u, 10u, 12u, 20u, 40u}) {
    const Mesh mesh = MakeSheet(side, OneSet);
    const auto strands = SpreadOver(mesh, 5000, 11);
    const auto chunks = CutChunks(strands);
    const auto patches = PackVertices(mesh, strands, chunks);
    ExpectPatches(mesh, chunks, patches);
    const size_t used = FindOrder(chunks).size();
    const size_t parts = (used + kVerticesPerChunk - 1) / kVerticesPerChunk;
    ASSERT_EQ(patches.size(), parts) << used;
    for (size_t p = 0; p + 1 < parts; ++p)
      EXPECT_EQ(patches[p].vertices.size(),
                RoundUpToLaneGroups(uint32_t((used + parts - 1) / parts)));
  }
}

TEST(PackVertices, KeepsToTheWeightsThatFit) {
  const Mesh mesh = MakeSheetOfManyJoints();
  const auto strands = SpreadOver(mesh, 3000, 4);
  for (const ChunkLimits& limits : {ChunkLimits{}, ChunkLimits{128, 3}}) {
    const auto chunks = CutChunks(strands, limits);
    const auto patches = PackVertices(mesh, strands, chunks);
    ExpectPatches(mesh, chunks, patches);
    EXPECT_GT(patches.size() * kVerticesPerChunk, 2 * FindOrder(chunks).size());
  }
}

// Vertices of the strands of which some lane is worked on where a little less than the share lives.
std::set<uint32_t> FindUsed(std::span<const PatchStrand> strands, std::span<const ChunkPart> chunks,
                            double share) {
  std::set<uint32_t> used;
  for (const ChunkPart& chunk : chunks) {
    const size_t n = chunk.strands.size();
    const auto live = uint32_t(std::ceil(share * (1.0 - 1e-4) * double(n)));
    for (size_t i = 0; i < std::min<size_t>(RoundUpToLaneGroups(live), n); ++i) {
      const auto& corners = strands[chunk.strands[i]].vertices;
      used.insert(corners.begin(), corners.end());
    }
  }
  return used;
}

TEST(PackVertices, APrefixOfStrandsUsesAPrefixOfVertices) {
  const Mesh mesh = MakeSheet(40, OneSet);
  for (const uint32_t count : {1500u, 4000u}) {
    const auto strands = SpreadOver(mesh, count, 7);
    const auto chunks = CutChunks(strands);
    const auto patches = PackVertices(mesh, strands, chunks);
    size_t last = 0;
    for (const double share : {0.125, 0.25, 0.5, 1.0}) {
      const std::set<uint32_t> used = FindUsed(strands, chunks, share);
      EXPECT_GT(used.size(), last) << "nothing is distinguished";
      last = used.size();
      for (const VertexPatch& patch : patches)
        ASSERT_TRUE(std::ranges::is_partitioned(patch.vertices, [&](uint32_t v) {
          return used.contains(v);
        })) << share;
    }
  }
}

TEST(PackVertices, GroupsShareJoints) {
  // Four joint sets of four joints, scattered over the vertices, which all live from the first
  // strand on: sorted, 16 vertices need one set or two, or of the few chains that stay longest, which lie
  // apart, nearly all of the 16 joints; as they come all would.
  Random random(8);
  const Mesh mesh = MakeSheet(40, [&](uint32_t) {
    const uint8_t set = uint8_t(4 * random.Below(4));
    return std::array<uint8_t, 4>{set, uint8_t(set + 1), uint8_t(set + 2), uint8_t(set + 3)};
  });
  const auto strands = SpreadOver(mesh, 4000, 9);
  const auto chunks = CutChunks(strands, {kLaneGroup, kVerticesPerChunk});
  size_t rows = 0, groups = 0;
  for (const VertexPatch& patch : PackVertices(mesh, strands, chunks)) {
    for (const VertexGroup& group : patch.groups) rows += group.joints.size();
    groups += patch.groups.size();
  }
  EXPECT_LT(double(rows) / double(groups), 13.0);
}

LayerSetup MakeCoat(float density) {
  LayerSetup layer;
  layer.name = "coat";
  layer.density = density;
  layer.length.randomise = 0.5f;
  layer.frizz = Attribute(20.0f);
  layer.curl = Attribute(400.0f);
  layer.twist = Attribute(900.0f);
  layer.strength.randomise = 0.5f;
  layer.film_strip_count = 4;
  return layer;
}

TEST(Chunks, HoldEveryPromiseForBothKindsOfChains) {
  for (const float density : {300.0f, 4000.0f, 40000.0f}) {
    LayerSetup layer = MakeCoat(density);
    ExpectValidGroom(BakeTorus(layer));
    layer.params.chain = ChainKind::kStrand;
    ExpectValidGroom(BakeTorus(layer));
    layer.params.points = 5;
    layer.offset = Attribute(0.01f);
    ExpectValidGroom(BakeTorus(layer));
  }
}

TEST(Chunks, HoldEveryPromiseOfSagFreeLayers) {
  LayerSetup layer = MakeCoat(4000.0f);
  layer.params.solver = Solver::kModal;
  layer.params.sag_free = true;
  const Groom on_vertices = BakeTorus(layer);
  ExpectValidGroom(on_vertices);
  EXPECT_EQ(on_vertices.vertex_down.size(), on_vertices.mesh.size());
  EXPECT_TRUE(on_vertices.strand_down.empty());
  layer.params.chain = ChainKind::kStrand;
  const Groom of_strands = BakeTorus(layer);
  ExpectValidGroom(of_strands);
  EXPECT_EQ(of_strands.strand_down.size(), of_strands.strands.size());
  EXPECT_TRUE(of_strands.vertex_down.empty());
}

TEST(Chunks, ShareTheVerticesOfTheirBorders) {
  const Groom groom = BakeTorus(MakeCoat(20000.0f));
  EXPECT_GT(CountShared(groom, groom.layers[0]), 200u);
}

TEST(Patches, HaveEachVertexOnce) {
  const Mesh mesh = MakeTorus().mesh;
  for (const float density : {300.0f, 4000.0f, 20000.0f}) {
    SCOPED_TRACE(density);
    const Groom groom = BakeTorus(MakeCoat(density));
    const size_t vertices = ExpectEachVertexOnce(groom, groom.layers[0], mesh);
    if (density == 20000.0f) {
      EXPECT_EQ(vertices, mesh.position.size());
    } else {
      EXPECT_LE(vertices, mesh.position.size());
    }
  }
}

TEST(Patches, AgreeOnBothSidesOfASeam) {
  const Groom groom = BakeTorus(MakeCoat(20000.0f));
  EXPECT_EQ(ExpectSeamsAgree(groom, groom.layers[0], 0), 48u + 16u - 1u);
}

TEST(Chunks, DenseLayersAreFull) {
  const Groom groom = BakeTorus(MakeCoat(40000.0f));
  const double lanes = double(groom.strands.size()) * kStrandsPerChunk;
  EXPECT_GT(double(groom.layers[0].strand_count) / lanes, 0.95);
}

TEST(Chunks, ClumpControlsAreRoundedUpAndFewerThanAll) {
  LayerSetup layer = MakeCoat(40000.0f);
  layer.clump_controls = 17;
  EXPECT_EQ(BakeTorus(layer).strands[0].control_count, 32u);
  layer.clump_controls = 64;
  const Groom groom = BakeTorus(layer);
  for (const StrandBlock& block : groom.strands) {
    EXPECT_LT(block.control_count, block.strand_count);
    EXPECT_LE(block.control_count, 64u);
  }
  layer.params.clump = layer.params.wet_clump = 0.0f;
  EXPECT_EQ(BakeTorus(layer).strands[0].control_count, 0u);
  layer.params.wet_clump = 0.5f;  // dry fur that clumps when wet needs them too
  EXPECT_EQ(BakeTorus(layer).strands[0].control_count, 64u);
}

// Where a strand of the only layer stands.
glm::dvec3 RootOf(const Groom& groom, size_t chunk, uint32_t lane) {
  const StrandBlock& block = groom.strands[chunk];
  glm::dvec3 root(0.0);
  for (int k = 0; k < 3; ++k) {
    const auto [patch, v] = FindCorner(groom, groom.layers[0], chunk, block.vertex[k][lane]);
    for (int axis = 0; axis < 3; ++axis)
      root[axis] += double(block.bary[k][lane]) * double(groom.mesh[patch].position[axis][v]);
  }
  return root;
}

// A torus' UVs are its two angles. Between 0 and 1 all the same where a texture repeats.
TEST(Chunks, StrandsKnowWhereOnTheTextureTheyStand) {
  const Groom groom = BakeTorus(MakeCoat(20000.0f));
  ASSERT_EQ(groom.strand_uv.size(), groom.strands.size());
  const auto apart = [](double a, double b) { return std::abs(std::remainder(a - b, 1.0)); };
  for (size_t c = 0; c < groom.strands.size(); ++c) {
    for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) {
      const glm::dvec3 p = RootOf(groom, c, lane);
      const double turn = 2.0 * exact::kPi, ring = std::hypot(p[0], p[2]) - 0.3;
      const uint32_t uv = groom.strand_uv[c].uv[lane];
      ASSERT_LT(apart((uv & 0xffffu) / 65535.0, std::atan2(p[2], p[0]) / turn), 0.004);
      ASSERT_LT(apart((uv >> 16) / 65535.0, std::atan2(p[1], ring) / turn), 0.01);
    }
  }
  for (const StrandUvBlock& block : BakeTorus(MakeCoat(2000.0f), {.uvs = false}).strand_uv)
    for (const uint32_t uv : block.uv) ASSERT_EQ(uv, 0u);
}

TEST(Chunks, ControlsAreTheNearest) {
  const Groom groom = BakeTorus(MakeCoat(40000.0f));
  const StrandBlock& block = groom.strands[3];
  const auto root = [&](uint32_t lane) { return RootOf(groom, 3, lane); };
  ASSERT_GT(block.control_count, 0u);
  for (uint32_t i = block.control_count; i < block.strand_count; ++i) {
    double nearest = 1e300;
    for (uint32_t c = 0; c < block.control_count; ++c) {
      nearest = std::min(nearest, glm::length(root(i) - root(c)));
    }
    EXPECT_NEAR(glm::length(root(i) - root(block.control[i])), nearest, 1e-6);
  }
}

TEST(Chunks, OffsetRaisesTheSkinInMetresWhateverTheFileUnit) {
  LayerSetup layer = MakeCoat(4000.0f);
  const TorusOptions centimetres{.scale = 100.0f};
  const Groom flat = BakeTorus(layer, centimetres);
  layer.offset = Attribute(0.005f);
  const Groom raised = BakeTorus(layer, centimetres);
  ASSERT_EQ(flat.mesh.size(), raised.mesh.size());
  for (size_t p = 0; p < flat.mesh.size(); ++p) {
    for (uint32_t v = 0; v < flat.mesh[p].vertex_count; ++v) {
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(raised.mesh[p].position[axis][v] - flat.mesh[p].position[axis][v],
                    0.5f * flat.mesh[p].normal[axis][v], 2e-5f);
      }
    }
  }
}

// The slow, obvious reference of a vertex chain: the weighted mean over all strands of the layer.
TEST(VertexChains, AreTheMeanOfTheLayersStrandsRemadeWithEqualSegments) {
  CoatedTorus torus;
  torus.layer = MakeCoat(4000.0f);
  torus.Scatter();
  const Mesh& mesh = torus.character.mesh;
  const RestGeometry& rest = torus.rest;
  const std::vector<GroomedStrand> strands = torus.Groom();
  const auto duplicates = FindSeamDuplicates(mesh);
  const VertexChains chains(mesh, rest, duplicates, torus.Maker(), strands);
  const uint32_t vertex = mesh.triangles[strands[5].place.triangle][1];
  const RootFrame frame =
      MakeRootFrame(glm::dvec3(rest.normal[vertex]), glm::dvec3(rest.tangent[vertex]));
  glm::dvec3 mean[3] = {};
  double sum = 0.0, length = 0.0, strength = 0.0;
  for (const GroomedStrand& s : strands) {
    for (int k = 0; k < 3; ++k) {
      const uint32_t v = mesh.triangles[s.place.triangle][size_t(k)];
      if (mesh.position[v] != mesh.position[vertex]) continue;
      const double w = std::max(double(s.place.bary[k]), 1e-3);
      sum += w;
      length += w * s.length;
      strength += w * s.strength;
      for (int i = 0; i < 3; ++i) mean[i] += w * s.frame.FromFrame(s.rest.offset[i]);
    }
  }
  ASSERT_GT(sum, 0.0);
  const VertexChain& chain = chains[vertex];
  EXPECT_NEAR(chain.length, length / sum, 1e-7);
  EXPECT_NEAR(chain.strength, strength / sum, 1e-6);
  glm::dvec3 last(0.0), end(0.0);
  for (int i = 0; i < 3; ++i) {
    end += glm::normalize(mean[i] - last) * (length / sum / 3.0);
    last = mean[i];
    EXPECT_NEAR(glm::length(frame.FromFrame(chain.rest.offset[i]) - end), 0.0, 1e-6);
  }
}

TEST(VertexChains, ASeamDoesNotPartTheFur) {
  CoatedTorus torus;
  torus.layer = MakeCoat(20000.0f);
  torus.layer.offset = Attribute(0.01f);
  torus.layer.offset.randomise = 0.5f;
  torus.Scatter();
  const Mesh& mesh = torus.character.mesh;  // first and last column lie on each other
  const auto duplicates = FindSeamDuplicates(mesh);
  EXPECT_EQ(duplicates[0], 0u);
  EXPECT_EQ(duplicates[16], 0u);  // once around the tube
  EXPECT_EQ(duplicates[17], 17u);
  const VertexChains chains(mesh, torus.rest, duplicates, torus.Maker(), torus.Groom());
  for (uint32_t i = 0; i <= 48; ++i) {
    const VertexChain &a = chains[i * 17], &b = chains[i * 17 + 16];
    EXPECT_EQ(a.lift, b.lift);
    EXPECT_EQ(a.length, b.length);
    EXPECT_NEAR(glm::length(a.rest.offset[2] - b.rest.offset[2]), 0.0, 1e-6);
  }
}

}  // namespace
}  // namespace pelt::test
