// skin against a plain double-precision reference; border vertices; restarts; frames that cancel.
#include "core/kernels/skin.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>

#include "tests/kernels/run_kernel.hpp"

namespace pelt::test {
namespace {

struct Scene {
  PaletteBlock palette{};
  MeshBlock mesh{};
  ChunkStateBlock state{};
  SkinnedBlock skinned{};

  template <class V>
  void Run() {
    RunOnBlocks<Skin<V>>(nullptr, palette, mesh, state, skinned);
  }
};

void FillPalette(PaletteBlock& palette, uint32_t seed) {
  std::mt19937 random(seed);
  for (auto& matrix : palette.matrix)
    for (int i = 0; i < 12; ++i)
      matrix[i] = (i % 5 == 0 ? 1.0f : 0.0f) + Uniform(random, -0.4f, 0.4f);
}

// `live` vertices with up to four influences among `rows` joints a group; padding lanes repeat the
// last vertex, lanes beyond the rounded count are poison.
std::unique_ptr<Scene> MakeScene(uint32_t live, uint32_t rows, uint32_t seed) {
  auto scene = std::make_unique<Scene>();
  Poison(scene->mesh);
  FillPalette(scene->palette, seed);
  std::mt19937 random(seed + 1);
  MeshBlock& mesh = scene->mesh;
  mesh.vertex_count = uint16_t(live);
  uint32_t row = 0;
  for (uint32_t g = 0; g < kVertexGroups; ++g) {
    mesh.group_first_row[g] = uint16_t(row);
    if (g * kLaneGroup >= live) continue;
    const uint32_t first_joint = random() % (kJointsPerCharacter - rows);
    for (uint32_t r = 0; r < rows; ++r) mesh.row_joint[row + r] = uint8_t(first_joint + r);
    for (uint32_t l = 0; l < kLaneGroup; ++l) {
      const uint32_t v = g * kLaneGroup + l;
      const uint32_t from = v < live ? l : (live - 1) % kLaneGroup;
      for (int c = 0; c < 3; ++c) {
        mesh.position[c][v] = v < live ? Uniform(random, -1.0f, 1.0f) : mesh.position[c][live - 1];
        mesh.normal[c][v] = v < live ? Uniform(random, -1.0f, 1.0f) : mesh.normal[c][live - 1];
        mesh.tangent[c][v] = v < live ? Uniform(random, -1.0f, 1.0f) : mesh.tangent[c][live - 1];
      }
      float weight[kInfluenceRows] = {}, sum = 0.0f;
      for (uint32_t k = 0; k < 4; ++k) sum += weight[(l * 3 + k) % rows] += Uniform(random, 0, 1);
      for (uint32_t r = 0; r < rows; ++r)
        mesh.weight[row + r][l] = from == l ? weight[r] / sum : mesh.weight[row + r][from];
    }
    row += rows;
  }
  mesh.group_first_row[kVertexGroups] = uint16_t(row);
  scene->state.flags = kChunkVisible | kChunkSkin;
  scene->state.live_vertices = scene->state.first_new_vertex = live;
  for (auto& vertex : scene->skinned.vertex)
    for (float& v : vertex.position) v = Uniform(random, -1.0f, 1.0f);
  for (auto& vertex : scene->skinned.vertex) vertex.position[3] = 0.0f;
  return scene;
}

struct ReferenceVertex {
  double position[3], normal[3], tangent[3];
};

void NormaliseDouble(double (&a)[3]) {
  const double length = std::sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
  for (double& v : a) v /= length;
}

// One vertex, joint by joint: every joint's image, then their weighted mean.
ReferenceVertex SkinReference(const Scene& scene, uint32_t v) {
  ReferenceVertex out{};
  const MeshBlock& mesh = scene.mesh;
  const uint32_t g = v / kLaneGroup;
  for (uint32_t row = mesh.group_first_row[g]; row < mesh.group_first_row[g + 1]; ++row) {
    const double w = mesh.weight[row][v % kLaneGroup];
    const float* m = scene.palette.matrix[mesh.row_joint[row]];
    for (int r = 0; r < 3; ++r) {
      double p = m[4 * r + 3], n = 0.0, t = 0.0;
      for (int c = 0; c < 3; ++c) {
        p += double(m[4 * r + c]) * mesh.position[c][v];
        n += double(m[4 * r + c]) * mesh.normal[c][v];
        t += double(m[4 * r + c]) * mesh.tangent[c][v];
      }
      out.position[r] += w * p;
      out.normal[r] += w * n;
      out.tangent[r] += w * t;
    }
  }
  NormaliseDouble(out.normal);
  double along = 0.0;
  for (int c = 0; c < 3; ++c) along += out.normal[c] * out.tangent[c];
  for (int c = 0; c < 3; ++c) out.tangent[c] -= along * out.normal[c];
  NormaliseDouble(out.tangent);
  return out;
}

TEST(Skin, IsTheDoubleReference) {
  for (uint32_t rows : {1u, 4u, 5u, 8u}) {
    const auto scene = MakeScene(kVerticesPerChunk, rows, 10 + rows);
    const SkinnedBlock before = scene->skinned;
    scene->Run<ArrayVec<4>>();
    for (uint32_t v = 0; v < kVerticesPerChunk; ++v) {
      const ReferenceVertex reference = SkinReference(*scene, v);
      const SkinnedVertex& out = scene->skinned.vertex[v];
      for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(out.position[c], reference.position[c], 3e-6) << v;
        EXPECT_NEAR(out.normal[c], reference.normal[c], 1e-5) << v;
        EXPECT_NEAR(out.tangent[c], reference.tangent[c], 1e-4) << v;
        EXPECT_EQ(out.motion[c], out.position[c] - before.vertex[v].position[c]) << v;
      }
      EXPECT_TRUE(BitsOf(out.position[3]) == 0 && BitsOf(out.normal[3]) == 0 &&
                  BitsOf(out.tangent[3]) == 0 && BitsOf(out.motion[3]) == 0);
    }
  }
}

TEST(Skin, SameBitsOnEveryVectorForAnyLiveCount) {
  for (uint32_t live : {1u, 4u, 16u, 17u, 33u, 100u, kVerticesPerChunk}) {
    if (live > kVerticesPerChunk) continue;
    const auto reference = MakeScene(live, 6, live);
    reference->state.first_new_vertex = live / 2;
    const Scene start = *reference;
    reference->Run<ArrayVec<4>>();
    for (uint32_t v = 0; v < live; ++v)
      for (float value : reference->skinned.vertex[v].tangent) ASSERT_TRUE(std::isfinite(value));
    ForEveryVector([&]<class V>(const char* name) {
      auto scene = std::make_unique<Scene>(start);
      scene->Run<V>();
      EXPECT_EQ(std::memcmp(&scene->skinned, &reference->skinned, sizeof scene->skinned), 0)
          << name << ", " << live << " live";
    });
  }
}

TEST(Skin, TouchesOnlyTheLiveGroups) {
  const auto scene = MakeScene(20, 4, 3);
  const SkinnedBlock before = scene->skinned;
  scene->Run<ArrayVec<16>>();
  for (uint32_t v = 32; v < kVerticesPerChunk; ++v)
    EXPECT_EQ(std::memcmp(&scene->skinned.vertex[v], &before.vertex[v], sizeof(SkinnedVertex)), 0);
}

// The same vertex in two patches: other neighbours, so other rows, all of weight 0 for it, in front
// of, between and behind its own.
TEST(Skin, AVertexDoesNotDependOnWhomItSharesItsPatchWith) {
  ForEveryVector([&]<class V>(const char* name) {
    SCOPED_TRACE(name);
    for (uint32_t round = 0; round < 200; ++round) {
      std::mt19937 random(round);
      auto alone = MakeScene(16, 4, 1000 + round), crowded = MakeScene(16, 4, 2000 + round);
      crowded->palette = alone->palette;
      crowded->skinned = alone->skinned;
      const uint8_t joints[4] = {20, 60, 61, 200};
      const float share = Uniform(random, 0.1f, 0.4f);
      const float weight[4] = {share, 0.5f - share, round % 2 ? 0.5f : 0.25f, 0.25f};
      // Elements that are zero of either sign; in odd rounds a row that is -0 in all of its joints,
      // so that a sum which did not start at +0 would show its sign.
      for (uint32_t j = 0; j < kJointsPerCharacter; ++j) {
        for (int i = 0; i < 12; ++i)
          if (random() % 3 == 0) alone->palette.matrix[j][i] = random() % 2 ? 0.0f : -0.0f;
      }
      for (int k = 0; k < 4 && round % 2; ++k)
        for (uint32_t i = 0; i < 4; ++i)
          alone->palette.matrix[joints[k]][round % 3 * 4 + i] = -0.0f;
      crowded->palette = alone->palette;

      const uint32_t here = random() % 16, there = random() % 16;
      for (int c = 0; c < 3; ++c) {
        crowded->mesh.position[c][there] = alone->mesh.position[c][here] =
            random() % 4 ? Uniform(random, -0.2f, 1.0f) : 0.0f;
        crowded->mesh.normal[c][there] = alone->mesh.normal[c][here];
        crowded->mesh.tangent[c][there] = alone->mesh.tangent[c][here];
      }
      for (int k = 0; k < 4; ++k) {
        alone->mesh.row_joint[k] = joints[k];
        alone->mesh.weight[k][here] = weight[k];
      }
      uint32_t row = 0;
      for (uint32_t joint = 0; joint < kJointsPerCharacter && row < 16; ++joint) {
        int own = -1;
        for (int k = 0; k < 4; ++k)
          if (joints[k] == joint) own = k;
        if (own < 0 && joint % 17 != 3) continue;
        crowded->mesh.row_joint[row] = uint8_t(joint);
        for (uint32_t l = 0; l < kLaneGroup; ++l) crowded->mesh.weight[row][l] = 0.125f;
        crowded->mesh.weight[row][there] = own < 0 ? 0.0f : weight[own];
        ++row;
      }
      ASSERT_GT(row, 12u);
      crowded->mesh.group_first_row[1] = uint16_t(row);
      std::memcpy(crowded->skinned.vertex[there].position, alone->skinned.vertex[here].position,
                  16);
      alone->template Run<V>();
      crowded->template Run<V>();
      ASSERT_EQ(std::memcmp(&alone->skinned.vertex[here], &crowded->skinned.vertex[there],
                            sizeof(SkinnedVertex)),
                0)
          << "round " << round;
    }
  });
}

TEST(Skin, NothingMovesWithoutALastFrame) {
  enum Cause { kRestartFlag, kTeleport, kNewVertices };
  for (Cause cause : {kRestartFlag, kTeleport, kNewVertices}) {
    const auto scene = MakeScene(64, 5, 40);
    uint32_t first_new = 0;
    if (cause == kRestartFlag) scene->state.flags |= kChunkRestart;
    if (cause == kTeleport) scene->palette.teleported = 1;
    if (cause == kNewVertices) scene->state.first_new_vertex = first_new = 21;
    // Last frame's values of a vertex without a last frame are what memory happened to hold.
    for (uint32_t v = first_new; v < kVerticesPerChunk; ++v) Poison(scene->skinned.vertex[v]);
    scene->Run<ArrayVec<8>>();
    for (uint32_t v = 0; v < 64; ++v) {
      for (int c = 0; c < 4; ++c) {
        if (v >= first_new) {
          EXPECT_EQ(BitsOf(scene->skinned.vertex[v].motion[c]), 0u) << v;
        } else if (c < 3) {
          EXPECT_NE(scene->skinned.vertex[v].motion[c], 0.0f) << v;
        }
      }
    }
  }
}

TEST(Skin, AStillVertexHasNoMotion) {
  const auto scene = MakeScene(64, 5, 41);
  scene->Run<ArrayVec<8>>();
  scene->Run<ArrayVec<4>>();
  for (uint32_t v = 0; v < 64; ++v)
    for (float m : scene->skinned.vertex[v].motion) EXPECT_EQ(BitsOf(m), 0u);
}

TEST(Skin, FramesStayUnitWhenNormalsCancelCollapseOrExplode) {
  const auto scene = MakeScene(64, 2, 50);
  const float sizes[] = {0.0f, 1e-30f, 1e-12f, 1.0f, 1e12f, 1e18f};
  for (float size : sizes) {
    for (uint32_t j = 0; j < kJointsPerCharacter; ++j) {
      // Odd joints turn by half a turn about y: with weights 1/2 each, x and z cancel.
      const float s = j % 2 ? -size : size;
      const float matrix[12] = {s, 0, 0, 1e6f, 0, size, 0, -1e6f, 0, 0, s, 1e3f};
      std::memcpy(scene->palette.matrix[j], matrix, sizeof matrix);
    }
    for (uint32_t row = 0; row < scene->mesh.group_first_row[4]; ++row)
      for (float& w : scene->mesh.weight[row]) w = 0.5f;
    for (uint32_t v = 0; v < 64; ++v) scene->mesh.normal[1][v] = v % 2 ? 0.0f : 0.25f;
    scene->Run<ArrayVec<4>>();
    for (uint32_t v = 0; v < 64; ++v) {
      const SkinnedVertex& out = scene->skinned.vertex[v];
      double nn = 0, tt = 0, nt = 0;
      for (int c = 0; c < 3; ++c) {
        ASSERT_TRUE(std::isfinite(out.position[c]) && std::isfinite(out.motion[c]));
        nn += double(out.normal[c]) * out.normal[c];
        tt += double(out.tangent[c]) * out.tangent[c];
        nt += double(out.normal[c]) * out.tangent[c];
      }
      EXPECT_NEAR(nn, 1.0, 1e-6) << size << " " << v;
      EXPECT_NEAR(tt, 1.0, 1e-6) << size << " " << v;
      EXPECT_NEAR(nt, 0.0, 3e-6) << size << " " << v;
    }
  }
}

}  // namespace
}  // namespace pelt::test
