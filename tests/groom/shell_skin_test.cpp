// The baking of a layer of shells.
#include "core/groom/shell_skin.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "core/groom/groom_file.hpp"
#include "tests/error_from.hpp"
#include "tests/groom/groom_validator.hpp"
#include "tests/groom/torus_character.hpp"

namespace pelt::test {
namespace {

LayerSetup MakeShells() {
  LayerSetup layer;
  layer.name = "shells";
  layer.params.output = Output::kShells;
  layer.length = Attribute(0.02f);
  layer.base_colour = 0xff102030u;
  layer.tip_colour = 0xff405060u;
  return layer;
}

// Calls visit(patch, vertex in it) for each vertex of each patch.
template <class Visit>
void ForEachVertex(const Groom& groom, Visit visit) {
  for (size_t p = 0; p < groom.mesh.size(); ++p)
    for (uint32_t v = 0; v < groom.mesh[p].vertex_count; ++v) visit(p, v);
}

glm::vec3 PositionOf(const Groom& groom, size_t patch, uint32_t v) {
  const auto& p = groom.mesh[patch].position;
  return {p[0][v], p[1][v], p[2][v]};
}

TEST(ShellSkin, HasEveryTriangleOnceWithItsCorners) {
  const Groom groom = BakeTorus(MakeShells());
  ExpectValidGroom(groom);
  const Character torus = MakeTorus();
  EXPECT_EQ(groom.layers[0].strand_count, torus.mesh.triangles.size());
  EXPECT_TRUE(groom.strand_rest4.empty());
  EXPECT_TRUE(groom.strand_rest5.empty());
  std::multiset<std::array<float, 6>> wanted, found;  // texture coordinates tell vertices apart
  for (const auto& t : torus.mesh.triangles) {
    std::array<float, 6> corners;
    for (size_t k = 0; k < 3; ++k)
      for (int i = 0; i < 2; ++i) corners[2 * k + size_t(i)] = torus.mesh.uv[t[k]][i];
    wanted.insert(corners);
  }
  for (size_t c = 0; c < groom.strands.size(); ++c)
    for (uint32_t t = 0; t < groom.strands[c].strand_count; ++t) {
      std::array<float, 6> corners;
      for (size_t k = 0; k < 3; ++k) {
        const auto [patch, lane] =
            FindCorner(groom, groom.layers[0], c, groom.strands[c].vertex[k][t]);
        for (size_t i = 0; i < 2; ++i) corners[2 * k + i] = groom.shell_skin[patch].uv[lane][i];
      }
      found.insert(corners);
    }
  EXPECT_EQ(found, wanted);
}

// At the vertex itself, not a mean of its neighbourhood: a map is as fine as the mesh.
TEST(ShellSkin, GroomsEachVertexByItsOwnPlace) {
  LayerSetup layer = MakeShells();
  layer.length.map = MakeMap([](float u, float) { return 0.25f + 0.75f * u; });
  layer.elevation = Attribute(90.0f);
  const Groom groom = BakeTorus(layer);
  ForEachVertex(groom, [&](size_t p, uint32_t v) {
    const float u = groom.shell_skin[p].uv[v][0];
    if (u < 0.05f || u > 0.95f) return;  // a map repeats, and is smooth across its edge
    const float length = 3.0f * groom.vertex_rest[p].segment_length[v];
    ASSERT_NEAR(length, 0.02f * (0.25f + 0.75f * u), 1e-4f) << u;
    ASSERT_NEAR(groom.vertex_rest[p].offset[2][2][v], length, 1e-5f) << "it stands up";
  });
}

TEST(ShellSkin, VerticesOfASeamHaveOneChain) {
  LayerSetup layer = MakeShells();
  layer.length.randomise = 0.5f;
  layer.frizz = Attribute(20.0f);
  const Groom groom = BakeTorus(layer);
  std::map<std::array<float, 3>, float> length;
  uint32_t shared = 0;
  std::set<float> lengths;
  ForEachVertex(groom, [&](size_t p, uint32_t v) {
    const glm::vec3 at = PositionOf(groom, p, v);
    const auto [place, fresh] =
        length.emplace(std::array{at.x, at.y, at.z}, groom.vertex_rest[p].segment_length[v]);
    EXPECT_EQ(place->second, groom.vertex_rest[p].segment_length[v]);
    shared += !fresh;
    lengths.insert(place->second);
  });
  const TorusOptions torus;  // each vertex once, and those of both seams at one place
  EXPECT_EQ(shared, torus.around + torus.across + 1);
  EXPECT_GT(lengths.size(), length.size() / 2) << "each vertex has a length of its own";
}

TEST(ShellSkin, StencilIsWhatTheMasksLeave) {
  LayerSetup layer = MakeShells();
  layer.mask.uv = MakeMap([](float, float v) { return v < 0.5f ? v : 0.0f; });
  const Groom groom = BakeTorus(layer);
  ExpectValidGroom(groom);
  EXPECT_LT(groom.layers[0].strand_count, MakeTorus().mesh.triangles.size());
  ForEachVertex(groom, [&](size_t p, uint32_t v) {
    const float at = groom.shell_skin[p].uv[v][1];
    const uint32_t colour = groom.shell_skin[p].base_colour[v];
    EXPECT_EQ(colour & 0xffffffu, 0x102030u);
    EXPECT_EQ(groom.shell_skin[p].tip_colour[v] & 0xffffffu, 0x405060u);
    const float stencil = float(colour >> 24) / 255.0f;
    if (at > 0.05f && at < 0.45f) {
      EXPECT_NEAR(stencil, at, 0.01f);
    } else if (at > 0.55f && at < 0.95f) {
      EXPECT_EQ(stencil, 0.0f);
    }
  });
}

TEST(ShellSkin, AMaterialAloneIsTakenWhole) {
  LayerSetup layer = MakeShells();
  layer.mask.materials = {"front"};
  const Groom groom = BakeTorus(layer);
  EXPECT_EQ(groom.layers[0].strand_count, MakeTorus().mesh.triangles.size() / 2);
  ForEachVertex(groom, [&](size_t p, uint32_t v) {
    EXPECT_EQ(groom.shell_skin[p].base_colour[v] >> 24, 255u);
  });
}

TEST(ShellSkin, SaysWhyItCannotBe) {
  const auto error_of = [](const LayerSetup& layer, const TorusOptions& options) {
    return ErrorFrom([&] { BakeTorus(layer, options); });
  };
  EXPECT_EQ(
      error_of(MakeShells(), {.uvs = false}),
      "torus.toml: layer 'shells': key 'output': shells are cut by a texture, and the mesh has "
      "no texture coordinates");
  LayerSetup bald = MakeShells();
  bald.mask.uv = MakeMap([](float, float) { return 0.0f; });
  EXPECT_EQ(error_of(bald, {}),
            "torus.toml: layer 'shells': key 'mask': no triangle is left: 'mask.uv' alone leaves "
            "nothing of the surface");
}

TEST(ShellSkin, ComesBackFromAGroomFile) {
  const Groom groom = BakeTorus(MakeShells());
  const auto bytes = WriteGroom(groom).OrThrow();
  const Groom back = ReadGroom(bytes, "g.groom").OrThrow();
  EXPECT_EQ(WriteGroom(back).OrThrow(), bytes);
  ASSERT_EQ(back.shell_skin.size(), groom.shell_skin.size());
  EXPECT_EQ(std::memcmp(back.shell_skin.data(), groom.shell_skin.data(),
                        groom.shell_skin.size() * sizeof(ShellSkinBlock)),
            0);
  Groom damaged = groom;
  damaged.shell_skin[1].uv[5][1] = NAN;
  EXPECT_NE(FindGroomFault(damaged, "g").find("section 'shell_skin'"), std::string::npos);
  damaged = groom;
  damaged.shell_skin.pop_back();
  EXPECT_NE(FindGroomFault(damaged, "g").find("where the layers need"), std::string::npos);
}

}  // namespace
}  // namespace pelt::test
