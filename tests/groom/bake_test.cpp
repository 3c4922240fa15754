// The whole bake: the same bits twice and everywhere, layers on a real character, errors.
#include "core/groom/bake.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstring>

#include "core/character/builtin_character.hpp"
#include "core/error.hpp"
#include "core/groom/groom_file.hpp"
#include "core/groom/growth.hpp"
#include "core/random.hpp"
#include "tests/error_from.hpp"
#include "tests/groom/groom_validator.hpp"
#include "tests/groom/torus_character.hpp"

namespace pelt::test {
namespace {

struct Hash {
  uint64_t value = 0;
  template <class T>
  void Add(const std::vector<T>& blocks) {
    for (const T& block : blocks) {
      uint32_t words[sizeof(T) / 4];
      std::memcpy(words, &block, sizeof(T));
      for (const uint32_t word : words) value = MixBits(value ^ word);
    }
  }
};

uint64_t HashGroom(const Groom& groom) {
  Hash hash;
  hash.Add(groom.layer_joints);
  hash.Add(groom.mesh);
  hash.Add(groom.strands);
  hash.Add(groom.halo);
  hash.Add(groom.vertex_rest);
  hash.Add(groom.strand_rest4);
  hash.Add(groom.strand_rest5);
  return hash.value;
}

// Every feature that computes something, on a small mesh.
FurSetup MakeTinySetup() {
  FurSetup setup;
  setup.path = "tiny.toml";
  LayerSetup coat;
  coat.name = "coat";
  coat.density = 1500.0f;
  coat.density_randomise = 0.3f;
  coat.density_map = MakeMap([](float u, float v) { return 0.5f + 0.5f * u * v; });
  coat.length.randomise = 0.4f;
  coat.width.randomise = 0.4f;
  coat.azimuth = Attribute(30.0f);
  coat.azimuth.randomise = 1.0f;
  coat.direction = Attribute(15.0f);
  coat.curl = Attribute(700.0f);
  coat.twist = Attribute(300.0f);
  coat.frizz = Attribute(20.0f);
  coat.offset = Attribute(0.002f);
  coat.strength.randomise = 0.3f;
  coat.colour_variation = Attribute(0.2f);
  coat.film_strip_count = 5;
  coat.comb = {{{0.4f, 0.0f, 0.0f}, {0.0f, 1.0f, 0.2f}, 0.15f},
               {{-0.3f, 0.1f, 0.1f}, {1.0f, 0.0f, 0.0f}, 0.2f}};
  coat.comb_joint = "ring_1";
  LayerSetup ruff;
  ruff.name = "ruff";
  ruff.seed = 2;
  ruff.density = 900.0f;
  ruff.params.chain = ChainKind::kStrand;
  ruff.params.points = 5;
  ruff.mask.joints = {{"ring_5", false, 0.2f, 0.8f}};
  ruff.max_strands = 100;
  setup.layers = {coat, ruff};
  return setup;
}

Character MakeTinyTorus() { return MakeTorus({.around = 24, .across = 8}); }

Groom BakeTiny(const FurSetup& setup = MakeTinySetup(),
               const Character& character = MakeTinyTorus()) {
  return BakeGroom(character, ComputeRestGeometry(character, 1.0f), setup, 1.0f);
}

// A torus whose tube is 0.63 m round and whose ring is 1.3 to 2.5 m, both 1 of UV.
TEST(Bake, UnevenUvsBelowMapsAreNoted) {
  const Character torus = MakeTorus();
  const RestGeometry rest = ComputeRestGeometry(torus, 1.0f);
  const auto scale = MeasureUvScale(torus.mesh, rest);
  ASSERT_TRUE(scale);
  EXPECT_NEAR(scale->finest, std::sqrt(0.63 * 1.3), 0.05);
  EXPECT_NEAR(scale->coarsest, std::sqrt(0.63 * 2.5), 0.05);
  const auto notes = [&](const Character& character) {
    std::vector<std::string> said;
    BakeGroom(character, rest, MakeTinySetup(), 1.0f, nullptr, nullptr, nullptr, &said);
    return said;
  };
  EXPECT_TRUE(notes(torus).empty());
  Character uneven = torus;
  for (size_t v = 0; v < uneven.mesh.uv.size(); ++v)
    if (uneven.mesh.position[v].z > 0.0f) uneven.mesh.uv[v] *= 0.1f;
  const auto said = notes(uneven);
  ASSERT_EQ(said.size(), 1u);
  EXPECT_NE(said[0].find("Maps are "), std::string::npos) << said[0];
  uneven.mesh.uv.clear();
  EXPECT_FALSE(MeasureUvScale(uneven.mesh, rest));
}

TEST(Bake, IsValidAndAcceptedByTheGroomFile) {
  const Groom groom = BakeTiny();
  ExpectValidGroom(groom);
  EXPECT_EQ(FindGroomFault(groom, "tiny"), "");
  ASSERT_EQ(groom.layers.size(), 2u);
  EXPECT_EQ(groom.layers[0].name, "coat");
  EXPECT_EQ(groom.layers[1].name, "ruff");
  EXPECT_LE(groom.layers[1].strand_count, 100u);
  EXPECT_EQ(groom.joint_count, 9u);
  EXPECT_EQ(groom.joint_names[1], "ring_0");
  EXPECT_EQ(groom.skeleton.parent[3], 2);
}

TEST(Bake, GivesTheSameBitsTwiceAndOnEveryCompiler) {
  const uint64_t hash = HashGroom(BakeTiny());
  EXPECT_EQ(hash, HashGroom(BakeTiny()));
  if (std::endian::native != std::endian::little || kStrandsPerChunk != 128) {
    GTEST_SKIP() << "the pinned digest is of little-endian blocks of 128 strands";
  }
  // Changes only when what a bake makes changes; then all grooms must be baked again.
  EXPECT_EQ(hash, 0x8cab80d508cf0a48ull) << std::hex << hash;
}

TEST(Bake, AnotherSeedGivesAnotherGroom) {
  FurSetup setup = MakeTinySetup();
  setup.layers[0].seed = 99;
  EXPECT_NE(HashGroom(BakeTiny(setup)), HashGroom(BakeTiny()));
}

// Each triangle with vertices and the normal of its own.
Character MakeFaceted() {
  Character character = MakeTinyTorus();
  const Mesh round = character.mesh;
  Mesh& mesh = character.mesh;
  for (auto* rows : {&mesh.position, &mesh.normal}) rows->clear();
  mesh.tangent.clear();
  mesh.uv.clear();
  mesh.joints.clear();
  mesh.weights.clear();
  for (auto& triangle : mesh.triangles)
    for (uint32_t& corner : triangle) {
      mesh.position.push_back(round.position[corner]);
      mesh.tangent.push_back(round.tangent[corner]);
      if (!round.uv.empty()) mesh.uv.push_back(round.uv[corner]);
      mesh.joints.push_back(round.joints[corner]);
      mesh.weights.push_back(round.weights[corner]);
      mesh.normal.emplace_back();
    }
  uint32_t next = 0;
  for (auto& triangle : mesh.triangles) {
    for (uint32_t& corner : triangle) corner = next++;
    const glm::vec3 a = mesh.position[triangle[0]], b = mesh.position[triangle[1]],
                    c = mesh.position[triangle[2]];
    for (const uint32_t corner : triangle)
      mesh.normal[corner] = glm::normalize(glm::cross(b - a, c - a));
  }
  return character;
}

// The cosine of the widest angle between normals of a patch at one place.
float LeastAlike(const Character& character, float crease_angle) {
  FurSetup setup = MakeTinySetup();
  setup.crease_angle = crease_angle;
  float least = 1.0f;
  for (const MeshBlock& mesh : BakeTiny(setup, character).mesh)
    for (uint32_t a = 0; a < kVerticesPerChunk; ++a)
      for (uint32_t b = 0; b < a; ++b) {
        float apart = 0.0f, alike = 0.0f;
        for (int c = 0; c < 3; ++c) {
          apart += std::abs(mesh.position[c][a] - mesh.position[c][b]);
          alike += mesh.normal[c][a] * mesh.normal[c][b];
        }
        if (apart == 0.0f) least = std::min(least, alike);
      }
  return least;
}

TEST(Bake, ACoatDoesNotPartWhereTheMeshHasHardEdges) {
  const Character faceted = MakeFaceted();
  EXPECT_LT(LeastAlike(faceted, 0.0f), 0.8f);  // facets some 45 degrees apart
  EXPECT_GT(LeastAlike(faceted, 120.0f), 0.999f);
}

TEST(Bake, WhereNoEdgeIsHardACreaseAngleChangesNothing) {
  FurSetup setup = MakeTinySetup();
  setup.crease_angle = 120.0f;
  EXPECT_EQ(BakeTiny(setup).strands.size(), BakeTiny().strands.size());
}

TEST(Bake, LayersDoNotInfluenceEachOther) {
  FurSetup setup = MakeTinySetup();
  const Groom both = BakeTiny(setup);
  setup.layers.erase(setup.layers.begin());
  const Groom alone = BakeTiny(setup);
  ASSERT_EQ(alone.strands.size(), both.layers[1].chunk_count);
  for (size_t c = 0; c < alone.strands.size(); ++c) {
    EXPECT_EQ(0, std::memcmp(&alone.strands[c], &both.strands[both.layers[1].first_chunk + c],
                             sizeof(StrandBlock)));
    EXPECT_EQ(0, std::memcmp(&alone.halo[c], &both.halo[both.layers[1].first_chunk + c],
                             sizeof(HaloBlock)));
  }
  ASSERT_EQ(alone.mesh.size(), both.layers[1].patch_count);
  for (size_t p = 0; p < alone.mesh.size(); ++p)
    EXPECT_EQ(0, std::memcmp(&alone.mesh[p], &both.mesh[both.layers[1].first_patch + p],
                             sizeof(MeshBlock)));
}

TEST(Bake, ASegmentLengthIsThatOfTheChainsAlone) {
  FurSetup setup = MakeTinySetup();
  const Groom usual = BakeTiny(setup);
  setup.layers[0].segment_length = 0.05f;
  const Groom own = BakeTiny(setup);
  for (uint32_t p = 0; p < own.layers[0].patch_count; ++p)
    for (uint32_t v = 0; v < own.mesh[p].vertex_count; ++v) {
      const RestBlock<4>&rest = own.vertex_rest[p], &was = usual.vertex_rest[p];
      ASSERT_FLOAT_EQ(rest.segment_length[v], 0.05f);
      for (int i = 0; i < 3; ++i)
        for (int axis = 0; axis < 3; ++axis)
          ASSERT_NEAR(rest.offset[i][axis][v],
                      was.offset[i][axis][v] * 0.05f / was.segment_length[v], 1e-6f);
    }
  for (size_t c = 0; c < own.strand_rest4.size(); ++c)
    EXPECT_EQ(0, std::memcmp(&own.strand_rest4[c], &usual.strand_rest4[c], sizeof(RestBlock<4>)));
  EXPECT_FLOAT_EQ(own.layers[0].length_max, 0.15f);
  EXPECT_EQ(own.layers[1].length_max, usual.layers[1].length_max);
  EXPECT_EQ(FindGroomFault(own, "own"), "");
}

// Every other vertex of the torus along both of its circles is one of a coarser torus.
TEST(Bake, ChainsOfACoarserMeshAreSimulatedFirst) {
  FurSetup setup = MakeTinySetup();
  setup.chain_mesh = std::make_shared<const Character>(MakeTorus({.around = 12, .across = 4}));
  const Character torus = MakeTinyTorus();
  std::vector<LayerDensity> densities;
  const Groom groom =
      BakeGroom(torus, ComputeRestGeometry(torus, 1.0f), setup, 1.0f, nullptr, nullptr, &densities);
  ExpectValidGroom(groom);
  const GroomLayer& coat = groom.layers[0];
  const auto is_even = [](double turns, uint32_t steps) {
    const auto step = std::lround(turns * steps);
    EXPECT_NEAR(turns * steps, double(step), 1e-3);
    return step % 2 == 0;
  };
  uint32_t level = kChainLevels - 1, all = 0, marked = 0;
  for (uint32_t p = 0; p < coat.patch_count; ++p) {
    const MeshBlock& mesh = groom.mesh[p];
    std::vector<uint32_t> before = {0};  // of the lanes in front of each
    for (uint32_t v = 0; v < mesh.vertex_count; ++v) {
      const double x = mesh.position[0][v], y = mesh.position[1][v], z = mesh.position[2][v];
      const double turn = 2.0 * exact::kPi;
      const bool of_ring = is_even(std::atan2(z, x) / turn, 24);
      const bool of_tube = is_even(std::atan2(y, std::hypot(x, z) - 0.3) / turn, 8);
      before.push_back(before.back() + (of_ring && of_tube));
    }
    const uint32_t count = before.back();
    for (uint32_t l = 0; l < kChainLevels; ++l) {
      const uint32_t kept = CountChains(mesh.vertex_count, l);
      EXPECT_EQ(before[kept], std::min(kept, count)) << p << ", level " << l;
    }
    while (CountChains(mesh.vertex_count, level) < count) --level;
    all += mesh.vertex_count;
    marked += count;
  }
  EXPECT_GT(marked, 40u);
  EXPECT_EQ(coat.params.chain_share, 1.0f / float(1u << level));
  EXPECT_LT(coat.params.chain_share, 1.0f);
  EXPECT_EQ(groom.layers[1].params.chain_share, 1.0f) << "it has a chain for each strand";
  const LayerChains& chains = densities[0].chains;
  EXPECT_EQ(chains.all, all);
  EXPECT_EQ(chains.of_mesh, marked);
  EXPECT_LT(chains.simulated, all);
  EXPECT_GE(chains.simulated, marked);
  EXPECT_GT(chains.mean_m, 0.0);
  EXPECT_GE(chains.p95_m, chains.mean_m);
  EXPECT_LT(chains.p95_m, 0.2);  // the torus is 0.2 m thick
  EXPECT_EQ(densities[1].chains.all, 0u);

  setup.layers[0].params.chain_share = 0.125f;  // of those that are asked for, as many as fit
  EXPECT_EQ(BakeTiny(setup).layers[0].params.chain_share, 0.125f);
  setup.chain_mesh =
      std::make_shared<const Character>(MakeTorus({.around = 12, .across = 4, .scale = 3.0f}));
  const std::string error = ErrorFrom([&] { BakeTiny(setup); });
  EXPECT_EQ(error.rfind("tiny.toml: key 'chain_mesh': lies up to 0.8 m from the surface", 0), 0u)
      << error;
}

TEST(Bake, TellsProgressAndStats) {
  const Character character = MakeTinyTorus();
  std::vector<std::pair<std::string, float>> reported;
  const BakeProgress progress = [&](std::string_view layer, float share) {
    reported.emplace_back(layer, share);
  };
  ScatterStats stats;
  const Groom groom = BakeGroom(character, ComputeRestGeometry(character, 1.0f), MakeTinySetup(),
                                1.0f, &progress, &stats);
  ASSERT_GE(reported.size(), 3u);
  EXPECT_EQ(reported.front(), (std::pair<std::string, float>("coat", 0.0f)));
  EXPECT_EQ(reported.back(), (std::pair<std::string, float>("ruff", 1.0f)));
  ASSERT_EQ(stats.layers.size(), 2u);
  EXPECT_EQ(stats.layers[1].strand_count, groom.layers[1].strand_count);
  EXPECT_EQ(stats.layers[0].chunk_count, groom.layers[0].chunk_count);
  EXPECT_EQ(stats.layers[0].patch_count, groom.layers[0].patch_count);
  EXPECT_EQ(HashGroom(groom), HashGroom(BakeTiny()));  // looking changes nothing
}

TEST(Bake, GrowsTheBuiltInMonsterByMaterial) {
  const Character character = MakeBuiltinCharacter({});
  FurSetup setup;
  uint32_t seed = 1;
  for (const char* part : {"head", "brow", "body", "arm", "tail"}) {
    LayerSetup layer;
    layer.name = part;
    layer.seed = seed++;
    layer.mask.materials = {part};
    layer.density = 1e4f;
    setup.layers.push_back(layer);
  }
  const Groom groom = BakeTiny(setup, character);
  ExpectValidGroom(groom);
  EXPECT_EQ(FindGroomFault(groom, "monster"), "");
  ASSERT_EQ(groom.layers.size(), 5u);
  for (const GroomLayer& layer : groom.layers) {
    EXPECT_GT(layer.strand_count, 10u) << layer.name;
    SCOPED_TRACE(layer.name);
    ExpectEachVertexOnce(groom, layer, character.mesh);
  }
}

TEST(Bake, RefusesWhatItCannotMake) {
  FurSetup setup;
  setup.path = "empty.toml";
  EXPECT_THROW(BakeTiny(setup), Error);
  setup = MakeTinySetup();
  setup.layers[0].params.points = 5;  // with vertex chains
  EXPECT_THROW(BakeTiny(setup), Error);
  setup = MakeTinySetup();
  setup.layers[1].params.points = 6;
  EXPECT_THROW(BakeTiny(setup), Error);
}

// A byte for each place of a strand, as FrameInput::cut has them.
TEST(Bake, AStencilCutsOffWhatStandsWhereItIsDark) {
  const Groom groom = BakeTiny();
  // Black and white side by side: darker than half left of the middle.
  const ControlMap stencil{2, 1, {0, 255, 0, 255, 255, 0, 255, 255}};
  const std::vector<uint8_t> cut = CutByStencil(groom, stencil),
                             other = CutByStencil(groom, stencil, 1);
  ASSERT_EQ(cut.size(), groom.strands.size() * kStrandsPerChunk);
  size_t left = 0;
  for (size_t place = 0; place < cut.size(); ++place) {
    const uint32_t u =
        groom.strand_uv[place / kStrandsPerChunk].uv[place % kStrandsPerChunk] & 0xffffu;
    if (u < 64 || u > 65472 || (u > 32700 && u < 32830)) continue;
    EXPECT_EQ(cut[place] != 0, u < 32768) << u;
    EXPECT_EQ(other[place] != 0, u > 32768) << u;
    left += u < 32768;
  }
  EXPECT_GT(left, 0u);
  EXPECT_LT(left, cut.size());
}

TEST(Bake, MaxStrandsThatLeavesSkinBareIsAWarning) {
  const auto warn = [](double asked, uint32_t grown, float spacing_m) {
    const LayerDensity layer{"coat", {asked, grown, spacing_m}, 0.05f};
    return WarnOfBaldness({&layer, 1}).size();
  };
  EXPECT_EQ(warn(1000.0, 1000, 0.2f), 0u) << "as sparse as its density asks for";
  EXPECT_EQ(warn(100000.0, 1000, 0.01f), 0u) << "cut, but close enough";
  EXPECT_EQ(warn(1100.0, 900, 0.5f), 0u) << "bare with and without the cut";
  EXPECT_EQ(warn(1e6, 100, 0.3f), 2u) << "the layer, and with it the whole";
  const LayerDensity both[] = {{"bald", {1e6, 100, 0.3f}, 0.05f}, {"coat", {9, 9, 0.01f}, 0.05f}};
  const auto warnings = WarnOfBaldness(both);
  ASSERT_EQ(warnings.size(), 1u);
  for (const char* part : {"layer 'bald'", "100 of the 1000000", "300 mm apart", "50 mm long"})
    EXPECT_NE(warnings[0].find(part), std::string::npos) << warnings[0];
}

}  // namespace
}  // namespace pelt::test
