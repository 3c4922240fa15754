// The brush on maps over the surface: what it holds is painted, across seams, and nothing else.
#include "bench/viewer/map_brush.hpp"

#include <gtest/gtest.h>

#include "core/groom/fur_setup.hpp"

namespace pelt {
namespace {

constexpr uint32_t kSide = 64;

// From x0 to x1 and 0 to 1 m high, of its own vertices.
struct Quad {
  float x0, x1, u0, u1, v0, v1;

  glm::vec2 UvAt(float x, float y) const {
    return {u0 + (u1 - u0) * (x - x0) / (x1 - x0), v0 + (v1 - v0) * y};
  }
};

Mesh MeshOf(std::span<const Quad> quads) {
  Mesh mesh;
  for (const Quad& quad : quads) {
    const uint32_t first = uint32_t(mesh.position.size());
    for (const glm::vec2& at : {glm::vec2(quad.x0, 0.0f), glm::vec2(quad.x1, 0.0f),
                                glm::vec2(quad.x1, 1.0f), glm::vec2(quad.x0, 1.0f)}) {
      mesh.position.push_back({at.x, at.y, 0.0f});
      mesh.uv.push_back(quad.UvAt(at.x, at.y));
    }
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
  }
  mesh.triangle_material.assign(mesh.triangles.size(), 0);
  return mesh;
}

MapBrush BrushOn(std::span<const Quad> quads) {
  const Mesh mesh = MeshOf(quads);
  return MapBrush(mesh, {mesh.position, {}, {}}, kSide);
}

float Sample(const std::vector<uint8_t>& texels, const glm::vec2& uv) {
  ControlMap map{kSide, kSide, {}};
  for (const uint8_t texel : texels) map.rgba.insert(map.rgba.end(), 4, texel);
  return map.Sample(uv, 0);
}

// Beside each other on the skin, apart and upside down in the texture.
constexpr Quad kSeam[] = {{0.0f, 0.5f, 0.05f, 0.45f, 0.1f, 0.9f},
                          {0.5f, 1.0f, 0.55f, 0.95f, 0.9f, 0.1f}};

TEST(MapBrush, GoesOnAcrossASeamWithoutAGap) {
  constexpr float kTexel = 0.02f;  // m, rounded up
  MapBrush brush = BrushOn(kSeam);
  std::vector<uint8_t> texels(kSide * kSide, 0);
  EXPECT_GT(brush.Paint(texels, {{0.5f, 0.5f, 0.0f}, 0.3f, 1.0f, 1.0f}), 500u);
  for (const Quad& quad : kSeam)
    for (float x = quad.x0; x <= quad.x1; x += 0.05f)
      for (float y = 0.0f; y <= 1.0f; y += 0.05f) {
        const float away = glm::length(glm::vec2(x - 0.5f, y - 0.5f));
        const float value = Sample(texels, quad.UvAt(x, y));
        if (away < 0.3f - 2.0f * kTexel) {
          EXPECT_EQ(value, 1.0f) << x << ' ' << y;
        }
        if (away > 0.3f + 2.0f * kTexel) {
          EXPECT_EQ(value, 0.0f) << x << ' ' << y;
        }
      }
}

TEST(MapBrush, SoftensToItsEdgeAndAddsUp) {
  MapBrush brush = BrushOn(kSeam);
  std::vector<uint8_t> texels(kSide * kSide, 0);
  const MapDab dab{{0.5f, 0.5f, 0.0f}, 0.3f, 0.0f, 1.0f};
  const glm::vec2 halfway = kSeam[0].UvAt(0.35f, 0.5f);
  brush.Paint(texels, dab);
  EXPECT_NEAR(Sample(texels, halfway), 0.75f, 0.03f);
  EXPECT_GT(Sample(texels, kSeam[0].UvAt(0.49f, 0.5f)), 0.97f);
  brush.Paint(texels, dab);
  EXPECT_NEAR(Sample(texels, halfway), 0.9375f, 0.02f);
  EXPECT_EQ(brush.Paint(texels, {{0.5f, 0.5f, 2.0f}, 0.3f, 0.0f, 0.0f}), 0u);
}

TEST(MapBrush, PaintsBothEndsOfATextureThatRepeats) {
  constexpr Quad kAround[] = {{0.0f, 1.0f, 0.9f, 1.1f, 0.1f, 0.9f}};
  MapBrush brush = BrushOn(kAround);
  std::vector<uint8_t> texels(kSide * kSide, 0);
  brush.Paint(texels, {{0.5f, 0.5f, 0.0f}, 0.3f, 1.0f, 1.0f});
  for (const float u : {0.97f, 0.99f, 0.01f, 0.03f}) EXPECT_EQ(Sample(texels, {u, 0.5f}), 1.0f);
  for (const float u : {0.9f, 0.1f, 0.5f}) EXPECT_EQ(Sample(texels, {u, 0.5f}), 0.0f);
}

// Another island's texels are not changed from beyond an edge: here they have a texel between them.
TEST(MapBrush, LeavesTheIslandNextToItInTheTexture) {
  constexpr Quad kNeighbours[] = {{0.0f, 0.5f, 0.0f, 0.484375f, 0.0f, 1.0f},
                                  {5.0f, 5.5f, 0.5f, 1.0f, 0.0f, 1.0f}};
  MapBrush brush = BrushOn(kNeighbours);
  std::vector<uint8_t> texels(kSide * kSide, 0);
  brush.Paint(texels, {{0.5f, 0.5f, 0.0f}, 0.3f, 1.0f, 1.0f});
  EXPECT_EQ(texels[32 * kSide + 30], 255);
  EXPECT_EQ(texels[32 * kSide + 32], 0);
}

}  // namespace
}  // namespace pelt
