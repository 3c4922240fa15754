// The picture's shadow map: order of drawing leaves no trace, and what lies before a place keeps light from it.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "bench/picture/shadows.hpp"

namespace pelt {
namespace {

const glm::vec3 kToSun = glm::normalize(glm::vec3(0.1f, 1.0f, 0.2f));

struct Piece {
  glm::vec3 a, b, c;
  float width;  // 0: a triangle
};

std::vector<Piece> SomePieces() {
  std::mt19937 random(7);
  const auto share = [&] { return float(random() % 10000u) / 10000.0f; };
  const auto place = [&] { return glm::vec3(share(), share(), share()) - 0.5f; };
  std::vector<Piece> pieces;
  for (int i = 0; i < 3000; ++i) {
    const glm::vec3 a = place();
    pieces.push_back({a, a + 0.1f * place(), a + 0.1f * place(), i % 10 ? 0.004f * share() : 0.0f});
  }
  return pieces;
}

ShadowMap MapOf(const std::vector<Piece>& pieces) {
  ShadowMap map(kToSun, glm::vec3(0.0f), 0.7f, 128);
  for (const Piece& piece : pieces) {
    if (piece.width > 0.0f)
      map.AddHair(piece.a, piece.b, piece.width, 0.8f);
    else
      map.AddTriangle(piece.a, piece.b, piece.c);
  }
  return map;
}

TEST(ShadowMap, OrderLeavesNoTrace) {
  std::vector<Piece> pieces = SomePieces();
  const ShadowMap forwards = MapOf(pieces);
  const auto empty = [](const ShadowMap::Texel& texel) { return texel.coverage == 0; };
  const auto full = [](const ShadowMap::Texel& t) { return t.coverage == ShadowMap::kFull; };
  const auto count = [&](auto is) {
    return std::count_if(forwards.texels().begin(), forwards.texels().end(), is);
  };
  ASSERT_GT(count(empty), 1000);  // not all is flat
  ASSERT_GT(count(full), 1000);
  ASSERT_LT(count(empty) + count(full), 128 * 128 - 1000);
  std::reverse(pieces.begin(), pieces.end());
  EXPECT_TRUE(std::ranges::equal(MapOf(pieces).texels(), forwards.texels()));
  std::shuffle(pieces.begin(), pieces.end(), std::mt19937(11));
  EXPECT_TRUE(std::ranges::equal(MapOf(pieces).texels(), forwards.texels()));
}

TEST(ShadowMap, KeepsLightFromWhatLiesBehind) {
  ShadowMap map({0.0f, 1.0f, 0.0f}, glm::vec3(0.0f), 1.0f, 64);
  map.AddTriangle({-1.0f, 0.5f, -1.0f}, {1.0f, 0.5f, -1.0f}, {0.0f, 0.5f, 1.0f});
  const auto share = [&](float height) { return map.Share({0.0f, height, 0.0f}); };
  EXPECT_EQ(share(0.6f), 1.0f);
  EXPECT_EQ(share(0.498f), 1.0f);
  EXPECT_NEAR(share(0.49f), 0.787042f, 1e-3f);
  EXPECT_NEAR(share(0.47f), 0.379330f, 1e-3f);
  EXPECT_NEAR(share(-0.5f), 0.1f, 1e-5f);
  EXPECT_EQ(map.Share({0.9f, 0.0f, 0.9f}), 1.0f);
  EXPECT_TRUE(map.Covers({0.5f, -3.0f, 0.5f}));
  EXPECT_FALSE(map.Covers({1.5f, -3.0f, 0.5f}));
}

TEST(ShadowMap, ThinHairsCoverLessAndAddUp) {
  ShadowMap map({0.0f, 1.0f, 0.0f}, glm::vec3(0.0f), 1.0f, 64);  // texels of 31 mm
  const glm::vec3 below(0.0f, -0.5f, 0.0f);
  const auto add = [&] { map.AddHair({-0.4f, 0.0f, 0.01f}, {0.4f, 0.0f, 0.01f}, 0.003f, 1.0f); };
  float last = map.Share(below);
  EXPECT_EQ(last, 1.0f);
  for (int hair = 0; hair < 5; ++hair) {
    add();
    EXPECT_LT(map.Share(below), last);
    last = map.Share(below);
  }
  for (int hair = 0; hair < 20; ++hair) add();
  EXPECT_EQ(map.Share(below), map.Share({0.1f, -0.6f, 0.0f}));  // as dark as it gets
}

TEST(ShadowMap, SoftensWhatTheGroundSees) {
  ShadowMap map({0.0f, 1.0f, 0.0f}, glm::vec3(0.0f), 1.0f, 64);
  map.AddTriangle({-4.0f, 0.5f, -4.0f}, {0.0f, 0.5f, -4.0f}, {0.0f, 0.5f, 40.0f});
  map.Soften(3);
  float last = map.Blocked({-0.25f, -1.0f, 0.0f});
  EXPECT_NEAR(last, 1.0f, 1e-4f);
  for (float x = -0.15f; x < 0.2f; x += 0.05f) {
    EXPECT_LT(map.Blocked({x, -1.0f, 0.0f}), last);
    last = map.Blocked({x, -1.0f, 0.0f});
  }
  EXPECT_EQ(map.Blocked({0.5f, -1.0f, 0.0f}), 0.0f);
}

}  // namespace
}  // namespace pelt
