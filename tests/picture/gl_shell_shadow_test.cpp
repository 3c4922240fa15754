// Shells in the sun's map by OpenGL: texel by texel what the software adds, in any order. Skipped, and says why,
// where there is no OpenGL.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "bench/picture/shadows.hpp"
#include "tests/picture/gl_pictures.hpp"

namespace pelt::testing {
namespace {

struct GlShellShadow : GlPicture {
  // Shells and the skin below them, no hairs.
  static PictureScene ShellsAlone(PictureScene scene) {
    for (auto& hairs : scene.layers) hairs.clear();
    return scene;
  }
  static void Reverse(PictureScene& scene) {
    std::ranges::reverse(scene.draws);
    std::ranges::reverse(scene.layers);
    std::ranges::reverse(scene.textures);
    std::ranges::reverse(scene.growth);
    std::ranges::reverse(scene.actors);
    std::ranges::reverse(scene.layer_looks);
  }

  // Of the texels that either map has, the share whose coverage or distance is another.
  static double Differing(const std::vector<glm::vec4>& drawn, const PictureScene& scene,
                          const Ball& ball) {
    const Body& body = scene.bodies.front();
    ShadowMap map(scene.look.light.to_sun, ball.centre, ball.radius, kShadowTexels);
    for (const auto& [p, q, r] : body.character->mesh.triangles)
      map.AddTriangle(body.position[p], body.position[q], body.position[r]);
    for (size_t i = 0; i < scene.draws.size(); ++i)
      AddShells(scene.draws[i], scene.textures[i], map);
    const float m_per_step = 2.0f * ball.radius / float(1u << 20);
    uint32_t differ = 0, covered = 0;
    for (size_t i = 0; i < drawn.size(); ++i) {
      const ShadowMap::Texel& texel = map.texels()[i];
      const float coverage = std::min(drawn[i].a, 255.0f);
      if (texel.coverage == 0 && coverage == 0.0f) continue;
      ++covered;
      differ += std::abs(coverage - float(texel.coverage)) > 2.0f ||
                std::abs(drawn[i].r - float(texel.nearest) * m_per_step) > 1e-3f;
    }
    return double(differ) / std::max(covered, 1u);
  }
};

TEST_F(GlShellShadow, IsThatOfTheSoftware) {
  const Shown shown(EveryOutputScenario(), VertexOrder::kSorted);
  const PictureScene scene = ShellsAlone(shown.scene());
  const std::vector<glm::vec4> drawn = renderer_->DrawShadowMap(scene, 0);
  const Ball ball = BoundActors(scene).front();
  const double differing = Differing(drawn, scene, ball);
  // The software's without shells, and with every other one cut as if its hairs were longer.
  PictureScene without = scene, longer = scene;
  for (LayerDraw& draw : without.draws) draw.shells.shell = {};
  std::vector<Shell> shells;
  for (LayerDraw& draw : longer.draws) {
    if (draw.shells.shell.empty()) continue;
    shells.assign(draw.shells.shell.begin(), draw.shells.shell.end());
    for (Shell& shell : shells) shell.threshold *= 0.8f;
    draw.shells.shell = shells;
  }
  const double bare = Differing(drawn, without, ball), cut = Differing(drawn, longer, ball);
  std::printf("texels that differ: %.4f; without shells %.3f, with longer hairs %.3f\n", differing,
              bare, cut);
  EXPECT_LT(differing, 0.01);
  EXPECT_GT(bare, 0.05);
  EXPECT_GT(cut, 0.05);
}

TEST_F(GlShellShadow, ForgetsTheOrder) {
  const Shown shown(EveryOutputScenario(), VertexOrder::kSorted);
  PictureScene scene = shown.scene();
  const std::vector<glm::vec4> forwards = renderer_->DrawShadowMap(scene, 0);
  Reverse(scene);
  EXPECT_TRUE(renderer_->DrawShadowMap(scene, 0) == forwards);
  for (LayerDraw& draw : scene.draws) draw.shells.shell = {};
  EXPECT_FALSE(renderer_->DrawShadowMap(scene, 0) == forwards);
}

}  // namespace
}  // namespace pelt::testing
