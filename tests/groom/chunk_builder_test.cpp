// Patches and chunks: every limit, every promise of chunk.hpp, full chunks, equal borders.
#include "core/groom/chunk_builder.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/groom/bake.hpp"
#include "core/random.hpp"
#include "tests/groom/groom_validator.hpp"
#include "tests/groom/torus_character.hpp"

namespace pelt {
namespace {

// A sheet of quads whose vertices follow `joints_of(vertex)`.
template <class F>
Mesh MakeSheet(uint32_t side, F joints_of) {
  Mesh mesh;
  for (uint32_t v = 0; v < side * side; ++v) {
    mesh.position.push_back({float(v % side), 0.0f, float(v / side)});
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

void ExpectPatches(const Mesh& mesh, std::span<const PatchStrand> strands,
                   std::span<const Patch> patches, const PatchLimits& limits) {
  std::set<uint32_t> seen;
  for (const Patch& patch : patches) {
    ASSERT_FALSE(patch.strands.empty());
    ASSERT_LE(patch.strands.size(), limits.strands);
    ASSERT_LE(patch.vertices.size(), limits.vertices);
    ASSERT_TRUE(std::is_sorted(patch.strands.begin(), patch.strands.end()));
    std::set<uint32_t> used;
    for (const uint32_t s : patch.strands) {
      ASSERT_TRUE(seen.insert(s).second) << "strand " << s << " twice";
      used.insert(strands[s].vertices.begin(), strands[s].vertices.end());
    }
    ASSERT_EQ(used, std::set<uint32_t>(patch.vertices.begin(), patch.vertices.end()));
    ASSERT_EQ(used.size(), patch.vertices.size());
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
    ASSERT_LE(rows, limits.rows);
  }
  ASSERT_EQ(seen.size(), strands.size());
}

TEST(CutPatches, DenseLayersFillEveryChunkButTheLast) {
  const Mesh mesh = MakeSheet(10, OneSet);
  for (const uint32_t count : {1u, 127u, 128u, 129u, 5000u, 12345u}) {
    const auto strands = SpreadOver(mesh, count, 1);
    const auto patches = CutPatches(mesh, strands);
    ExpectPatches(mesh, strands, patches, {});
    EXPECT_EQ(patches.size(), (count + kStrandsPerChunk - 1) / kStrandsPerChunk);
  }
}

TEST(CutPatches, SparseLayersFillTheirVertices) {
  const Mesh mesh = MakeSheet(120, OneSet);
  const auto strands = SpreadOver(mesh, 6000, 2);
  const auto patches = CutPatches(mesh, strands);
  ExpectPatches(mesh, strands, patches, {});
  size_t vertices = 0;
  for (const Patch& patch : patches) vertices += patch.vertices.size();
  EXPECT_GT(double(vertices) / double(patches.size() * kVerticesPerChunk), 0.95);
}

TEST(CutPatches, KeepsToEveryLimit) {
  Random random(3);
  const Mesh mesh = MakeSheet(40, [&](uint32_t) {
    std::array<uint8_t, 4> joints;
    for (size_t i = 0; i < 4; ++i) joints[i] = uint8_t(4 * random.Below(64) + uint32_t(i));
    return joints;
  });
  const auto strands = SpreadOver(mesh, 3000, 4);
  for (const PatchLimits& limits :
       {PatchLimits{}, PatchLimits{32, 128, 64}, PatchLimits{128, 20, 64}, PatchLimits{128, 3, 12},
        PatchLimits{1, 128, 64}}) {
    ExpectPatches(mesh, strands, CutPatches(mesh, strands, limits), limits);
  }
}

TEST(CutPatches, PatchesAreCompact) {
  const Mesh mesh = MakeSheet(33, OneSet);
  const auto strands = SpreadOver(mesh, 64 * kStrandsPerChunk, 5);
  double extent = 0.0;
  const auto patches = CutPatches(mesh, strands);
  for (const Patch& patch : patches) {
    glm::vec3 low(1e9f), high(-1e9f);
    for (const uint32_t s : patch.strands) {
      low = glm::min(low, strands[s].position);
      high = glm::max(high, strands[s].position);
    }
    extent += double(std::max(high.x - low.x, high.z - low.z));
  }
  // 64 square patches of a 32 x 32 sheet would have a side of 4.
  EXPECT_LT(extent / double(patches.size()), 5.0);
}

TEST(CutPatches, TrianglesStayWhole) {
  const Mesh mesh = MakeSheet(33, OneSet);
  const auto strands = SpreadOver(mesh, 64 * kStrandsPerChunk, 10);
  const auto patches = CutPatches(mesh, strands);
  std::map<std::array<uint32_t, 3>, std::set<const Patch*>> patches_of;
  size_t copies = 0;
  for (const Patch& patch : patches) {
    copies += patch.vertices.size();
    for (const uint32_t s : patch.strands) patches_of[strands[s].vertices].insert(&patch);
  }
  size_t cut = 0;
  for (const auto& [triangle, of] : patches_of) cut += of.size() - 1;
  // A halving cuts one triangle at most; 64 squares of 4 have 25 vertices each.
  EXPECT_LE(cut, patches.size() - 1);
  EXPECT_LT(double(copies) / double(patches.size()), 30.0);
}

TEST(CutPatches, TwoSidesOfAThinSheetPart) {
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
  const auto patches = CutPatches(mesh, strands);
  for (const Patch& patch : patches) {
    uint32_t above = 0;
    for (const uint32_t s : patch.strands) above += strands[s].normal.y > 0.0f;
    mixed += above > 0 && above < patch.strands.size();
  }
  EXPECT_LE(mixed, patches.size() / 4);
}

TEST(CutPatches, APrefixOfStrandsUsesAPrefixOfVertices) {
  const Mesh mesh = MakeSheet(40, OneSet);
  const auto strands = SpreadOver(mesh, 4000, 7);
  for (const Patch& patch : CutPatches(mesh, strands)) {
    const size_t n = patch.strands.size();
    for (const size_t part : {(n + 7) / 8, (n + 3) / 4, (n + 1) / 2}) {
      std::set<uint32_t> used;
      for (size_t i = 0; i < part; ++i) {
        used.insert(strands[patch.strands[i]].vertices.begin(),
                    strands[patch.strands[i]].vertices.end());
      }
      const std::set<uint32_t> prefix(patch.vertices.begin(),
                                      patch.vertices.begin() + long(used.size()));
      ASSERT_EQ(used, prefix);
    }
  }
}

TEST(CutPatches, GroupsShareJoints) {
  // Eight joint sets of four joints, scattered over the vertices: sorted, 16 vertices need half
  // of the sets; as they come they would need 28 of the 32 joints.
  Random random(8);
  const Mesh mesh = MakeSheet(40, [&](uint32_t) {
    const uint8_t set = uint8_t(4 * random.Below(8));
    return std::array<uint8_t, 4>{set, uint8_t(set + 1), uint8_t(set + 2), uint8_t(set + 3)};
  });
  const auto strands = SpreadOver(mesh, 4000, 9);
  size_t rows = 0, groups = 0;
  PatchLimits limits;
  limits.rows = 1000;
  for (const Patch& patch : CutPatches(mesh, strands, limits)) {
    for (const VertexGroup& group : patch.groups) rows += group.joints.size();
    groups += patch.groups.size();
  }
  EXPECT_LT(double(rows) / double(groups), 22.0);
}

Groom BakeTorus(const LayerSetup& layer, const test::TorusOptions& options = {}) {
  const Character character = test::MakeTorus(options);
  const RestGeometry rest = ComputeRestGeometry(character, 1.0f / options.scale);
  FurSetup setup;
  setup.layers = {layer};
  return BakeGroom(character, rest, setup, 1.0f / options.scale);
}

LayerSetup MakeLayer(float density) {
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
    LayerSetup layer = MakeLayer(density);
    test::ExpectValidGroom(BakeTorus(layer));
    layer.params.chain = ChainKind::kStrand;
    test::ExpectValidGroom(BakeTorus(layer));
    layer.params.points = 5;
    layer.offset = Attribute(0.01f);
    test::ExpectValidGroom(BakeTorus(layer));
  }
}

TEST(Chunks, BordersAreSharedAndEqual) {
  const Groom groom = BakeTorus(MakeLayer(20000.0f));
  EXPECT_GT(test::ExpectBordersAgree(groom, groom.layers[0], 0), 200u);
}

TEST(Chunks, DenseLayersAreFull) {
  const Groom groom = BakeTorus(MakeLayer(40000.0f));
  const double lanes = double(groom.strands.size()) * kStrandsPerChunk;
  EXPECT_GT(double(groom.layers[0].strand_count) / lanes, 0.95);
}

TEST(Chunks, ClumpControlsAreRoundedUpAndFewerThanAll) {
  LayerSetup layer = MakeLayer(40000.0f);
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

// A torus' UVs are its two angles. Between 0 and 1 all the same where a texture repeats.
TEST(Chunks, StrandsKnowWhereOnTheTextureTheyStand) {
  const Groom groom = BakeTorus(MakeLayer(20000.0f));
  ASSERT_EQ(groom.strand_uv.size(), groom.strands.size());
  const auto apart = [](double a, double b) { return std::abs(std::remainder(a - b, 1.0)); };
  for (size_t c = 0; c < groom.strands.size(); ++c) {
    const StrandBlock& block = groom.strands[c];
    for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) {
      double p[3] = {};
      for (int k = 0; k < 3; ++k)
        for (int axis = 0; axis < 3; ++axis)
          p[axis] += double(block.bary[k][lane]) *
                     double(groom.mesh[c].position[axis][block.vertex[k][lane]]);
      const double turn = 2.0 * exact::kPi, ring = std::hypot(p[0], p[2]) - 0.3;
      const uint32_t uv = groom.strand_uv[c].uv[lane];
      ASSERT_LT(apart((uv & 0xffffu) / 65535.0, std::atan2(p[2], p[0]) / turn), 0.004);
      ASSERT_LT(apart((uv >> 16) / 65535.0, std::atan2(p[1], ring) / turn), 0.01);
    }
  }
  for (const StrandUvBlock& block : BakeTorus(MakeLayer(2000.0f), {.uvs = false}).strand_uv)
    for (const uint32_t uv : block.uv) ASSERT_EQ(uv, 0u);
}

TEST(Chunks, ControlsAreTheNearest) {
  const Groom groom = BakeTorus(MakeLayer(40000.0f));
  const StrandBlock& block = groom.strands[3];
  const MeshBlock& mesh = groom.mesh[3];
  auto root = [&](uint32_t lane) {
    glm::dvec3 p(0.0);
    for (int k = 0; k < 3; ++k) {
      for (int axis = 0; axis < 3; ++axis) {
        p[axis] += double(block.bary[k][lane]) * mesh.position[axis][block.vertex[k][lane]];
      }
    }
    return p;
  };
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
  LayerSetup layer = MakeLayer(4000.0f);
  const test::TorusOptions centimetres{.scale = 100.0f};
  const Groom flat = BakeTorus(layer, centimetres);
  layer.offset = Attribute(0.005f);
  const Groom raised = BakeTorus(layer, centimetres);
  ASSERT_EQ(flat.mesh.size(), raised.mesh.size());
  for (size_t c = 0; c < flat.mesh.size(); ++c) {
    for (uint32_t v = 0; v < flat.mesh[c].vertex_count; ++v) {
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(raised.mesh[c].position[axis][v] - flat.mesh[c].position[axis][v],
                    0.5f * flat.mesh[c].normal[axis][v], 2e-5f);
      }
    }
  }
}

// The slow, obvious reference of a vertex chain: the weighted mean over all strands of the layer.
TEST(VertexChains, AreTheMeanOfTheLayersStrandsRemadeWithEqualSegments) {
  const Character character = test::MakeTorus();
  const Mesh& mesh = character.mesh;
  const RestGeometry rest = ComputeRestGeometry(character, 1.0f);
  const FurSetup setup;
  const LayerSetup layer = MakeLayer(4000.0f);
  const AttributeMaker maker(character, rest, setup, layer);
  const auto points =
      ScatterLayer(character, rest, setup, layer, Growth(character, rest, setup, layer));
  std::vector<GroomedStrand> strands;
  for (uint32_t i = 0; i < points.size(); ++i) strands.push_back(maker.Groom(points[i], i));
  const auto duplicates = FindSeamDuplicates(mesh);
  const VertexChains chains(mesh, rest, duplicates, maker, strands);
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
  const Character character = test::MakeTorus();  // first and last column lie on each other
  const Mesh& mesh = character.mesh;
  const auto duplicates = FindSeamDuplicates(mesh);
  EXPECT_EQ(duplicates[0], 0u);
  EXPECT_EQ(duplicates[16], 0u);  // once around the tube
  EXPECT_EQ(duplicates[17], 17u);
  const RestGeometry rest = ComputeRestGeometry(character, 1.0f);
  LayerSetup layer = MakeLayer(20000.0f);
  layer.offset = Attribute(0.01f);
  layer.offset.randomise = 0.5f;
  const AttributeMaker maker(character, rest, {}, layer);
  const auto points = ScatterLayer(character, rest, {}, layer, Growth(character, rest, {}, layer));
  std::vector<GroomedStrand> strands;
  for (uint32_t i = 0; i < points.size(); ++i) strands.push_back(maker.Groom(points[i], i));
  const VertexChains chains(mesh, rest, duplicates, maker, strands);
  for (uint32_t i = 0; i <= 48; ++i) {
    const VertexChain &a = chains[i * 17], &b = chains[i * 17 + 16];
    EXPECT_EQ(a.lift, b.lift);
    EXPECT_EQ(a.length, b.length);
    EXPECT_NEAR(glm::length(a.rest.offset[2] - b.rest.offset[2]), 0.0, 1e-6);
  }
}

}  // namespace
}  // namespace pelt
