
#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "bench/picture/canvas.hpp"

namespace pelt {
namespace {

constexpr uint32_t kWidth = 61, kHeight = 37;
constexpr float kFar = std::numeric_limits<float>::max();

struct Sample {
  uint32_t x, y;
  float depth;
  glm::vec3 share;
  bool operator==(const Sample& other) const {
    return std::memcmp(this, &other, sizeof *this) == 0;
  }
};

struct Triangle {
  glm::vec3 a, b, c;
};

// Every sample of the picture, judged by itself.
std::vector<Sample> BruteForce(const Triangle& t, const std::vector<float>& before) {
  const auto& [a, b, c] = t;
  std::vector<Sample> samples;
  const float area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  if (area == 0.0f) return samples;
  for (uint32_t y = 0; y < kHeight; ++y)
    for (uint32_t x = 0; x < kWidth; ++x) {
      const glm::vec2 s(float(x) + 0.5f, float(y) + 0.5f);
      const float u = ((c.x - b.x) * (s.y - b.y) - (c.y - b.y) * (s.x - b.x)) / area;
      const float v = ((a.x - c.x) * (s.y - c.y) - (a.y - c.y) * (s.x - c.x)) / area;
      const glm::vec3 on_screen(u, v, 1.0f - u - v);
      if (u < 0.0f || v < 0.0f || on_screen.z < 0.0f) continue;
      const glm::vec3 nearness = on_screen / glm::vec3(a.z, b.z, c.z);
      const float depth = 1.0f / (nearness.x + nearness.y + nearness.z);
      if (depth < before[size_t(y) * kWidth + x])
        samples.push_back({x, y, depth, nearness * depth});
    }
  return samples;
}

std::vector<Sample> Found(const Triangle& t, const std::vector<float>& before) {
  std::vector<Sample> samples;
  TriangleSamples(t.a, t.b, t.c, kWidth, kHeight)
      .ForEach(
          before,
          [&](uint32_t x, uint32_t y, float depth) {
            return depth < before[size_t(y) * kWidth + x];
          },
          [&](uint32_t x, uint32_t y, float depth, const glm::vec3& nearness) {
            samples.push_back({x, y, depth, nearness * depth});
          });
  return samples;
}

// Corners of all kinds: within the picture, beside it, far outside, on whole samples, in one row or column.
Triangle RandomTriangle(std::mt19937& random) {
  const auto even = [&](float low, float high) {
    return low + (high - low) * float(random() >> 8) / 16777216.0f;
  };
  const float reach = random() % 8 == 0 ? 20000.0f : 10.0f;
  const bool whole = random() % 4 == 0, small = random() % 2 == 0;
  const glm::vec2 middle(even(-5.0f, kWidth + 5.0f), even(-5.0f, kHeight + 5.0f));
  Triangle t{};
  for (glm::vec3* corner : {&t.a, &t.b, &t.c}) {
    *corner = small ? glm::vec3(middle + glm::vec2(even(-3.0f, 3.0f), even(-3.0f, 3.0f)), 0.0f)
                    : glm::vec3(even(-reach, kWidth + reach), even(-reach, kHeight + reach), 0.0f);
    if (whole) *corner = glm::floor(*corner) + 0.5f;
    corner->z = random() % 4 == 0 ? 1.0f : even(0.5f, 3.0f);
  }
  if (random() % 8 == 0) t.b.y = t.a.y;
  if (random() % 8 == 0) t.c.x = t.b.x;
  if (random() % 16 == 0) t.c = t.a + (t.b - t.a) * 0.5f + glm::vec3(1e-4f, 0.0f, 0.0f);
  return t;
}

TEST(TriangleSamples, AreThoseOfEverySampleJudgedByItself) {
  std::mt19937 random(7);
  size_t found = 0, hidden = 0;
  for (int round = 0; round < 20000; ++round) {
    const Triangle t = RandomTriangle(random);
    std::vector<float> before(size_t(kWidth) * kHeight, kFar);
    const std::vector<Sample> all = BruteForce(t, before);
    // Things before the triangle, at its very depth, and none.
    for (float& depth : before) {
      const uint32_t kind = random() % 4;
      if (kind < 2) depth = kind ? 0.4f : t.a.z;
    }
    const std::vector<Sample> wanted = BruteForce(t, before);
    ASSERT_EQ(Found(t, before), wanted) << "round " << round;
    found += wanted.size();
    hidden += all.size() - wanted.size();
  }
  EXPECT_GT(found, 100000u);
  EXPECT_GT(hidden, 100000u);
}

// The lower shell is seen where two are as far off, in either order; what is no shell stays before both.
TEST(Canvas, ShellsOfOneDepthAreSeenByTheirNumber) {
  const glm::vec3 a(-4.0f, -4.0f, 1.0f), b(20.0f, -4.0f, 1.0f), c(-4.0f, 20.0f, 1.0f);
  const auto paint = [&](std::initializer_list<uint8_t> order, bool behind_skin) {
    Canvas canvas(4, 4);
    if (behind_skin) canvas.DrawTriangle(a, b, c, [](const glm::vec3&) { return glm::vec3(1.0f); });
    canvas.BeginShells();
    for (const uint8_t shell : order)
      canvas.DrawShellTriangle(a, b, c, shell, [&](const glm::vec3&, glm::vec4& colour) {
        colour = glm::vec4(glm::vec3(0.1f * float(shell)), 1.0f);
        return true;
      });
    return canvas.Resolve(1)[0];
  };
  EXPECT_EQ(paint({1, 2, 3}, false), paint({1}, false));
  EXPECT_EQ(paint({3, 2, 1}, false), paint({1}, false));
  EXPECT_EQ(paint({3, 2, 1}, true), paint({}, true));
  EXPECT_NE(paint({3}, false), paint({1}, false));
}

}  // namespace
}  // namespace pelt
