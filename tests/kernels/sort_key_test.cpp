// Sort keys against a double reference: order, back faces, dead lanes, and what is reported.
#include "core/kernels/sort_key.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/kernels/run_kernel.hpp"

namespace pelt::test {
namespace {

template <uint32_t kPoints>
struct World {
  Blocks<LayerBlock> layer{1, 0};
  Blocks<ChunkStateBlock> state{1, 0};
  Blocks<RootBlock> roots{1};
  Blocks<PointBlock<kPoints>> points{1};
  Blocks<SortKeyBlock> keys{1, 0};
  SortKeyParams params{{0.5f, 1.0f, 4.0f}, {0.0f, 0.6f, -0.8f}};

  explicit World(uint32_t seed, uint32_t live = kStrandsPerChunk) {
    std::mt19937 random(seed);
    layer[0].flags = kLayerBackFaceCull;
    layer[0].backface_tolerance = 0.2f;
    layer[0].sort_place = 0.75f;
    state[0].flags = kChunkVisible;
    state[0].live_strands = live;
    for (uint32_t s = 0; s < kStrandsPerChunk; ++s) {
      double n[3], length = 0.0;
      for (int a = 0; a < 3; ++a) {
        roots[0].position[a][s] = Uniform(random, -1.0f, 1.0f);
        n[a] = Uniform(random, -1.0f, 1.0f);
        length += n[a] * n[a];
        for (uint32_t i = 0; i + 1 < kPoints; ++i)
          points[0].position[i][a][s] = Uniform(random, -1.5f, 1.5f);
      }
      for (int a = 0; a < 3; ++a) roots[0].normal[a][s] = float(n[a] / std::sqrt(length));
    }
  }
  template <class V = ArrayVec<4>>
  void Run() {
    RunKernel<SortKey<V, kPoints>>(
        params, {layer.Bind(), state.Bind(), roots.Bind(), points.Bind(), keys.Bind()});
  }
  double Depth(uint32_t s) const {
    double depth = 0.0;
    const double along = double(layer[0].sort_place) * (kPoints - 1);
    const uint32_t from = std::min(uint32_t(along), kPoints - 2);
    for (int a = 0; a < 3; ++a) {
      const auto point = [&](uint32_t i) {
        return double(i == 0 ? roots[0].position[a][s] : points[0].position[i - 1][a][s]);
      };
      const double p = point(from) + (along - from) * (point(from + 1) - point(from));
      depth += (p - params.eye[a]) * params.forward[a];
    }
    return depth;
  }
  double Facing(uint32_t s) const {
    double dot = 0.0, length = 0.0;
    for (int a = 0; a < 3; ++a) {
      const double to_eye = double(params.eye[a]) - roots[0].position[a][s];
      dot += to_eye * roots[0].normal[a][s];
      length += to_eye * to_eye;
    }
    return dot / std::sqrt(length);
  }
};

template <uint32_t kPoints>
void CheckAgainstReference() {
  uint32_t drawn = 0, culled = 0;
  constexpr float kPlaces[] = {0.75f, 0.0f, 1.0f, 0.4f, 0.9f};
  for (uint32_t seed = 0; seed < 50; ++seed) {
    World<kPoints> w(seed);
    w.layer[0].sort_place = kPlaces[seed % 5];
    w.Run();
    for (uint32_t s = 0; s < kStrandsPerChunk; ++s) {
      const double margin = w.Facing(s) + 0.2;
      if (std::abs(margin) > 1e-5) {
        EXPECT_EQ(w.keys[0].key[s] == kCulledKey, margin < 0.0) << s;
      }
      (w.keys[0].key[s] == kCulledKey ? culled : drawn)++;
      for (uint32_t t = 0; t < s; ++t) {
        if (w.keys[0].key[s] == kCulledKey || w.keys[0].key[t] == kCulledKey) continue;
        if (std::abs(w.Depth(s) - w.Depth(t)) < 1e-5) continue;
        EXPECT_EQ(w.Depth(s) > w.Depth(t), w.keys[0].key[s] < w.keys[0].key[t]);
      }
    }
  }
  EXPECT_GT(drawn, 1000u);
  EXPECT_GT(culled, 1000u);
}

TEST(SortKey, AgreesWithDoubleReferenceOnFourPoints) { CheckAgainstReference<4>(); }
TEST(SortKey, AgreesWithDoubleReferenceOnFivePoints) { CheckAgainstReference<5>(); }
TEST(SortKey, AgreesWithDoubleReferenceOnNinePoints) { CheckAgainstReference<9>(); }

TEST(SortKey, KeysAreMonotoneOverAllFloats) {
  using V = ArrayVec<4>;
  std::mt19937 random(7);
  for (int i = 0; i < 200000; ++i) {
    uint32_t bits[2] = {uint32_t(random()), uint32_t(random())};
    float x[2];
    std::memcpy(x, bits, sizeof x);
    if (!std::isfinite(x[0]) || !std::isfinite(x[1])) continue;
    const uint32_t a = uint32_t(FarToNearKey(V(x[0]))[0]), b = uint32_t(FarToNearKey(V(x[1]))[0]);
    EXPECT_EQ(x[0] > x[1], a < b);
    EXPECT_EQ(x[0] == x[1], a == b);
    EXPECT_NE(a, kCulledKey);
  }
  EXPECT_EQ(FarToNearKey(V(0.0f))[0], FarToNearKey(V(-0.0f))[0]);
}

TEST(SortKey, DeadLanesAreCulledUpToTheCapacity) {
  for (uint32_t live : {0u, 1u, 15u, 16u, 17u, kStrandsPerChunk - 1, kStrandsPerChunk}) {
    World<4> w(3, live);
    w.layer[0].flags = 0;
    w.Run();
    for (uint32_t s = 0; s < kStrandsPerChunk; ++s)
      EXPECT_EQ(w.keys[0].key[s] == kCulledKey, s >= live);
    EXPECT_EQ(w.state[0].visible_strands, live);
  }
}

TEST(SortKey, StrandsThatAreCutOffAreCulled) {
  ForEveryVector([]<class V>(const char* name) {
    World<5> w(4);
    w.layer[0].flags = 0;
    const auto is_cut = [](uint32_t s) { return s % 5 == 2 || s == 31 || s == 32; };
    uint32_t cut = 0;
    for (uint32_t s = 0; s < kStrandsPerChunk; ++s)
      if (is_cut(s)) w.state[0].cut[s / 32] |= 1u << s % 32, ++cut;
    w.template Run<V>();
    for (uint32_t s = 0; s < kStrandsPerChunk; ++s)
      EXPECT_EQ(w.keys[0].key[s] == kCulledKey, is_cut(s)) << name << ' ' << s;
    EXPECT_EQ(w.state[0].visible_strands, kStrandsPerChunk - cut);
    for (uint32_t& word : w.state[0].cut) word = 0;
    w.template Run<V>();
    EXPECT_EQ(w.state[0].visible_strands, kStrandsPerChunk);
    EXPECT_EQ(w.state[0].keys_changed, 1u);
  });
}

TEST(SortKey, WithoutBackFaceCullingEveryLiveStrandIsDrawn) {
  World<5> w(11);
  w.Run();
  EXPECT_LT(w.state[0].visible_strands, kStrandsPerChunk);
  w.layer[0].flags = 0;
  w.Run();
  EXPECT_EQ(w.state[0].visible_strands, kStrandsPerChunk);
}

TEST(SortKey, ReportsChangeExactlyWhenAKeyChanged) {
  World<4> w(5, 60);
  w.Run();
  EXPECT_EQ(w.state[0].keys_changed, 1u);
  w.Run();
  EXPECT_EQ(w.state[0].keys_changed, 0u);
  w.state[0].live_strands = 59;
  w.keys[0].key[59] = 12345;  // a drawn strand dies
  w.Run();
  EXPECT_EQ(w.state[0].keys_changed, 1u);
  w.Run();
  EXPECT_EQ(w.state[0].keys_changed, 0u);
  w.layer[0].flags = 0;
  w.Run();
  w.points[0].position[1][2][58] += 1e-3f;
  w.Run();
  EXPECT_EQ(w.state[0].keys_changed, 1u);
  w.state[0].flags |= kChunkRestart;  // last frame's keys are from some other time
  w.Run();
  EXPECT_EQ(w.state[0].keys_changed, 1u);
}

// Also where no lane that is still alive has another key.
TEST(SortKey, FewerLiveStrandsAreAChange) {
  for (const uint32_t live : {kLaneGroup, kStrandsPerChunk / 2, kStrandsPerChunk - kLaneGroup}) {
    World<4> w(5);
    w.layer[0].flags = 0;
    w.Run();
    w.Run();
    EXPECT_EQ(w.state[0].keys_changed, 0u);
    w.state[0].live_strands = live;
    w.Run();
    EXPECT_EQ(w.state[0].keys_changed, 1u) << live;
  }
}

TEST(SortKey, NoInputGivesTheCulledKeyByAccident) {
  World<5> w(1);
  w.layer[0].flags = 0;
  const float huge = std::numeric_limits<float>::max();
  for (uint32_t s = 0; s < kStrandsPerChunk; ++s) {
    w.points[0].position[2][1][s] = s % 2 ? huge : -huge;
    w.points[0].position[2][2][s] = s % 3 ? huge : -huge;
    if (s % 5 == 0) w.points[0].position[2][0][s] = std::nanf("");
  }
  w.Run();
  for (uint32_t s = 0; s < kStrandsPerChunk; ++s) EXPECT_NE(w.keys[0].key[s], kCulledKey);
  EXPECT_EQ(w.state[0].visible_strands, kStrandsPerChunk);
}

TEST(SortKey, AStrandAtTheEyeIsDrawn) {
  World<4> w(1);
  for (int a = 0; a < 3; ++a) w.roots[0].position[a][6] = w.params.eye[a];
  w.Run();
  EXPECT_NE(w.keys[0].key[6], kCulledKey);
}

TEST(SortKey, SameBitsOnEveryVector) {
  ForEveryVector([]<class V>(const char* name) {
    for (uint32_t live : {1u, 37u, 60u, kStrandsPerChunk})
      for (const uint32_t points : {4u, 5u, 9u})
        WithPoints(points, [&]<uint32_t kPoints> {
          World<kPoints> world(live, live), reference(live, live);
          world.template Run<V>();
          reference.template Run<ArrayVec<4>>();
          EXPECT_TRUE(world.keys.SameBits(reference.keys)) << name << ' ' << points;
          EXPECT_TRUE(world.state.SameBits(reference.state)) << name << ' ' << points;
        });
  });
}

}  // namespace
}  // namespace pelt::test
