// Fins: how much of each edge's is seen, against a reference in double, and on a sphere, where the
// share that is seen is known.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/kernels/select_fins.hpp"
#include "tests/kernels/run_kernel.hpp"

namespace pelt::test {
namespace {

using Ref = ArrayVec<4>;

struct Scene {
  SelectFinsParams params{};
  ChunkStateBlock state{};
  StrandBlock triangles{};
  FinEdgeBlock edges{};
  ShellVertexBlock vertices{};

  template <class V>
  FinBlock Run() const {
    return OutputOf<SelectFins<V>, FinBlock>(&params, state, triangles, edges, vertices);
  }
};

void Set(float (&to)[3], const Double3& v) {
  to[0] = float(v.x);
  to[1] = float(v.y);
  to[2] = float(v.z);
}
uint32_t FadeOf(const FinBlock& fins, uint32_t triangle, uint32_t edge) {
  return fins.fade[triangle] >> 8 * edge & 255u;
}

Scene MakeScene(uint32_t live, uint32_t seed) {
  Scene scene;
  std::mt19937 random(seed);
  Set(scene.params.eye, RandomUnit(random) * 1.5);
  scene.state.live_strands = live;
  for (uint32_t v = 0; v < kVerticesPerChunk; ++v) {
    ShellVertex& vertex = scene.vertices.vertex[v];
    Set(vertex.position, RandomUnit(random) * 0.3);
    Set(vertex.groom, RandomUnit(random) * 0.03);
    Set(vertex.force, RandomUnit(random) * 0.02);
    vertex.base_colour = uint32_t(random());
    vertex.tip_colour = uint32_t(random());
    vertex.normal = uint32_t(random());
  }
  for (uint32_t t = 0; t < kStrandsPerChunk; ++t)
    for (uint32_t k = 0; k < 3; ++k) {
      scene.triangles.vertex[k][t] = uint8_t(random() % kVerticesPerChunk);
      if (random() % 3 != 0) scene.edges.owned[t] |= 255u << 8 * k;
    }
  return scene;
}

// |cosine| between the fin's normal and the direction to the eye.
double FacingOf(const Scene& s, uint32_t t, uint32_t k) {
  const ShellVertex& a = s.vertices.vertex[s.triangles.vertex[k][t]];
  const ShellVertex& b = s.vertices.vertex[s.triangles.vertex[(k + 1) % 3][t]];
  const Double3 edge = Of(b.position) - Of(a.position);
  const Double3 hair = Of(a.groom) + Of(a.force) + Of(b.groom) + Of(b.force);
  const Double3 across = Cross(edge, hair);
  const Double3 to_eye = Of(s.params.eye) - (Of(a.position) + Of(b.position)) * 0.5;
  const double size = Length(across) * Length(to_eye);
  return size > 0.0 ? std::abs(Dot(across, to_eye)) / size : 0.0;
}

TEST(SelectFins, AreTheDoubleReference) {
  uint32_t seen = 0, owned = 0;
  for (uint32_t seed = 0; seed < 20; ++seed) {
    const Scene scene = MakeScene(kStrandsPerChunk, seed);
    const FinBlock fins = scene.Run<Ref>();
    for (uint32_t t = 0; t < kStrandsPerChunk; ++t) {
      EXPECT_EQ(fins.fade[t] >> 24, 0u);
      for (uint32_t k = 0; k < 3; ++k) {
        const uint32_t fade = FadeOf(fins, t, k);
        if ((scene.edges.owned[t] >> 8 * k & 255u) == 0) {
          EXPECT_EQ(fade, 0u) << "another triangle's";
          continue;
        }
        const double wanted = 255.0 * std::max(0.0, 2.0 * FacingOf(scene, t, k) - 1.0);
        EXPECT_NEAR(double(fade), wanted, 0.502) << seed << " " << t << " " << k;
        ++owned;
        seen += fade > 0;
      }
    }
  }
  EXPECT_GT(seen, owned / 4);
  EXPECT_LT(seen, 3 * owned / 4);
}

TEST(SelectFins, SameFadesOnEveryVectorAndNoneOfTrianglesThatDoNotLive) {
  for (const uint32_t live : {0u, 1u, 15u, 17u, 64u}) {
    const Scene scene = MakeScene(live, live + 100);
    const FinBlock expected = scene.Run<Ref>();
    for (uint32_t t = live; t < kStrandsPerChunk; ++t) EXPECT_EQ(expected.fade[t], 0u) << t;
    if (live > 1) {
      EXPECT_NE(std::count(expected.fade, expected.fade + live, 0u), int(live)) << live;
    }
    ExpectOnEveryVector(
        expected, [&]<class V> { return scene.Run<V>(); }, live);
  }
}

// The vertices of a halo lie anywhere in the layer's patches.
TEST(SelectFins, StandOnVerticesWhereverTheyLie) {
  Scene scene = MakeScene(64, 9);
  Scattered<ShellVertexBlock> patches(scene.vertices, kVerticesPerChunk, 5);
  ExpectOnEveryVector(
      scene.Run<Ref>(),
      [&]<class V> {
        return OutputOf<SelectFins<V>, FinBlock>(&scene.params, scene.state, scene.triangles,
                                                 scene.edges, patches.Bind());
      },
      "scattered");
}

// The same on every machine and for ever: a frame's digest is made of these.
TEST(SelectFins, KeepTheirBits) {
  if (kStrandsPerChunk != 128) GTEST_SKIP() << "the scene is one of 128 lanes";
  uint64_t digest = 0;
  for (uint32_t seed = 0; seed < 50; ++seed)
    for (const uint32_t fade : MakeScene(100, seed).Run<Ref>().fade)
      digest = (digest ^ fade) * 0x9e3779b97f4a7c15u;
  EXPECT_EQ(digest, 10065496860382361138u);
}

// Edges of every direction all over a sphere, whose fur stands up, seen from far away: the cosine is
// then uniform from -1 to 1. So half of the fins are seen, a quarter is the mean of all fades, and none
// stands within 30 degrees of where the sphere faces the eye.
TEST(SelectFins, StandAtTheOutlineOfASphere) {
  constexpr uint32_t kTriangles = kVerticesPerChunk / 3, kSpheres = 100;
  std::mt19937 random(11);
  double sum = 0.0, seen = 0.0, all = 0.0, least_facing = 1.0;
  for (uint32_t sphere = 0; sphere < kSpheres; ++sphere) {
    Scene scene;
    scene.params.eye[2] = 1000.0f;
    scene.state.live_strands = kTriangles;
    std::vector<Double3> out;
    for (uint32_t t = 0; t < kTriangles; ++t) {
      const Double3 up = RandomUnit(random);
      const Double3 side = Unit(Cross(up, RandomUnit(random)));
      out.push_back(up);
      scene.edges.owned[t] = 255;
      for (uint32_t k = 0; k < 3; ++k) {
        scene.triangles.vertex[k][t] = uint8_t(3 * t + k);
        ShellVertex& vertex = scene.vertices.vertex[3 * t + k];
        Set(vertex.position, up + side * (k == 0 ? 0.02 : k == 1 ? -0.02 : 0.0));
        Set(vertex.groom, up * 0.05);
      }
    }
    const FinBlock fins = scene.Run<Ref>();
    for (uint32_t t = 0; t < kTriangles; ++t) {
      const uint32_t fade = FadeOf(fins, t, 0);
      all += 1.0;
      seen += fade > 0;
      sum += double(fade) / 255.0;
      if (fade > 0) least_facing = std::min(least_facing, 1.0 - std::abs(out[t].z));
    }
  }
  EXPECT_NEAR(seen / all, 0.5, 0.02);
  EXPECT_NEAR(sum / all, 0.25, 0.015);
  EXPECT_GE(least_facing, 1.0 - std::sqrt(0.75) - 1e-3);
}

// From the side a fin is whole, and along its plane it is not there.
TEST(SelectFins, AreWholeFromTheSide) {
  Scene scene;
  scene.state.live_strands = 1;
  scene.triangles.vertex[1][0] = 1;
  scene.triangles.vertex[2][0] = 2;
  scene.edges.owned[0] = 255;
  ShellVertex *a = &scene.vertices.vertex[0], *b = &scene.vertices.vertex[1];
  Set(b->position, {0.1, 0.0, 0.0});
  for (ShellVertex* vertex : {a, b}) {
    Set(vertex->groom, {0.0, 0.02, 0.0});
    Set(vertex->force, {0.0, 0.0, 0.0});
  }
  const auto fade = [&](double x, double y, double z) {
    Set(scene.params.eye, {x, y, z});
    return scene.Run<Ref>().fade[0];
  };
  EXPECT_EQ(fade(0.05, 0.0, 3.0), 255u);
  EXPECT_EQ(fade(0.05, 0.0, -3.0), 255u) << "from either side";
  EXPECT_EQ(fade(0.05, 3.0, 0.0), 0u) << "from above";
  EXPECT_EQ(fade(5.0, 0.0, 0.0), 0u);
  EXPECT_EQ(fade(0.05, 3.0 * std::sqrt(3.0), 3.01), 1u) << "at 60 degrees it begins";
  EXPECT_EQ(fade(0.05, 3.0 * std::sqrt(3.0), 2.99), 0u);
  // Bent over towards the eye the fin lies, and is seen from above.
  for (ShellVertex* vertex : {a, b}) Set(vertex->force, {0.0, -0.02, 0.02});
  EXPECT_EQ(fade(0.05, 3.0, 0.0), 255u);
  EXPECT_EQ(fade(0.05, 0.0, 3.0), 0u);
}

TEST(SelectFins, ThatHaveNoPlaneAreNotThere) {
  const auto none = [](const char* what, auto spoil) {
    Scene scene = MakeScene(kStrandsPerChunk, 5);
    spoil(scene);
    ForEveryVector([&]<class V>(const char* name) {
      const FinBlock fins = scene.Run<V>();
      for (const uint32_t fade : fins.fade) EXPECT_EQ(fade, 0u) << what << " " << name;
    });
  };
  none("bald", [](Scene& s) {
    for (ShellVertex& v : s.vertices.vertex)
      std::fill_n(v.groom, 3, 0.0f), std::fill_n(v.force, 3, 0.0f);
  });
  none("one place", [](Scene& s) {
    for (ShellVertex& v : s.vertices.vertex) std::fill_n(v.position, 3, 0.25f);
  });
  none("hair along the edges", [](Scene& s) {
    for (ShellVertex& v : s.vertices.vertex) {
      v.position[1] = v.position[2] = v.groom[1] = v.groom[2] = 0.0f;
      std::fill_n(v.force, 3, 0.0f);
    }
  });
  none("the eye is on it", [](Scene& s) {
    // From one side of the eye to the other.
    for (uint32_t t = 0; t < kStrandsPerChunk; ++t) {
      for (auto& corner : s.triangles.vertex) corner[t] = 0;
      s.triangles.vertex[1][t] = 1;
      s.edges.owned[t] = 255;
    }
    std::fill_n(s.params.eye, 3, 0.0f);
    for (ShellVertex& v : s.vertices.vertex) v.position[1] = v.position[2] = 0.0f;
    s.vertices.vertex[0].position[0] = 0.125f;
    s.vertices.vertex[1].position[0] = -0.125f;
  });
  none("farther than floats reach", [](Scene& s) {
    for (ShellVertex& v : s.vertices.vertex)
      for (float& p : v.position) p *= 1e20f;
  });
}

}  // namespace
}  // namespace pelt::test
