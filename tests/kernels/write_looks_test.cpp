// write_looks: what its records say, read back as a shader reads them.
#include "core/kernels/write_looks.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <set>

#include "tests/kernels/run_kernel.hpp"

namespace pelt::test {
namespace {

struct Scene {
  LayerBlock layer{};
  ChunkStateBlock state{};
  StrandUvBlock uv{};
  RootBlock roots{};
  PaintBlock paint{};

  template <class V>
  LookBlock Run() {
    return OutputOf<WriteLooks<V, false>, LookBlock>(nullptr, layer, state, uv, roots);
  }
  template <class V>
  LookBlock RunPainted() {
    return OutputOf<WriteLooks<V, true>, LookBlock>(nullptr, layer, state, uv, roots, paint);
  }
};

Scene MakeScene(uint32_t live, uint32_t seed) {
  Scene scene;
  std::mt19937 random(seed);
  scene.state.live_strands = live;
  scene.state.first_place = seed * kStrandsPerChunk;
  for (uint32_t s = 0; s < kStrandsPerChunk; ++s) {
    double n[3], length = 0.0;
    for (double& c : n) c = double(Uniform(random, -1.0f, 1.0f));
    length = std::hypot(n[0], n[1], n[2]);
    for (int axis = 0; axis < 3; ++axis) scene.roots.normal[axis][s] = float(n[axis] / length);
    scene.uv.uv[s] = uint32_t(random());
    scene.paint.amounts[s] = uint32_t(random());
  }
  return scene;
}

// As a shader does it: unpackSnorm2x16, unfold, normalise.
void Decode(uint32_t packed, double (&n)[3]) {
  const auto part = [](uint32_t bits) {
    return double(std::bit_cast<int16_t>(uint16_t(bits))) / 32767.0;
  };
  double x = part(packed & 0xffffu), y = part(packed >> 16);
  const double z = 1.0 - std::abs(x) - std::abs(y), fold = std::max(-z, 0.0);
  x += x >= 0.0 ? -fold : fold;
  y += y >= 0.0 ? -fold : fold;
  const double length = std::hypot(x, y, z);
  n[0] = x / length, n[1] = y / length, n[2] = z / length;
}

void ExpectNormals(const Scene& scene, const LookBlock& looks, uint32_t live) {
  for (uint32_t s = 0; s < live; ++s) {
    double n[3];
    Decode(looks.record[s].normal, n);
    for (int axis = 0; axis < 3; ++axis)
      ASSERT_NEAR(n[axis], double(scene.roots.normal[axis][s]), 1e-4) << s << " " << axis;
  }
}

TEST(WriteLooks, NormalsComeBackFromTheirWord) {
  for (uint32_t seed = 0; seed < 80; ++seed) {
    Scene scene = MakeScene(kStrandsPerChunk, seed);
    ExpectNormals(scene, scene.Run<ArrayVec<4>>(), kStrandsPerChunk);
  }
}

TEST(WriteLooks, AxesAndSeamsComeBackToo) {
  Scene scene = MakeScene(kStrandsPerChunk, 1);
  uint32_t s = 0;
  for (const float z : {-1.0f, -0.0f, 0.0f, 1.0f})
    for (const float y : {-1.0f, -0.0f, 0.0f, 1.0f})
      for (const float x : {-1.0f, -0.0f, 0.0f, 1.0f}) {
        const float length = std::hypot(x, y, z);
        if (length == 0.0f) continue;
        const float n[] = {x / length, y / length, z / length};
        for (int axis = 0; axis < 3; ++axis) scene.roots.normal[axis][s] = n[axis];
        ++s;
      }
  ASSERT_LE(s, kStrandsPerChunk);
  ExpectNormals(scene, scene.Run<ArrayVec<4>>(), s);
}

TEST(WriteLooks, HandsOnPlacesAndWetness) {
  Scene scene = MakeScene(kStrandsPerChunk, 2);
  for (const auto& [wetness, byte] : {std::pair(0.0f, 0u), {0.5f, 128u}, {1.0f, 255u}}) {
    scene.layer.wetness = wetness;
    const LookBlock looks = scene.Run<ArrayVec<4>>();
    for (uint32_t s = 0; s < kStrandsPerChunk; ++s) {
      EXPECT_EQ(looks.record[s].uv, scene.uv.uv[s]);
      EXPECT_EQ(looks.record[s].amounts, byte << 16);
    }
  }
}

// What brushes left, or what weather brings, whichever is more; the rest of the record is the same.
TEST(WriteLooks, PaintAndWeatherAreOnStrandsTogether) {
  Scene scene = MakeScene(kStrandsPerChunk, 3);
  scene.layer.wetness = 0.5f;  // 128
  scene.layer.dirt = 0.2f;     // 51
  const LookBlock looks = scene.RunPainted<ArrayVec<4>>(), plain = scene.Run<ArrayVec<4>>();
  uint32_t more = 0;
  for (uint32_t s = 0; s < kStrandsPerChunk; ++s) {
    const uint32_t paint = scene.paint.amounts[s], found = looks.record[s].amounts;
    EXPECT_EQ(found & 255, std::max(paint & 255, 51u));
    EXPECT_EQ(found >> 16 & 255, std::max(paint >> 16 & 255, 128u));
    EXPECT_EQ(found & 0xff00ff00u, paint & 0xff00ff00u);
    more += (paint >> 16 & 255) > 128;
    EXPECT_EQ(looks.record[s].normal, plain.record[s].normal);
    EXPECT_EQ(looks.record[s].uv, plain.record[s].uv);
    EXPECT_EQ(looks.record[s].random, plain.record[s].random);
  }
  // What brings one of them alone; and nothing does.
  scene.layer.wetness = 0.0f;
  EXPECT_EQ(scene.RunPainted<ArrayVec<4>>().record[0].amounts & 255,
            std::max(scene.paint.amounts[0] & 255, 51u));
  scene.layer.dirt = 0.0f;
  const LookBlock fair = scene.RunPainted<ArrayVec<4>>();
  for (uint32_t s = 0; s < kStrandsPerChunk; ++s)
    EXPECT_EQ(fair.record[s].amounts, scene.paint.amounts[s]);
  EXPECT_GT(more, 0u);
  EXPECT_LT(more, kStrandsPerChunk);
}

// No two strands of a layer have the same, every bit is set in half of them, and it stays.
TEST(WriteLooks, EveryStrandHasANumberOfItsOwn) {
  constexpr uint32_t kChunks = 64;
  std::set<uint32_t> seen;
  uint32_t set_bits[32] = {};
  for (uint32_t c = 0; c < kChunks; ++c) {
    const LookBlock looks = MakeScene(kStrandsPerChunk, c).Run<ArrayVec<4>>();
    const LookBlock fewer = MakeScene(16, c).Run<ArrayVec<4>>();
    EXPECT_EQ(looks.record[5].random, fewer.record[5].random);
    for (const LookRecord& record : looks.record) {
      seen.insert(record.random);
      for (int b = 0; b < 32; ++b) set_bits[b] += record.random >> b & 1;
    }
  }
  constexpr uint32_t kAll = kChunks * kStrandsPerChunk;
  EXPECT_EQ(seen.size(), kAll);
  for (const uint32_t count : set_bits) EXPECT_NEAR(double(count) / kAll, 0.5, 0.03);
}

TEST(WriteLooks, SameRecordsOnEveryVector) {
  for (const uint32_t live : {1u, 15u, 17u, 64u}) {
    Scene scene = MakeScene(live, live);
    scene.layer.wetness = 0.3f;
    scene.layer.dirt = 0.6f;
    ExpectOnEveryVector(
        scene.Run<ArrayVec<4>>(), [&]<class V> { return scene.Run<V>(); }, live);
    ExpectOnEveryVector(
        scene.RunPainted<ArrayVec<4>>(), [&]<class V> { return scene.RunPainted<V>(); }, live);
  }
}

}  // namespace
}  // namespace pelt::test
