// Shells whose stencil is a map: where they are cut, texel by texel, by both renderers.
#include <gtest/gtest.h>

#include <cstdio>

#include "tests/picture/bald_scenario.hpp"
#include "tests/picture/gl_pictures.hpp"

namespace pelt::testing {
namespace {

// Short dark fur over skin that shows, unlit, where there is to be none.
const PictureScene& Coat() {
  static const Shown shown(
      BaldScenario("output = 'shells'\nlength = 0.004\nshells = 6\nfur_texture_size = 128\n"
                   "fur_texture_repeat = 8\nfins = true\nbase_colour = '#101010'\n"
                   "tip_colour = '#101010'\n",
                   true),
      VertexOrder::kSorted);
  static const PictureScene kNear = [] {
    PictureScene scene = Nearer(shown.scene(), 0.5f);
    for (Body& body : scene.bodies) {
      std::ranges::fill(body.covered, 0.0f);
      body.mapped.clear();
      body.eyes.clear();
    }
    return scene;
  }();
  return kNear;
}

PictureScene CutByVertex(PictureScene scene) {
  scene.growth.assign(scene.draws.size(), {});
  return scene;
}

PictureScene Skin(PictureScene scene) {
  for (LayerDraw& draw : scene.draws) draw.shells.shell = {}, draw.shells.fins = {};
  return scene;
}

// Shares of the pixels of bald skin that fur hides, and of those with fur.
struct Hidden {
  double bald, furry;
};
Hidden FindHidden(const std::vector<uint8_t>& skin, const std::vector<uint8_t>& coat) {
  constexpr int kOther = 24;
  uint32_t seen[2] = {}, hidden[2] = {};
  for (size_t i = 0; i < skin.size(); i += 3) {
    const bool bald = skin[i] > 170 && skin[i + 1] < 10, furry = skin[i] < 10 && skin[i + 1] > 170;
    if (!bald && !furry) continue;
    ++seen[furry];
    int most = 0;
    for (size_t c = 0; c < 3; ++c)
      most = std::max(most, std::abs(int(skin[i + c]) - int(coat[i + c])));
    hidden[furry] += most > kOther;
  }
  EXPECT_GT(seen[0], 2000u);
  EXPECT_GT(seen[1], 2000u);
  return {double(hidden[0]) / std::max(seen[0], 1u), double(hidden[1]) / std::max(seen[1], 1u)};
}

void ExpectSharpEdges(PictureRenderer& renderer) {
  const std::vector<uint8_t> skin = renderer.Draw(Skin(Coat()), kSmall);
  const Hidden cut = FindHidden(skin, renderer.Draw(Coat(), kSmall)),
               by_vertex = FindHidden(skin, renderer.Draw(CutByVertex(Coat()), kSmall));
  std::printf(
      "%s: fur on %.1f %% of the bald skin and %.1f %% of the other, by vertices on "
      "%.1f %% and %.1f %%\n",
      renderer.Device().c_str(), 100.0 * cut.bald, 100.0 * cut.furry, 100.0 * by_vertex.bald,
      100.0 * by_vertex.furry);
  EXPECT_LT(cut.bald, 0.1);
  EXPECT_GT(cut.furry, 0.8);
  EXPECT_GT(by_vertex.bald, 0.3);
}

TEST(StencilPicture, IsSharperThanTheMesh) {
  ASSERT_TRUE(Coat().growth[0].sheets);
  SoftwareRenderer software;
  ExpectSharpEdges(software);
}

// The map's byte is the vertex's where both are known: one function makes them.
TEST(StencilPicture, IsThatOfTheVerticesAtVertices) {
  const ShellGrowth& growth = Coat().growth[0];
  const LayerDraw& draw = Coat().draws[0];
  std::vector<uint32_t> indices(WriteShellIndices(draw.shells, {}));
  WriteShellIndices(draw.shells, indices);
  uint32_t compared = 0, other = 0;
  for (const uint32_t i : indices) {
    const float(&uv)[2] = draw.shells.skin[i / kVerticesPerChunk].uv[i % kVerticesPerChunk];
    const glm::vec2 at(uv[0], uv[1]);
    const glm::vec2 square = (at - glm::floor(at)) * float(kSquares);
    const glm::vec2 in = glm::abs(square - glm::floor(square) - 0.5f);
    if (std::max(in.x, in.y) > 0.4f) continue;  // texels are mixed at the squares' edges
    const float vertex = float(draw.As<ShellVertex>()[i].base_colour >> 24) / 255.0f;
    ++compared;
    other += std::abs(growth.sheets->At(growth.SheetOf(i), at) - vertex) > 1.0f / 255.0f;
  }
  EXPECT_GT(compared, 300u);
  EXPECT_EQ(other, 0u);
}

TEST_F(GlPicture, StencilIsThatOfTheSoftware) {
  ExpectSharpEdges(*renderer_);
  const std::vector<uint8_t> picture = renderer_->Draw(Coat(), kSmall);
  SoftwareRenderer software;
  const double db = PsnrDb(picture, software.Draw(Coat(), kSmall));
  const double both = PsnrDb(renderer_->Draw(CutByVertex(Coat()), kSmall),
                             software.Draw(CutByVertex(Coat()), kSmall));
  const double fault = PsnrDb(picture, software.Draw(CutByVertex(Coat()), kSmall));
  std::printf(
      "stencil: %.1f dB between OpenGL and software, %.1f by vertices, %.1f where one "
      "goes by vertices\n",
      db, both, fault);
  EXPECT_GE(db, std::min(both, kFurTwinDb) - 1.0);
  EXPECT_LT(fault, db - 10.0);
}

}  // namespace
}  // namespace pelt::testing
