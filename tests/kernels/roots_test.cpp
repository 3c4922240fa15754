// roots and anchors against plain double-precision references.
#include "core/kernels/roots.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "tests/kernels/run_kernel.hpp"

namespace pelt::test {
namespace {

struct Scene {
  ChunkStateBlock state{};  // of the chunk, and of its vertices' patch
  StrandBlock strands{};
  SkinnedBlock skinned{};
  RootBlock roots;

  template <class V>
  void RunRoots() {
    Poison(roots);
    RunOnBlocks<Roots<V>>(nullptr, state, strands, skinned, roots);
  }
  template <class V>
  void RunAnchors() {
    Poison(roots);
    RunOnBlocks<Anchors<V>>(nullptr, state, skinned, roots);
  }
};

void SetUnit(std::mt19937& random, float (&out)[4]) {
  double length = 0.0;
  for (int c = 0; c < 3; ++c) {
    out[c] = Uniform(random, -1.0f, 1.0f);
    length += double(out[c]) * out[c];
  }
  for (int c = 0; c < 3; ++c) out[c] = float(out[c] / std::sqrt(length));
  out[3] = 0.0f;
}

// All vertices are filled; strands beyond the live ones repeat the last, as the groom bakes them.
std::unique_ptr<Scene> MakeScene(uint32_t live_strands, uint32_t live_vertices, uint32_t seed) {
  auto scene = std::make_unique<Scene>();
  std::mt19937 random(seed);
  scene->state.live_strands = live_strands;
  scene->state.live_chains = live_vertices;
  for (SkinnedVertex& vertex : scene->skinned.vertex) {
    for (int c = 0; c < 3; ++c) {
      vertex.position[c] = Uniform(random, -2.0f, 2.0f);
      vertex.motion[c] = Uniform(random, -0.1f, 0.1f);
    }
    SetUnit(random, vertex.normal);
    vertex.normal[1] = std::fabs(vertex.normal[1]) + 1.0f;
    SetUnit(random, vertex.tangent);
  }
  for (uint32_t s = 0; s < kStrandsPerChunk; ++s) {
    const uint32_t from = s < live_strands ? s : live_strands - 1;
    const float a = Uniform(random, 0.0f, 0.5f), b = Uniform(random, 0.0f, 0.5f);
    const float bary[3] = {a, b, 1.0f - a - b};
    for (int k = 0; k < 3; ++k) {
      scene->strands.bary[k][s] = from == s ? bary[k] : scene->strands.bary[k][from];
      scene->strands.vertex[k][s] =
          from == s ? uint8_t(random() % kVerticesPerChunk) : scene->strands.vertex[k][from];
    }
  }
  return scene;
}

TEST(Roots, IsTheDoubleReference) {
  const auto scene = MakeScene(kStrandsPerChunk, kVerticesPerChunk, 1);
  scene->RunRoots<ArrayVec<4>>();
  for (uint32_t s = 0; s < kStrandsPerChunk; ++s) {
    double p[3] = {}, n[3] = {}, t[3] = {}, m[3] = {}, length = 0.0, along = 0.0, across = 0.0;
    for (int k = 0; k < 3; ++k) {
      const SkinnedVertex& vertex = scene->skinned.vertex[scene->strands.vertex[k][s]];
      const double b = scene->strands.bary[k][s];
      for (int c = 0; c < 3; ++c) {
        p[c] += b * vertex.position[c];
        n[c] += b * vertex.normal[c];
        t[c] += b * vertex.tangent[c];
        m[c] += b * vertex.motion[c];
      }
    }
    for (double v : n) length += v * v;
    for (double& v : n) v /= std::sqrt(length);
    for (int c = 0; c < 3; ++c) along += n[c] * t[c];
    for (int c = 0; c < 3; ++c) t[c] -= along * n[c];
    for (double v : t) across += v * v;
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(scene->roots.position[c][s], p[c], 2e-6) << s;
      EXPECT_NEAR(scene->roots.motion[c][s], m[c], 2e-7) << s;
      EXPECT_NEAR(scene->roots.normal[c][s], n[c], 1e-5) << s;
      if (across > 1e-3) {
        EXPECT_NEAR(scene->roots.tangent[c][s], t[c] / std::sqrt(across), 1e-4) << s;
      }
    }
  }
}

TEST(Roots, SameBitsOnEveryVectorForAnyLiveCount) {
  for (uint32_t live : {1u, 3u, 16u, 17u, 50u, kStrandsPerChunk}) {
    const auto scene = MakeScene(live, kVerticesPerChunk, 10 + live);
    scene->RunRoots<ArrayVec<4>>();
    const RootBlock expected = scene->roots;
    ForEveryVector([&]<class V>(const char* name) {
      SCOPED_TRACE(name);
      scene->template RunRoots<V>();
      const uint32_t lanes = RoundUpToLaneGroups(live);
      ExpectSameBits(scene->roots.position, expected.position, lanes, "position");
      ExpectSameBits(scene->roots.normal, expected.normal, lanes, "normal");
      ExpectSameBits(scene->roots.tangent, expected.tangent, lanes, "tangent");
      ExpectSameBits(scene->roots.motion, expected.motion, lanes, "motion");
      for (uint32_t s = 0; s < lanes; ++s) ASSERT_TRUE(std::isfinite(scene->roots.tangent[0][s]));
      for (uint32_t s = lanes; s < kStrandsPerChunk; ++s)
        ASSERT_EQ(BitsOf(scene->roots.position[0][s]), 0xffffffffu) << "wrote a dead lane";
    });
  }
}

// The vertices of a halo lie anywhere in the layer's patches.
TEST(Roots, StandOnVerticesWhereverTheyLie) {
  const auto scene = MakeScene(50, kVerticesPerChunk, 7);
  scene->RunRoots<ArrayVec<4>>();
  Scattered<SkinnedBlock> patches(scene->skinned, kVerticesPerChunk, 5);
  ExpectOnEveryVector(
      scene->roots,
      [&]<class V> {
        return OutputOf<Roots<V>, RootBlock>(nullptr, scene->state, scene->strands, patches.Bind());
      },
      "scattered");
}

TEST(Roots, CancellingNormalsGiveAUnitFrame) {
  const auto scene = MakeScene(32, kVerticesPerChunk, 3);
  for (uint32_t s = 0; s < 32; ++s) {
    const uint8_t index[3] = {0, 1, uint8_t(2 + s % 3)};
    const float bary[3] = {0.5f, 0.5f, 0.0f};
    for (int k = 0; k < 3; ++k) {
      scene->strands.vertex[k][s] = index[k];
      scene->strands.bary[k][s] = bary[k];
    }
  }
  for (int c = 0; c < 3; ++c) {
    scene->skinned.vertex[1].normal[c] = -scene->skinned.vertex[0].normal[c];
    scene->skinned.vertex[1].tangent[c] = -scene->skinned.vertex[0].tangent[c];
    scene->skinned.vertex[0].position[c] = scene->skinned.vertex[1].position[c] = 1e15f;
  }
  scene->RunRoots<ArrayVec<8>>();
  for (uint32_t s = 0; s < 32; ++s) {
    double nn = 0.0, tt = 0.0, nt = 0.0;
    for (int c = 0; c < 3; ++c) {
      const double n = scene->roots.normal[c][s], t = scene->roots.tangent[c][s];
      nn += n * n;
      tt += t * t;
      nt += n * t;
      EXPECT_FLOAT_EQ(scene->roots.position[c][s], 1e15f);
    }
    EXPECT_NEAR(nn, 1.0, 1e-6);
    EXPECT_NEAR(tt, 1.0, 1e-6);
    EXPECT_NEAR(nt, 0.0, 1e-6);
  }
}

TEST(Anchors, AreTheVerticesBitForBit) {
  for (uint32_t live : {1u, 16u, 37u, kVerticesPerChunk}) {
    ForEveryVector([&]<class V>(const char* name) {
      SCOPED_TRACE(name);
      const auto scene = MakeScene(1, live, 20 + live);
      scene->skinned.vertex[0].motion[0] = -0.0f;
      scene->template RunAnchors<V>();
      const uint32_t lanes = RoundUpToLaneGroups(live);
      for (uint32_t v = 0; v < lanes; ++v) {
        for (int c = 0; c < 3; ++c) {
          const SkinnedVertex& in = scene->skinned.vertex[v];
          ASSERT_EQ(BitsOf(scene->roots.position[c][v]), BitsOf(in.position[c])) << v;
          ASSERT_EQ(BitsOf(scene->roots.normal[c][v]), BitsOf(in.normal[c])) << v;
          ASSERT_EQ(BitsOf(scene->roots.tangent[c][v]), BitsOf(in.tangent[c])) << v;
          ASSERT_EQ(BitsOf(scene->roots.motion[c][v]), BitsOf(in.motion[c])) << v;
        }
      }
      for (uint32_t v = lanes; v < kVerticesPerChunk; ++v)
        ASSERT_EQ(BitsOf(scene->roots.motion[2][v]), 0xffffffffu) << "wrote a dead lane";
    });
  }
}

}  // namespace
}  // namespace pelt::test
