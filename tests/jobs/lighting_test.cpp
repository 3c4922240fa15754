// Lit layers in whole frames: which have a light block, when it is made again, and that leaving it
// out changes no bit. The block's numbers are tests/kernels/light_layer_test.cpp's.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/jobs/tiny_scene.hpp"

namespace pelt::testing {
namespace {

constexpr Stream kStream = StreamOf<&Streams::layer_light>;
// What lit layers have and others have not: light, looks, paint, looks of painted ones.
constexpr uint32_t kStages = 4;
bool IsOfLight(Stream stream) {
  return stream == kStream || stream == StreamOf<&Streams::looks> ||
         stream == StreamOf<&Streams::paint>;
}

// Lit layers, on their course until `rest_from`.
struct LitRun {
  explicit LitRun(const SkipSettings& skip, uint32_t rest_from = ~0u) : skip(skip) {
    scenario.actors[0].teleport_frame = -1;
    scenario.rest_from_frame = rest_from;
  }
  void Run() {
    FrameInput input = running.Prepare(frame++, skip, {});
    input.lighting = lighting;
    RunInput(running.scene(), input);
  }
  // Layers that were lit by the last frame.
  uint32_t CountLit() {
    const FurScene& scene = running.scene();
    uint32_t count = 0;
    for (const Stage& stage : scene.plan().stages)
      if (stage.kernel.name == "light_layer")
        for (uint32_t l = 0; l < scene.shape().layer_count; ++l)
          count += IsWanted(stage, scene.memory(), l);
    return count;
  }
  uint64_t Digest() { return running.scene().DigestStream(kStream); }

  SkipSettings skip;
  Scenario scenario = EveryOutputScenario();
  RunningScenario running{scenario, {}};
  Lighting lighting = TinyLighting();
  uint32_t frame = 0;
};

uint32_t CountLitLayers(const SceneShape& shape) {
  uint32_t count = 0;
  for (const uint32_t kind : shape.layer_kind) count += (kind & kLayerLit) != 0;
  return count;
}

TEST(LitLayers, AreLitAndNoOthers) {
  LitRun run({});
  run.Run();
  const FurScene& scene = run.running.scene();
  const uint32_t lit = CountLitLayers(scene.shape());
  EXPECT_EQ(run.CountLit(), lit);
  EXPECT_GT(lit, 0u);
  EXPECT_LT(lit, scene.shape().layer_count);
  for (uint32_t l = 0; l < scene.shape().layer_count; ++l) {
    const auto& block = *scene.memory().Of<&Streams::layer_light>(l);
    EXPECT_EQ(block.ambient[0] > 0.0f, (scene.shape().layer_kind[l] & kLayerLit) != 0) << l;
  }
}

// Stages lie between others of their kind: no barrier is added, and without a lit layer there are
// neither stages nor memory.
TEST(LitLayers, CostNoBarrierAndOthersNothing) {
  Scenario dark = TinyScenario(), lit = LitScenario();
  // Whose colours weather leaves alone where they are painted.
  dark.weather_course = lit.weather_course = {};
  lit.base.brush_count = 0;
  RunningScenario without(dark, {}), with(lit, {});
  EXPECT_EQ(with.scene().plan().passes.size(), without.scene().plan().passes.size());
  EXPECT_EQ(with.scene().plan().stages.size(), without.scene().plan().stages.size() + kStages);
  EXPECT_EQ(without.scene().layout().ranges[size_t(kStream)].bytes, 0u);
  EXPECT_EQ(without.scene().memory().Block(kStream, 0), nullptr);
  // Light and paint change nothing else.
  for (uint32_t f = 0; f < 3; ++f) {
    RunFrame(with, f);
    RunFrame(without, f);
    for (uint32_t s = 0; s < kStreamCount; ++s)
      if (!IsOfLight(Stream(s))) {
        EXPECT_EQ(with.scene().DigestStream(Stream(s)), without.scene().DigestStream(Stream(s)))
            << DescribeStream(Stream(s)).name;
      }
  }
}

TEST(LitLayers, AreLeftAloneWhileNothingMoves) {
  constexpr uint32_t kRest = 3;
  LitRun lazy({}, kRest), eager({.light = false}, kRest);
  for (uint32_t f = 0; f < 12; ++f) {
    if (f == 6) lazy.lighting.light[0].rgb[1] += 0.25f;
    if (f == 8) lazy.lighting.light_count = 1;
    if (f == 10) lazy.lighting.sun_rgb[2] = 0.0f;
    eager.lighting = lazy.lighting;
    const uint64_t before = lazy.Digest();
    lazy.Run();
    eager.Run();
    ASSERT_EQ(lazy.running.scene().DigestFrame(), eager.running.scene().DigestFrame()) << f;
    const uint32_t all = CountLitLayers(lazy.running.scene().shape());
    EXPECT_EQ(eager.CountLit(), all);
    const bool changed = f <= kRest || f == 6 || f == 8 || f == 10;
    EXPECT_EQ(lazy.CountLit(), changed ? all : 0u) << f;
    if (f > kRest) {
      EXPECT_EQ(lazy.Digest() != before, changed) << f;
    }
  }
}

// Nothing uses what lies behind the counts.
TEST(LitLayers, EntriesThatDoNotCountAreNotLookedAt) {
  LitRun run({}, 1);
  for (uint32_t f = 0; f < 4; ++f) run.Run();
  EXPECT_EQ(run.CountLit(), 0u);
  run.lighting.light[run.lighting.light_count].radius = NAN;
  run.lighting.sample[run.lighting.sample_count].falloff = NAN;
  run.Run();
  EXPECT_EQ(run.CountLit(), 0u);
}

// Sleepers do not wake for it.
TEST(LitLayers, ALightDoesNotWakeAnybody) {
  LitRun run({}, 6);
  while (CountChunks(run.running.scene(), kChunkSimulate) != 0 || run.frame < 8) {
    ASSERT_LT(run.frame, 2000u);
    run.Run();
  }
  run.lighting.light[0].position[1] += 0.5f;
  run.Run();
  EXPECT_GT(run.CountLit(), 0u);
  EXPECT_EQ(CountChunks(run.running.scene(), kChunkSimulate), 0u);
  run.Run();
  EXPECT_EQ(CountChunks(run.running.scene(), kChunkSimulate), 0u);
}

}  // namespace
}  // namespace pelt::testing
