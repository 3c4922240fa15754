// Fur as relief on a torus: what is seen runs the way that it was combed, and no other.
#include "bench/picture/relief_coat.hpp"

#include <gtest/gtest.h>

#include "bench/shading/default_look.hpp"
#include "tests/groom/torus_character.hpp"

namespace pelt {
namespace {

// A torus whose fur lies at this angle to its ring.
struct CombedTorus {
  Character character = test::MakeTorus();
  RestGeometry rest = ComputeRestGeometry(character, 1.0f);
  FurSetup setup;
  Body body;

  explicit CombedTorus(float azimuth, float mirrored = 1.0f) {
    LayerSetup layer;
    layer.name = "coat";
    layer.azimuth = azimuth;
    layer.elevation = 25.0f;
    layer.length = 0.06f;
    setup.layers = {layer};
    for (glm::vec2& uv : character.mesh.uv) uv.x *= mirrored;
    const std::vector<std::string> names = {"coat"};
    body.character = &character;
    body.position = rest.position;
    body.normal = rest.normal;
    body.fur.assign(rest.position.size(), glm::vec3(0.05f));
    body.fur_tip.assign(rest.position.size(), glm::vec3(0.6f));
    body.axes = FindTextureAxes(character.mesh, rest.position);
    body.relief = std::make_shared<const ReliefCoat>(character, setup, 1.0f, names);
  }

  // Seen from straight above, at shares of a cell of the grid along its ring and across.
  float ShadeOnTop(uint32_t cell, float along, float across) const {
    const SurfacePoint at{2 * (cell * 16 + 4), {1.0f - along - across, across, along}};
    const Mesh& mesh = character.mesh;
    const glm::vec3 eye =
        Interpolate(body.position, mesh, at) + glm::normalize(Interpolate(body.normal, mesh, at));
    return Shade(at, eye, glm::vec3(0.0f)).g;
  }
  glm::vec3 Shade(const SurfacePoint& at, const glm::vec3& eye, const glm::vec3& skin) const {
    const PictureLook look = DefaultLook();
    ReliefCount count;
    return body.relief->Shade(body, at, {&look, 1}, {}, eye, 1.0f, skin, count);
  }
  // How much light differs over 1.6 mm along the ring, over that across it.
  float Ratio() const {
    float along = 0.0f, across = 0.0f;
    for (uint32_t i = 0; i < 1500; ++i) {
      const float x = 0.1f + 0.3f * HashShare(2 * i), y = 0.1f + 0.3f * HashShare(2 * i + 1);
      const float here = ShadeOnTop(i % 48, x, y);
      along += std::abs(ShadeOnTop(i % 48, x + 0.04f, y) - here);
      across += std::abs(ShadeOnTop(i % 48, x, y + 0.04f) - here);
    }
    return along / across;
  }
};

TEST(ReliefCoat, StreaksRunAsTheFurIsCombed) {
  EXPECT_LT(CombedTorus(0.0f).Ratio(), 0.9f);
  EXPECT_GT(CombedTorus(90.0f).Ratio(), 1.1f);
  EXPECT_LT(CombedTorus(0.0f, -1.0f).Ratio(), 0.9f) << "also where the texture is mirrored";
}

TEST(ReliefCoat, HidesTheSkinWhereFurGrows) {
  const CombedTorus torus(0.0f);
  const SurfacePoint at{2 * 4, {0.4f, 0.3f, 0.3f}};
  const auto over = [&](const glm::vec3& skin) {
    return torus.Shade(at, glm::vec3(0.0f, 1.0f, 0.0f), skin);
  };
  EXPECT_EQ(over(glm::vec3(0.0f)), over(glm::vec3(9.0f)));
}

TEST(ReliefCoat, AxesAreMetresOfTheTexture) {
  const CombedTorus torus(0.0f);
  const Mesh& mesh = torus.character.mesh;
  for (size_t v = 0; v < mesh.position.size(); ++v) {
    const glm::vec3 p = mesh.position[v];
    const float ring = std::sqrt(p.x * p.x + p.z * p.z);  // m from the axis
    ASSERT_NEAR(glm::length(torus.body.axes.u[v]) / (ring * 6.2831853f), 1.0f, 0.08f) << v;
    ASSERT_NEAR(glm::length(torus.body.axes.v[v]) / (0.1f * 6.2831853f), 1.0f, 0.08f) << v;
  }
}

}  // namespace
}  // namespace pelt
