// Painted layers in whole frames: who is painted and when, that it is state, and that weather is in
// the looks of strands as paint is. The amounts are tests/kernels/paint_strands_test.cpp's.
#include <gtest/gtest.h>

#include "core/groom/groom_file.hpp"
#include "tests/jobs/tiny_scene.hpp"
#include "traces/input_log.hpp"

namespace pelt::testing {
namespace {

constexpr Stream kPaint = StreamOf<&Streams::paint>, kLooks = StreamOf<&Streams::looks>;

// On its course until `rest_from`, with the brushes that the test gives it.
struct PaintedRun {
  explicit PaintedRun(uint32_t rest_from = ~0u, const SkipSettings& skip = {},
                      const SceneOptions& options = {})
      : skip(skip), running(scenario, options) {
    scenario.actors[0].teleport_frame = -1;
    scenario.rest_from_frame = rest_from;
    scenario.base.brush_count = 0;
  }
  void Run(const std::vector<PaintBrush>& brushes = {}) {
    input = running.Prepare(frame++, skip, lod);
    input.brush_count = uint32_t(brushes.size());
    std::copy(brushes.begin(), brushes.end(), input.brush);
    RunInput(scene(), input);
  }
  void RunUntilAsleep() {
    while (frame < 8 || CountChunks(scene(), kChunkSimulate) != 0) {
      ASSERT_LT(frame, 2000u);
      Run();
    }
  }
  uint32_t CountItems(std::string_view stage_name) {
    uint32_t count = 0;
    for (const Stage& stage : scene().plan().stages)
      if (stage.kernel.name == stage_name)
        for (uint32_t c = 0; c < scene().shape().chunk_count; ++c)
          count += IsWanted(stage, scene().memory(), c);
    return count;
  }
  // Strands with any of the channel on them.
  uint32_t CountPainted(PaintChannel channel) {
    uint32_t count = 0;
    for (uint32_t c = 0; c < scene().shape().chunk_count; ++c)
      if (const PaintBlock* paint = scene().memory().Of<&Streams::paint>(c))
        for (const uint32_t word : paint->amounts)
          count += (word >> 8 * uint32_t(channel) & 255) != 0;
    return count;
  }
  FurScene& scene() { return running.scene(); }

