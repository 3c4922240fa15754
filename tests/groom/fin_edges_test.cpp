// Which triangle has the fin on an edge.
#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <map>

#include "core/groom/groom_file.hpp"
#include "core/groom/shell_skin.hpp"
#include "tests/groom/groom_validator.hpp"
#include "tests/groom/torus_character.hpp"

namespace pelt::test {
namespace {

using Place = std::array<float, 3>;
using EdgeCounts = std::map<std::array<Place, 2>, uint32_t>;  // ends in order

std::array<Place, 2> Between(const Place& a, const Place& b) {
  return a < b ? std::array{a, b} : std::array{b, a};
}

LayerSetup MakeFinned() {
  LayerSetup layer;
  layer.name = "shells";
  layer.params.output = Output::kShells;
  layer.params.fins = true;
  layer.length = Attribute(0.02f);
  return layer;
}

// How often each edge of the groom's triangles is owned, by where it is: 0 too.
EdgeCounts CountOwned(const Groom& groom) {
  EdgeCounts counts;
  for (size_t c = 0; c < groom.strands.size(); ++c) {
    const auto place = [&](uint32_t t, uint32_t k) -> Place {
      const auto [patch, lane] =
          FindCorner(groom, groom.layers[0], c, groom.strands[c].vertex[k][t]);
      const auto& p = groom.mesh[patch].position;
      return {p[0][lane], p[1][lane], p[2][lane]};
    };
    for (uint32_t t = 0; t < groom.strands[c].strand_count; ++t)
      for (uint32_t k = 0; k < 3; ++k)
        counts[Between(place(t, k), place(t, (k + 1) % 3))] +=
            (groom.fin_edges[c].owned[t] >> 8 * k & 255u) / 255u;
  }
  return counts;
}

// A torus without a border: three edges for two triangles, over both seams of its texture and the
// borders of its chunks.
TEST(FinEdges, HaveOneOwner) {
  const Groom groom = BakeTorus(MakeFinned());
  ExpectValidGroom(groom);
  ASSERT_GT(groom.strands.size(), 4u);
  const EdgeCounts counts = CountOwned(groom);
  EXPECT_EQ(counts.size(), MakeTorus().mesh.triangles.size() * 3 / 2);
  for (const auto& [edge, owners] : counts) EXPECT_EQ(owners, 1u);
}

// Where the fur ends its edges have the one triangle that there is.
TEST(FinEdges, AreOwnedWhereTheFurEnds) {
  LayerSetup layer = MakeFinned();
  layer.mask.materials = {"front"};
  const Groom groom = BakeTorus(layer);
  const EdgeCounts counts = CountOwned(groom);
  // Half a torus has two rings of edges more than half of the edges.
  const TorusOptions torus;
  EXPECT_EQ(counts.size(), groom.layers[0].strand_count * 3 / 2 + torus.across);
  for (const auto& [edge, owners] : counts) EXPECT_EQ(owners, 1u);
}

TEST(FinEdges, OfATriangleThatIsNoneAreNobodys) {
  Mesh mesh;
  mesh.position.resize(4);
  mesh.triangles = {{0, 1, 1}, {2, 1, 0}, {3, 1, 2}};
  // Vertex 3 is vertex 0 with other texture coordinates.
  const std::vector<uint32_t> duplicates = {0, 1, 2, 0};
  std::vector<ScatterPoint> points(3);
  for (uint32_t t = 0; t < 3; ++t) points[t].place.triangle = t;
  EXPECT_EQ(FindFinEdges(mesh, duplicates, points),
            (std::vector<uint32_t>{0x0000ffu, 0xff00ffu, 0u}));
  // Of what grows alone.
  EXPECT_EQ(FindFinEdges(mesh, duplicates, std::span(points).subspan(2)),
            (std::vector<uint32_t>{0xffffffu}));
}

TEST(FinEdges, ComeBackFromAGroomFile) {
  const Groom groom = BakeTorus(MakeFinned());
  const auto bytes = WriteGroom(groom).OrThrow();
  const Groom back = ReadGroom(bytes, "g.groom").OrThrow();
  EXPECT_TRUE(back.layers[0].params.fins);
  ASSERT_EQ(back.fin_edges.size(), groom.fin_edges.size());
  EXPECT_EQ(std::memcmp(back.fin_edges.data(), groom.fin_edges.data(),
                        groom.fin_edges.size() * sizeof(FinEdgeBlock)),
            0);
}

TEST(FinEdges, ThatCannotBeAreRefused) {
  const Groom groom = BakeTorus(MakeFinned(), {.around = 47});  // with a chunk that is not full
  const auto fault_of = [&](auto spoil) {
    Groom damaged = groom;
    spoil(damaged);
    return FindGroomFault(damaged, "g");
  };
  EXPECT_EQ(fault_of([](Groom&) {}), "");
  for (const uint32_t owned : {1u, 0x80u, 0xff000000u, 0xff01u})
    EXPECT_NE(fault_of([&](Groom& g) {
                g.fin_edges[1].owned[3] = owned;
              }).find("three bytes of 0 or 255"),
              std::string::npos)
        << owned;
  EXPECT_NE(fault_of([](Groom& g) {
              for (size_t c = 0; c < g.strands.size(); ++c)
                if (const uint32_t count = g.strands[c].strand_count; count < kStrandsPerChunk)
                  g.fin_edges[c].owned[count] = 255;
            }).find("no triangle has these edges"),
            std::string::npos);
  EXPECT_NE(fault_of([](Groom& g) { g.fin_edges.pop_back(); }).find("where the layers need"),
            std::string::npos);
}

TEST(FinEdges, AreOfShellsAlone) {
  LayerParams params;
  params.fins = true;
  EXPECT_NE(FindBadParam(params).find("fins: they stand between shells"), std::string::npos);
  params.output = Output::kShells;
  EXPECT_EQ(FindBadParam(params), "");
  LayerSetup plain = MakeFinned();
  plain.params.fins = false;
  EXPECT_TRUE(BakeTorus(plain).fin_edges.empty());
}

}  // namespace
}  // namespace pelt::test
