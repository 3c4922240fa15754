// paint_strands against brute force in double; saturation, order, who is left alone.
#include "core/kernels/paint_strands.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/kernels/run_kernel.hpp"

namespace pelt::test {
namespace {

uint32_t AmountOf(uint32_t word, PaintChannel channel) {
  return word >> 8 * uint32_t(channel) & 255;
}

struct Scene {
  std::vector<PaintBrush> brushes;
  BoundsBlock bounds{};
  RootBlock roots{};
  ChunkStateBlock state{};
  PaintBlock paint{};

  template <class V>
  void Run() {
    const PaintStrandsParams params = MakePaintStrandsParams(brushes);
    RunOnBlocks<PaintStrands<V>>(&params, bounds, roots, state, paint);
  }
  bool IsPainted() const { return (state.flags & kChunkPainted) != 0; }
};

// Roots in a box of a metre, with paint on them already.
Scene MakeScene(uint32_t live, uint32_t seed) {
  Scene scene;
  std::mt19937 random(seed);
  for (int k = 0; k < 3; ++k) scene.bounds.low[k] = -0.5f, scene.bounds.high[k] = 0.5f;
  for (uint32_t s = 0; s < kStrandsPerChunk; ++s) {
    for (auto& axis : scene.roots.position) axis[s] = Uniform(random, -0.5f, 0.5f);
    scene.paint.amounts[s] = uint32_t(random());
  }
  scene.state.live_strands = live;
  scene.state.flags = kChunkVisible;
  return scene;
}

PaintBrush RandomBrush(std::mt19937& random) {
  PaintBrush brush;
  for (float& c : brush.centre) c = Uniform(random, -0.6f, 0.6f);
  brush.radius = Uniform(random, 0.01f, 0.8f);
  brush.hardness = random() % 4 ? Uniform(random, 0.0f, 0.99f) : 1.0f;
  brush.channel = random() % kPaintChannels;
  brush.amount = Uniform(random, -1.0f, 1.0f);
  return brush;
}

// What a brush adds to a strand, before rounding.
double StepOf(const PaintBrush& brush, const RootBlock& roots, uint32_t s) {
  double distance2 = 0.0;
  for (int k = 0; k < 3; ++k) {
    const double apart = double(roots.position[k][s]) - double(brush.centre[k]);
    distance2 += apart * apart;
  }
  const double share2 = distance2 / (double(brush.radius) * double(brush.radius));
  const double hard2 = double(brush.hardness) * double(brush.hardness);
  if (share2 >= 1.0) return 0.0;
  const double falloff = hard2 < 1.0 ? std::min((1.0 - share2) / (1.0 - hard2), 1.0) : 1.0;
  return 255.0 * double(brush.amount) * falloff;
}

TEST(PaintStrands, IsWhatBruteForceGives) {
  uint32_t met = 0, near_half = 0;
  for (uint32_t seed = 0; seed < 400; ++seed) {
    std::mt19937 random(seed);
    Scene scene = MakeScene(1 + seed % kStrandsPerChunk, seed);
    scene.brushes = {RandomBrush(random)};
    const PaintBrush& brush = scene.brushes[0];
    const Scene before = scene;
    scene.Run<ArrayVec<4>>();
    for (uint32_t s = 0; s < kStrandsPerChunk; ++s) {
      const double step = s < scene.state.live_strands ? StepOf(brush, scene.roots, s) : 0.0;
      const int old = int(AmountOf(before.paint.amounts[s], PaintChannel(brush.channel)));
      const int now = int(AmountOf(scene.paint.amounts[s], PaintChannel(brush.channel)));
      const int wanted = std::clamp(old + int(std::lround(step)), 0, 255);
      const bool is_near_half = std::abs(std::abs(step - std::trunc(step)) - 0.5) < 1e-2;
      ASSERT_LE(std::abs(now - wanted), is_near_half ? 1 : 0) << seed << " strand " << s;
      const uint32_t others = ~(255u << 8 * brush.channel);
      ASSERT_EQ(scene.paint.amounts[s] & others, before.paint.amounts[s] & others);
      met += std::abs(step) >= 0.5;
      near_half += is_near_half;
    }
  }
  EXPECT_GT(met, 20u * kStrandsPerChunk);
  EXPECT_LT(near_half, met / 20);
}

TEST(PaintStrands, SameAmountsOnEveryVector) {
  for (const uint32_t live : {1u, 15u, 17u, 64u}) {
    std::mt19937 random(live);
    Scene scene = MakeScene(live, live);
    for (uint32_t b = 0; b < kBrushesPerScene; ++b) scene.brushes.push_back(RandomBrush(random));
    Scene expected = scene;
    expected.Run<ArrayVec<4>>();
    EXPECT_TRUE(expected.IsPainted());
    ForEveryVector([&]<class V>(const char* name) {
      Scene found = scene;
      found.Run<V>();
      EXPECT_EQ(std::memcmp(&found.paint, &expected.paint, sizeof(PaintBlock)), 0) << name;
      EXPECT_EQ(found.state.flags, expected.state.flags) << name;
    });
  }
}

// A ball that holds every root.
PaintBrush Everywhere(PaintChannel channel, float amount) {
  return {{0, 0, 0}, 10.0f, 1.0f, uint32_t(channel), amount};
}

TEST(PaintStrands, AmountsStayWithinTheirByte) {
  for (uint32_t c = 0; c < kPaintChannels; ++c) {
    const auto channel = PaintChannel(c);
    Scene scene = MakeScene(kStrandsPerChunk, c);
    const PaintBlock before = scene.paint;
    for (const auto& [amount, end] : {std::pair(0.7f, 255u), {-0.7f, 0u}}) {
      scene.brushes = {Everywhere(channel, amount)};
      for (int frame = 0; frame < 2; ++frame) scene.Run<ArrayVec<4>>();
      for (uint32_t s = 0; s < kStrandsPerChunk; ++s) {
        ASSERT_EQ(AmountOf(scene.paint.amounts[s], channel), end);
        ASSERT_EQ((scene.paint.amounts[s] ^ before.amounts[s]) & ~(255u << 8 * c), 0u);
      }
    }
  }
}

TEST(PaintStrands, WhatWasAddedIsTakenAwayAgain) {
  Scene scene = MakeScene(kStrandsPerChunk, 5);
  for (uint32_t& word : scene.paint.amounts) word = 0x40404040u;
  const PaintBlock before = scene.paint;
  PaintBrush brush{{0.1f, 0, 0}, 0.6f, 0.25f, uint32_t(PaintChannel::kSnow), 0.4f};
  scene.brushes = {brush};
  scene.Run<ArrayVec<4>>();
  EXPECT_NE(std::memcmp(&scene.paint, &before, sizeof before), 0);
  scene.brushes[0].amount = -brush.amount;
  scene.Run<ArrayVec<4>>();
  EXPECT_EQ(std::memcmp(&scene.paint, &before, sizeof before), 0);
}

// The last has its way; of one channel alone.
TEST(PaintStrands, BrushesActInTheirOrder) {
  const PaintBrush add = Everywhere(PaintChannel::kWet, 1.0f);
  const PaintBrush take = Everywhere(PaintChannel::kWet, -0.5f);
  for (const bool add_last : {false, true}) {
    Scene scene = MakeScene(16, 3);
    scene.brushes = {take, add};
    if (!add_last) std::swap(scene.brushes[0], scene.brushes[1]);
    scene.Run<ArrayVec<4>>();
    for (uint32_t s = 0; s < 16; ++s)
      EXPECT_EQ(AmountOf(scene.paint.amounts[s], PaintChannel::kWet), add_last ? 255u : 127u);
  }
}

TEST(PaintStrands, ABrushElsewhereTouchesNothing) {
  Scene scene = MakeScene(kStrandsPerChunk, 7);
  scene.brushes = {{{2.0f, 0, 0}, 1.5f, 1.0f, 0, 1.0f}};  // a decimetre off
  scene.bounds.high[0] = 0.4f;
  // These roots lie in the brush though their box does not: a kernel that read them would paint.
  std::fill_n(scene.roots.position[0], kStrandsPerChunk, 2.0f);
  const PaintBlock before = scene.paint;
  scene.Run<ArrayVec<4>>();
  EXPECT_EQ(std::memcmp(&scene.paint, &before, sizeof before), 0);
  EXPECT_FALSE(scene.IsPainted());
}

TEST(PaintStrands, IsPaintedOnlyIfAnAmountChanges) {
  Scene scene = MakeScene(kStrandsPerChunk, 8);
  for (uint32_t& word : scene.paint.amounts) word = 0xff000000u;
  scene.brushes = {Everywhere(PaintChannel::kDust, 1.0f)};
  scene.Run<ArrayVec<4>>();
  EXPECT_FALSE(scene.IsPainted());
  scene.brushes.push_back(Everywhere(PaintChannel::kMud, 0.0019f));  // less than half a byte
  scene.Run<ArrayVec<4>>();
  EXPECT_FALSE(scene.IsPainted());
  scene.brushes.push_back(Everywhere(PaintChannel::kMud, 0.002f));
  scene.Run<ArrayVec<4>>();
  EXPECT_TRUE(scene.IsPainted());
}

TEST(PaintStrands, BrushesOfNothingAreLeftOut) {
  const PaintBrush nothing[] = {{{0, 0, 0}, 1.0f, 0.0f, 0, 0.0f}, {{0, 0, 0}, 0.0f, 0.0f, 0, 1.0f}};
  EXPECT_EQ(MakePaintStrandsParams(nothing).count, 0u);
}

}  // namespace
}  // namespace pelt::test