  SkipSettings skip;
  LodSettings lod;
  Scenario scenario = EveryOutputScenario();
  RunningScenario running;
  FrameInput input;
  uint32_t frame = 0;
};

PaintBrush Ball(PaintChannel channel, float amount, float height = 0.9f, float radius = 0.35f) {
  return {{0.0f, height, 0.1f}, radius, 0.4f, uint32_t(channel), amount};
}

TEST(PaintedLayers, AloneHavePaint) {
  PaintedRun run;
  run.Run();
  const SceneShape& shape = run.scene().shape();
  uint32_t painted = 0, only_lit = 0;
  for (uint32_t l = 0; l < shape.layer_count; ++l) {
    const bool is_painted = shape.layer_kind[l] & kLayerPainted;
    painted += is_painted;
    only_lit += !is_painted && (shape.layer_kind[l] & kLayerLit);
    EXPECT_EQ(run.scene().memory().Block(kPaint, shape.layer_first_chunk[l]) != nullptr,
              is_painted);
  }
  EXPECT_GT(painted, 0u);
  EXPECT_GT(only_lit, 0u);
  Scenario plain = TinyScenario();
  RunningScenario without(plain, {});
  EXPECT_EQ(without.scene().layout().ranges[size_t(kPaint)].bytes, 0u);
}

TEST(PaintedLayers, WithoutBrushesNothingRuns) {
  PaintedRun run;
  run.Run({Ball(PaintChannel::kMud, 1.0f)});
  EXPECT_GT(run.CountPainted(PaintChannel::kMud), 0u);
  const uint64_t paint = run.scene().DigestStream(kPaint);
  for (int i = 0; i < 3; ++i) {
    run.Run();
    EXPECT_EQ(run.CountItems("paint_strands"), 0u);
    EXPECT_EQ(run.scene().DigestStream(kPaint), paint);
  }
  run.Run({Ball(PaintChannel::kMud, 0.0f)});
  EXPECT_EQ(run.CountItems("paint_strands"), 0u);
}

// Of every strand that lives, by where its root is.
TEST(PaintedLayers, StrandsInTheBallArePainted) {
  PaintedRun run;
  const PaintBrush brush{{0.05f, 0.8f, 0.1f}, 0.3f, 1.0f, uint32_t(PaintChannel::kDust), 0.5f};
  run.Run({brush});
  uint32_t inside = 0, outside = 0;
  const FrameMemory& memory = run.scene().memory();
  for (uint32_t c = 0; c < run.scene().shape().chunk_count; ++c) {
    const PaintBlock* paint = memory.Of<&Streams::paint>(c);
    if (!paint) continue;
    const auto& roots = *memory.Of<&Streams::roots>(c);
    const LookBlock& looks = *memory.Of<&Streams::looks>(c);
    for (uint32_t s = 0; s < memory.Of<&Streams::chunk_state>(c)->live_strands; ++s) {
      double distance2 = 0.0;
      for (int k = 0; k < 3; ++k) {
        const double apart = double(roots.position[k][s]) - double(brush.centre[k]);
        distance2 += apart * apart;
      }
      const bool is_inside = distance2 < double(brush.radius) * double(brush.radius);
      EXPECT_EQ(paint->amounts[s], is_inside ? 128u << 24 : 0u) << c << " " << s;
      EXPECT_EQ(looks.record[s].amounts & 0xff000000u, paint->amounts[s]);
      (is_inside ? inside : outside) += 1;
    }
  }
  EXPECT_GT(inside, 0u);
  EXPECT_GT(outside, 0u);
}

TEST(PaintedLayers, SleepersArePaintedAndSleepOn) {
  PaintedRun run(6);
  run.RunUntilAsleep();
  EXPECT_EQ(run.CountItems("write_painted_looks"), 0u);
  const uint64_t looks = run.scene().DigestStream(kLooks),
                 curves = run.scene().DigestStream(StreamOf<&Streams::curves>);
  // At one root, so that other chunks are asked and not painted.
  PaintBrush brush = Ball(PaintChannel::kSnow, 0.25f, 0.0f, 0.02f);
  uint32_t chunk = 0;
  while (!run.scene().memory().Block(kPaint, chunk)) ++chunk;
  const RootBlock& roots = *run.scene().memory().Of<&Streams::roots>(chunk);
  for (int k = 0; k < 3; ++k) brush.centre[k] = roots.position[k][0];
  run.Run({brush});
  EXPECT_GT(run.CountPainted(PaintChannel::kSnow), 0u);
  EXPECT_NE(run.scene().DigestStream(kLooks), looks);
  EXPECT_EQ(run.scene().DigestStream(StreamOf<&Streams::curves>), curves);
  EXPECT_EQ(CountChunks(run.scene(), kChunkSimulate), 0u);
  const uint32_t painted = CountChunks(run.scene(), kChunkPainted);
  EXPECT_GT(painted, 0u);
  EXPECT_LT(painted, run.CountItems("paint_strands"));
  EXPECT_EQ(run.CountItems("write_painted_looks"), painted);
  run.Run();
  EXPECT_EQ(CountChunks(run.scene(), kChunkSimulate), 0u);
  EXPECT_EQ(run.CountItems("write_painted_looks"), 0u);
}

// Brushes that come and go and move, the same regardless of what is skipped.
std::vector<PaintBrush> BrushesOf(uint32_t frame) {
  if (frame % 5 == 4) return {};
  std::vector<PaintBrush> brushes = {
      Ball(PaintChannel::kMud, 0.1f, 0.5f + 0.05f * float(frame % 9), 0.2f),
      Ball(PaintChannel::kWet, frame % 3 ? 0.3f : -1.0f, 0.9f, 0.25f)};
  if (frame % 2) brushes.push_back(Ball(PaintChannel::kMud, -0.05f, 0.7f, 2.0f));
  return brushes;
}

TEST(PaintedLayers, AreTheSameWithAllSkipsOff) {
  PaintedRun lazy(5), eager(5, kNoSkips);
  for (uint32_t f = 0; f < 24; ++f) {
    lazy.Run(BrushesOf(f));
    eager.Run(BrushesOf(f));
    ASSERT_EQ(lazy.scene().DigestFrame(), eager.scene().DigestFrame()) << f;
  }
  EXPECT_GT(lazy.CountPainted(PaintChannel::kMud), 0u);
}

TEST(PaintedLayers, PaintIsState) {
  PaintedRun run, copy;
  for (uint32_t f = 0; f < 6; ++f) run.Run(BrushesOf(f));
  ASSERT_TRUE(copy.scene().CopyStateFrom(run.scene()));
  copy.frame = run.frame;
  run.Run();
  copy.Run();
  EXPECT_GT(copy.CountPainted(PaintChannel::kMud), 0u);
  EXPECT_EQ(copy.scene().DigestFrame(), run.scene().DigestFrame());
  // A pause paints no strand, and a teleport cleans none.
  const uint64_t paint = run.scene().DigestStream(kPaint);
  FrameInput pause = run.input;
  pause.dt_s = 0.0;
  pause.brush_count = 1;
  pause.brush[0] = Ball(PaintChannel::kDust, 1.0f, 0.9f, 5.0f);
  RunInput(run.scene(), pause);
  EXPECT_EQ(run.scene().DigestStream(kPaint), paint);
  run.scenario.actors[0].teleport_frame = int32_t(run.frame);
  run.Run();
  EXPECT_EQ(run.scene().DigestStream(kPaint), paint);
}

// A strand that does not live keeps what it has, and is not painted.
TEST(PaintedLayers, StrandsThatDoNotLiveKeepTheirs) {
  PaintedRun run(3);
  run.Run({Ball(PaintChannel::kMud, 1.0f, 0.9f, 5.0f)});
  const uint32_t all = run.CountPainted(PaintChannel::kMud);
  run.skip.lod = true;
  run.lod.strand_budget = uint32_t(run.scenario.StrandCount() / 4);
  for (int i = 0; i < 4; ++i) run.Run();
  ASSERT_LT(run.scene().LiveStrands(), run.scenario.StrandCount() / 2);
  run.Run(
      {Ball(PaintChannel::kMud, -1.0f, 0.9f, 5.0f), Ball(PaintChannel::kDust, 1.0f, 0.9f, 5.0f)});
  const uint32_t left = run.CountPainted(PaintChannel::kMud);
  EXPECT_GT(left, all / 2);
  EXPECT_LT(left, all);
  EXPECT_EQ(run.CountPainted(PaintChannel::kDust), all - left);
}

TEST(PaintedLayers, WhatIsRecordedPaintsAgain) {
  PaintedRun run;
  InputLogWriter writer;
  const std::vector<std::byte> groom = WriteGroom(*run.scenario.ActorGrooms()[0]).OrThrow();
  const std::span<const std::byte> files[] = {groom};
  ASSERT_EQ(writer.Begin({"painted", "", false}, files), nullptr);
  for (uint32_t f = 0; f < 10; ++f) {
    run.Run(BrushesOf(f));
    ASSERT_EQ(writer.AddFrame(run.input, {&run.scene().Pose(0), 1}, run.scene().DigestFrame()),
              nullptr);
  }
  const InputLog log = ReadInputLog(writer.Finish(), "painted").OrThrow();
  const Groom read = ReadGroom(log.grooms[0], "painted").OrThrow();
  const Groom* const grooms[] = {&read};
  const auto scene = FurScene::Create(grooms).OrThrow();
  for (uint32_t f = 0; f < log.FrameCount(); ++f) {
    log.FillPose(f, 0, &scene->Pose(0));
    RunInput(*scene, log.Input(f));
    ASSERT_EQ(scene->DigestFrame(), log.frames[f].digest) << f;
  }
  EXPECT_EQ(scene->DigestStream(kPaint), run.scene().DigestStream(kPaint));
}

// Weather is on every strand of a painted layer as paint is, and its colours are left alone.
TEST(PaintedLayers, WeatherIsInTheirLooks) {
  PaintedRun run;
  run.scenario.weather_course = {};
  run.Run();
  const auto colours = [&](uint32_t chunk) {
    std::vector<uint32_t> all;
    if (const CurveBlock* curves = run.scene().memory().Of<&Streams::curves>(chunk))
      for (const CurveRecord& record : curves->record) all.push_back(record.base_colour);
    return all;
  };
  const SceneShape& shape = run.scene().shape();
  std::vector<std::vector<uint32_t>> dry;
  for (uint32_t c = 0; c < shape.chunk_count; ++c) dry.push_back(colours(c));
  run.scenario.weather_course = {1.0f, 0.2f, 0};
  run.frame = 40;
  run.Run({Ball(PaintChannel::kMud, 1.0f)});
  uint32_t painted = 0, tinted = 0, muddy = 0;
  for (uint32_t c = 0; c < shape.chunk_count; ++c) {
    const uint32_t kind = shape.layer_kind[shape.chunk_layer[c]];
    if (!(kind & kLayerPainted)) {
      tinted += dry[c] != colours(c);
      continue;
    }
    EXPECT_EQ(dry[c], colours(c));
    const LookBlock& looks = *run.scene().memory().Of<&Streams::looks>(c);
    for (uint32_t s = 0; s < run.scene().LiveLanes(kLooks, c); ++s) {
      EXPECT_EQ(looks.record[s].amounts >> 16 & 255, 255u);
      EXPECT_GE(looks.record[s].amounts & 255, 51u);
      muddy += (looks.record[s].amounts & 255) > 51;
    }
    ++painted;
  }
  EXPECT_GT(painted, 0u);
  EXPECT_GT(tinted, 0u);
  EXPECT_GT(muddy, 0u);
  for (const LayerDraw& draw : run.scene().Draws()) {
    const bool is_painted = shape.layer_kind[draw.layer] & kLayerPainted;
    EXPECT_EQ(draw.wet_darken < 1.0f, is_painted);
    EXPECT_EQ(draw.mud_colour[0] > 0.0f, is_painted);
  }
}

}  // namespace
}  // namespace pelt::testing
