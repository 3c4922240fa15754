// LOD: a prefix of every chunk, in its share, within its budget, and bit for bit what the full
// scene has for those strands.
#include <gtest/gtest.h>

#include <cstring>

#include "jobs/scene.hpp"
#include "tests/jobs/tiny_scene.hpp"

namespace pelt {
namespace {

using namespace testing;

// ---- LOD ----------------------------------------------------------------------------------------

// A layer far too small on the screen for its strands, held at `fraction`.
LodSettings HeldAt(float fraction) { return {1e9f, fraction, 0.0f, 0.0f, 0}; }

TEST(FurSceneLod, APrefixKeepsTheBitsOfTheFullRun) {
  Scenario scenario = TinyScenario();
  RunningScenario full(scenario, {}), half(scenario, {});
  SkipSettings lod_on;
  lod_on.lod = true;
  SerialExecutor serial;
  for (uint32_t f = 0; f < 24; ++f) {
    full.Begin(f, {}, {});
    serial.Run(full.scene().CurrentFrame());
    half.Begin(f, lod_on, HeldAt(0.5f));
    serial.Run(half.scene().CurrentFrame());
  }
  const FurScene &a = full.scene(), &b = half.scene();
  uint32_t compared = 0;
  for (uint32_t c = 0; c < a.shape().chunk_count; ++c) {
    const uint32_t strands = a.memory().Of<&Streams::strands>(c)->strand_count;
    const uint32_t live = b.LiveLanes(StreamOf<&Streams::roots>, c);
    EXPECT_EQ(live, (strands + 1) / 2);
    const auto same = [&](Stream stream, uint32_t rows) {
      const auto *p = a.memory().As<uint32_t>(stream, c), *q = b.memory().As<uint32_t>(stream, c);
      if (!p) return;
      for (uint32_t row = 0; row < rows; ++row)
        ASSERT_EQ(std::memcmp(p + row * kStrandsPerChunk, q + row * kStrandsPerChunk,
                              4 * b.LiveLanes(stream, c)),
                  0)
            << DescribeStream(stream).name << " of chunk " << c << ", row " << row;
      ++compared;
    };
    same(StreamOf<&Streams::roots>, 12);
    same(StreamOf<&Streams::vertex_points>, 9);
    same(StreamOf<&Streams::strand_points4>, 9);
    same(StreamOf<&Streams::strand_points5>, 12);
    if (const auto* p = a.memory().Of<&Streams::curves>(c)) {
      EXPECT_EQ(std::memcmp(p, b.memory().Of<&Streams::curves>(c), live * sizeof(CurveRecord)), 0);
    }
  }
  EXPECT_GE(compared, 2 * a.shape().chunk_count);
}

TEST(FurSceneLod, DrawsItsShareOfEveryChunk) {
  Scenario scenario = TinyScenario();
  SkipSettings lod_on;
  lod_on.lod = true;
  for (const float fraction : {0.05f, 0.25f, 0.8f, 1.0f}) {
    RunningScenario running(scenario, {});
    running.Begin(0, lod_on, HeldAt(fraction));
    SerialExecutor().Run(running.scene().CurrentFrame());
    const double wanted = double(fraction) * double(scenario.StrandCount());
    EXPECT_GE(running.scene().LiveStrands(), wanted * 0.999);
    EXPECT_LE(running.scene().LiveStrands(), wanted + running.scene().shape().chunk_count);
  }
}

TEST(FurSceneLod, KeepsToItsBudget) {
  Scenario scenario = TinyScenario();
  SkipSettings lod_on;
  lod_on.lod = true;
  LodSettings lod;
  lod.full_detail_px = 0.0f;
  lod.hysteresis = 0.0f;
  lod.strand_budget = 200;
  RunningScenario running(scenario, {});
  SerialExecutor serial;
  for (uint32_t f = 0; f < 10; ++f) {
    running.Begin(f, lod_on, lod);
    serial.Run(running.scene().CurrentFrame());
    // The budget acts on what the frame before measured.
    if (f > 0) {
      EXPECT_LE(running.scene().LiveStrands(), 200 + running.scene().shape().chunk_count) << f;
    }
  }
  EXPECT_GE(running.scene().LiveStrands(), 180u);
}

// Strands that come back while the rest runs start from their groom; nothing else notices.
TEST(FurSceneLod, GrowingBackDisturbsNoStrandThatWasThere) {
  Scenario scenario = TinyScenario();
  RunningScenario full(scenario, {}), grown(scenario, {});
  SkipSettings lod_on;
  lod_on.lod = true;
  SerialExecutor serial;
  for (uint32_t f = 0; f < 8; ++f) {
    full.Begin(f, {}, {});
    serial.Run(full.scene().CurrentFrame());
    grown.Begin(f, lod_on, HeldAt(f < 4 ? 0.5f : 1.0f));
    serial.Run(grown.scene().CurrentFrame());
  }
  const FurScene &a = full.scene(), &b = grown.scene();
  EXPECT_EQ(a.LiveStrands(), b.LiveStrands());
  for (uint32_t c = 0; c < a.shape().chunk_count; ++c) {
    const auto* p = a.memory().Of<&Streams::strand_points4>(c);
    if (!p || (a.shape().layer_kind[a.shape().chunk_layer[c]] & kLayerVertexChains)) continue;
    const auto* q = b.memory().Of<&Streams::strand_points4>(c);
    const uint32_t strands = a.memory().Of<&Streams::strands>(c)->strand_count;
    for (uint32_t i = 0; i < (strands + 1) / 2; ++i)
      EXPECT_EQ(std::memcmp(&p->position[2][0][i], &q->position[2][0][i], 4), 0) << c << ' ' << i;
  }
}

}  // namespace
}  // namespace pelt
