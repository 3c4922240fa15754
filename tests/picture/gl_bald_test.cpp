// Skin where a map leaves bald spots that are finer than the mesh: by both renderers, and against the spots themselves.
#include <gtest/gtest.h>

#include <cstdio>
#include <random>

#include "tests/picture/bald_scenario.hpp"
#include "tests/picture/gl_pictures.hpp"

namespace pelt::testing {
namespace {

const PictureScene& Spotted() {
  static const Shown shown(
      BaldScenario("density = 4000\nlength = 0.05\nwidth = 0.01\nbase_colour = '#222222'\n", false),
      VertexOrder::kSorted);
  static const PictureScene kSkin = [] {
    PictureScene scene = Nearer(shown.scene(), 0.6f);
    scene.draws.clear();
    scene.layers.clear();
    return scene;
  }();
  return kSkin;
}

PictureScene ByVertex(PictureScene scene) {
  for (Body& body : scene.bodies) body.mapped.clear();
  return scene;
}

// How often fur covers what is bald, or leaves what is not; away from the spots' edges.
double WrongShare(const Body& body) {
  const Mesh& mesh = body.character->mesh;
  std::mt19937 random(7);
  std::uniform_real_distribution<float> share(0.0f, 1.0f);
  uint32_t seen = 0, wrong = 0;
  for (uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (int k = 0; k < 8; ++k) {
      float u = share(random), v = share(random);
      if (u + v > 1.0f) u = 1.0f - u, v = 1.0f - v;
      const SurfacePoint at{t, {1.0f - u - v, u, v}};
      if (!body.furry_material[mesh.triangle_material[t]]) continue;
      const glm::vec2 uv = Interpolate(mesh.uv, mesh, at);
      const glm::vec2 square = (uv - glm::floor(uv)) * float(kSquares);
      const glm::vec2 in = glm::abs(square - glm::floor(square) - 0.5f);
      if (std::max(in.x, in.y) > 0.4f) continue;
      const bool bald = (uint32_t(square.x) + uint32_t(square.y)) % 2 == 1;
      const float covered = CoveredAt(body, at);
      ++seen;
      wrong += bald ? covered > 0.02f : covered < 0.4f;
    }
  EXPECT_GT(seen, 1000u);
  return double(wrong) / double(std::max(seen, 1u));
}

TEST(BaldSkin, IsBareWhereItsMapSaysSo) {
  ASSERT_EQ(Spotted().bodies[0].mapped.size(), 1u);
  const double wrong = WrongShare(Spotted().bodies[0]),
               by_vertex = WrongShare(ByVertex(Spotted()).bodies[0]);
  std::printf("wrongly covered or bare: %.1f %% of the skin, and %.1f %% by vertices\n",
              100.0 * wrong, 100.0 * by_vertex);
  EXPECT_LT(wrong, 0.05);
  EXPECT_GT(by_vertex, 0.25);
}

// As much hair as stands there, however it is shared out.
TEST(BaldSkin, HasAllOfItsHair) {
  const Body& body = Spotted().bodies[0];
  const MappedFur& mapped = body.mapped[0];
  double hair = 0.0, skin = 0.0;
  for (uint32_t t = 0; t < body.character->mesh.triangles.size(); ++t) {
    const auto& corner = body.character->mesh.triangles[t];
    const glm::vec3& p = body.position[corner[0]];
    const double area =
        0.5 *
        double(glm::length(glm::cross(body.position[corner[1]] - p, body.position[corner[2]] - p)));
    for (int k = 0; k < 3; ++k) {
      const double share = area * double(mapped.growth->CornerShare(t)[k]);
      hair += share * double(mapped.rate[corner[size_t(k)]]);
      skin += share;
    }
  }
  std::printf("%.3f m2 of hair on %.3f m2 of skin where it grows\n", hair, skin);
  EXPECT_NEAR(hair / skin, 4000 * 0.05 * 0.01, 0.1);
}

TEST_F(GlPicture, BaldSkinIsThatOfTheSoftware) {
  const std::vector<uint8_t> picture = renderer_->Draw(Spotted(), kSmall);
  const double db = PsnrDb(picture, SoftwareRenderer().Draw(Spotted(), kSmall));
  const double by_vertex = PsnrDb(picture, SoftwareRenderer().Draw(ByVertex(Spotted()), kSmall));
  std::printf("bald spots: %.1f dB between OpenGL and software, %.1f where one goes by vertices\n",
              db, by_vertex);
  EXPECT_GE(db, kFurTwinDb);
  EXPECT_LT(by_vertex, kFurTwinDb - 10.0);
}

}  // namespace
}  // namespace pelt::testing
