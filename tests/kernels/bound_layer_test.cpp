// bound_layer against the eight corners of every box, in double.
#include "core/kernels/bound_layer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "tests/kernels/run_kernel.hpp"

namespace pelt::test {
namespace {

struct Scene {
  PaletteBlock palette{};
  LayerBlock layer{};
  LayerJointBlock joints{};
};

template <class V>
BoundsBlock BoundsOf(const Scene& scene) {
  return OutputOf<BoundLayer<V>, BoundsBlock>(nullptr, scene.palette, scene.layer, scene.joints);
}

std::unique_ptr<Scene> MakeScene(uint32_t count, uint32_t seed) {
  auto scene = std::make_unique<Scene>();
  Poison(scene->joints);  // entries beyond `count` must not matter
  std::mt19937 random(seed);
  for (auto& matrix : scene->palette.matrix)
    for (float& v : matrix) v = Uniform(random, -1.5f, 1.5f);
  scene->joints.count = count;
  for (uint32_t i = 0; i < count; ++i) {
    scene->joints.joint[i] = (i * 37 + 5) % kJointsPerCharacter;
    for (int c = 0; c < 3; ++c) {
      scene->joints.low[c][i] = Uniform(random, -1.0f, 0.5f);
      scene->joints.high[c][i] = scene->joints.low[c][i] + Uniform(random, 0.0f, 0.8f);
    }
  }
  scene->layer.length_max = 0.04f;
  return scene;
}

TEST(BoundLayer, IsTheUnionOfAllTransformedCorners) {
  for (uint32_t count : {1u, 3u, 4u, 9u, 31u, 256u}) {
    const auto scene = MakeScene(count, count);
    const BoundsBlock bounds = BoundsOf<ArrayVec<4>>(*scene);
    double low[3] = {1e30, 1e30, 1e30}, high[3] = {-1e30, -1e30, -1e30};
    for (uint32_t i = 0; i < count; ++i) {
      const float* m = scene->palette.matrix[scene->joints.joint[i]];
      for (int corner = 0; corner < 8; ++corner) {
        double p[3];
        for (int c = 0; c < 3; ++c)
          p[c] = (corner >> c) & 1 ? scene->joints.high[c][i] : scene->joints.low[c][i];
        for (int r = 0; r < 3; ++r) {
          const double v =
              m[4 * r] * p[0] + m[4 * r + 1] * p[1] + m[4 * r + 2] * p[2] + m[4 * r + 3];
          low[r] = std::min(low[r], v);
          high[r] = std::max(high[r], v);
        }
      }
    }
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(bounds.low[c], low[c] - double(0.04f), 3e-6) << count;
      EXPECT_NEAR(bounds.high[c], high[c] + double(0.04f), 3e-6) << count;
    }
  }
}

TEST(BoundLayer, SameBlockOnEveryVector) {
  for (uint32_t count : {0u, 1u, 2u, 5u, 16u, 17u, 100u, 256u}) {
    auto scene = MakeScene(count, 90 + count);
    // Ties between zeros of both signs, in different lanes.
    if (count > 1) {
      for (auto& matrix : scene->palette.matrix) matrix[1] = matrix[5] = matrix[9] = 0.0f;
      scene->layer.length_max = 0.0f;
      for (uint32_t i = 0; i < count; ++i) {
        for (int c = 0; c < 3; ++c)
          scene->joints.low[c][i] = scene->joints.high[c][i] = i % 2 ? 0.0f : -0.0f;
        for (int r = 0; r < 3; ++r)
          scene->palette.matrix[scene->joints.joint[i]][4 * r + 3] = i % 3 ? 0.0f : -0.0f;
      }
    }
    ExpectOnEveryVector(
        BoundsOf<ArrayVec<4>>(*scene), [&]<class V> { return BoundsOf<V>(*scene); }, count);
  }
}

TEST(BoundLayer, ALayerWithoutJointsIsAPoint) {
  const auto scene = MakeScene(0, 1);
  const BoundsBlock bounds = BoundsOf<ArrayVec<4>>(*scene);
  for (int c = 0; c < 3; ++c) {
    EXPECT_EQ(bounds.low[c], 0.0f);
    EXPECT_EQ(bounds.high[c], 0.0f);
  }
}

}  // namespace
}  // namespace pelt::test
