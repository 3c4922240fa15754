// What a frame says of layers and single strands: importance and switches, haircuts, values that are written over the
// groom's. What a frame does not say leaves no trace.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "tests/jobs/tiny_scene.hpp"

namespace pelt::testing {
namespace {

constexpr uint32_t kWrites = 4;

// `tiny` without what changes colours or begins layers anew.
Scenario PlainTiny() {
  Scenario scenario = TinyScenario();
  scenario.actors[0].teleport_frame = -1;
  scenario.weather_course = {};
  scenario.spheres.clear();
  scenario.base.use_ground = false;
  scenario.strand_writes = kWrites;
  return scenario;
}

struct Lists {
  explicit Lists(Scenario& from, const SceneOptions& options = {}) : running(from, options) {}
  FurScene& scene() { return running.scene(); }
  // The lists must outlive the call.
  FrameInput Prepare(uint32_t frame, const LodSettings* lod = nullptr) {
    SkipSettings skip;
    skip.lod = lod != nullptr;
    LodSettings settings;
    settings.fast_quality_px = 0.0f;
    return running.Prepare(frame, skip, lod ? *lod : settings);
  }
  uint64_t Step(uint32_t frame) {
    FrameInput in = Prepare(frame);
    in.importance = importance;
    in.cut = cut;
    in.strands = strands;
    RunInput(running, in);
    return scene().DigestFrame();
  }

  RunningScenario running;
  std::vector<float> importance;
  std::vector<uint8_t> cut;
  std::vector<StrandWrite> strands;
};

uint32_t LayerOf(const FurScene& scene, std::string_view name) {
  uint32_t layer = 0;
  while (scene.LayerName(layer) != name) ++layer;
  return layer;
}
bool IsDrawn(const FurScene& scene, uint32_t layer) {
  return std::ranges::any_of(scene.Draws(), [&](const LayerDraw& d) { return d.layer == layer; });
}
// Flags that some chunk or patch of the layer has.
uint32_t FlagsOf(const FurScene& scene, uint32_t layer) {
  const SceneShape& shape = scene.shape();
  uint32_t flags = 0;
  for (uint32_t c = shape.layer_first_chunk[layer]; c < shape.layer_first_chunk[layer + 1]; ++c)
    flags |= scene.memory().Of<&Streams::chunk_state>(c)->flags;
  for (uint32_t p = shape.layer_first_patch[layer]; p < shape.layer_first_patch[layer + 1]; ++p)
    flags |= scene.memory().Of<&Streams::patch_state>(p)->flags;
  return flags;
}

// ---- Importance ---------------------------------------------------------------------------------

TEST(Importance, AnOffLayerRunsNothingAndStartsFromItsGroom) {
  for (const char* name : {"vertex", "strand5", "modal_vertex", "modal5"}) {
    Scenario scenario = PlainTiny();
    Lists run(scenario), plain(scenario), fresh(scenario);
    const uint32_t layer = LayerOf(run.scene(), name);
    for (uint32_t f = 0; f < 12; ++f) {
      run.importance.assign(run.scene().shape().layer_count, 1.0f);
      if (f >= 4 && f < 9) run.importance[layer] = 0.0f;
      run.Step(f);
      plain.Step(f);
      if (f >= 9) fresh.Step(f);
      const bool on = f < 4 || f >= 9;
      EXPECT_EQ(IsDrawn(run.scene(), layer), on) << name << ", frame " << f;
      EXPECT_EQ(FlagsOf(run.scene(), layer) != 0, on) << name << ", frame " << f;
      EXPECT_EQ((FlagsOf(run.scene(), layer) & kChunkRestart) != 0, f == 0 || f == 9) << f;
      // No other layer notices.
      for (const LayerDraw& draw : plain.scene().Draws()) {
        EXPECT_TRUE(IsDrawn(run.scene(), draw.layer) || draw.layer == layer);
      }
      if (f < 9) continue;
      const uint32_t chunk = run.scene().shape().layer_first_chunk[layer];
      EXPECT_EQ(
          std::memcmp(run.scene().memory().Of<&Streams::sort_keys>(chunk),
                      fresh.scene().memory().Of<&Streams::sort_keys>(chunk), sizeof(SortKeyBlock)),
          0)
          << name << " is not what it is in a scene that begins there, frame " << f;
    }
  }
}

// By strands, and by time.
TEST(Importance, BudgetsTakeFromWhatMattersLess) {
  for (const bool by_time : {false, true}) {
    Scenario scenario = PlainTiny();
    Lists run(scenario);
    run.importance.assign(run.scene().shape().layer_count, 0.5f);
    run.importance[0] = 4.0f;
    LodSettings lod;
    lod.full_detail_px = lod.hysteresis = lod.worst_px = 0.0f;
    lod.costs.strand_ns = 1000.0f;
    const auto budget = uint32_t(scenario.StrandCount() * 2 / 3);
    (by_time ? lod.budget_us : lod.strand_budget) = budget;
    const auto step = [&](uint32_t f) {
      FrameInput in = run.Prepare(f, &lod);
      in.importance = run.importance;
      RunInput(run.running, in);
    };
    for (uint32_t f = 0; f < 4; ++f) step(f);
    EXPECT_EQ(run.scene().memory().Of<&Streams::lod>(0)->fraction, 1.0f) << by_time;
    EXPECT_LT(run.scene().memory().Of<&Streams::lod>(1)->fraction, 0.9f) << by_time;
    EXPECT_LE(run.scene().LiveStrands(), budget + run.scene().shape().chunk_count) << by_time;
    // With room for all nothing goes, though most matters less than 1.
    lod.strand_budget = lod.budget_us = 1'000'000;
    step(4);
    EXPECT_EQ(run.scene().LiveStrands(), scenario.StrandCount()) << by_time;
  }
}

// ---- Haircuts -----------------------------------------------------------------------------------

TEST(Haircut, StrandsThatAreCutOffAreNotDrawnAndGoOn) {
  for (const VertexOrder order : {VertexOrder::kSorted, VertexOrder::kIndexBuffer}) {
    Scenario scenario = PlainTiny();
    Lists run(scenario, {.vertex_order = order}), plain(scenario, {.vertex_order = order});
    const SceneShape& shape = run.scene().shape();
    for (uint32_t f = 0; f < 12; ++f) {
      const bool has_cut = f >= 3 && f < 8;
      run.cut.assign(has_cut ? shape.chunk_count * kStrandsPerChunk : 0u, 0);
      for (size_t place = 0; place < run.cut.size(); place += 3) run.cut[place] = uint8_t(1 + f);
      const uint64_t digest = run.Step(f), whole = plain.Step(f);
      EXPECT_EQ(digest == whole, !has_cut) << f;
      const auto draws = run.scene().Draws(), all = plain.scene().Draws();
      ASSERT_EQ(draws.size(), all.size());
      for (size_t d = 0; d < draws.size() && has_cut; ++d) {
        const size_t first = size_t(shape.layer_first_chunk[draws[d].layer]) * kStrandsPerChunk;
        const auto is_cut = [&](uint32_t strand) { return run.cut[first + strand] != 0; };
        EXPECT_TRUE(std::ranges::none_of(draws[d].order, is_cut));
        const auto left = all[d].strand_count - std::ranges::count_if(all[d].order, is_cut);
        EXPECT_EQ(draws[d].strand_count, uint32_t(left));
        std::vector<StrandCurve> curves(all[d].live_strands);
        EXPECT_EQ(run.scene().CopyCurves(draws[d].layer, curves), draws[d].live_strands);
        EXPECT_LT(draws[d].live_strands, all[d].live_strands);
        for (uint32_t i = 0; i < draws[d].live_strands; ++i) EXPECT_FALSE(is_cut(curves[i].strand));
      }
    }
  }
}

// ---- Written strands ----------------------------------------------------------------------------

StrandCurve CurveOf(const FurScene& scene, uint32_t layer, uint32_t strand) {
  std::vector<StrandCurve> curves(scene.StrandCount(layer));
  curves.resize(scene.CopyCurves(layer, curves));
  for (const StrandCurve& curve : curves)
    if (curve.strand == strand) return curve;
  ADD_FAILURE() << "no strand " << strand;
  return {};
}

TEST(WrittenStrands, AreDrawnSoInTheirFramesAlone) {
  Scenario scenario = PlainTiny();
  Lists run(scenario), plain(scenario);
  const uint32_t layer = LayerOf(run.scene(), "vertex");
  const StrandWrite other{layer, 5, 0xff010203, 0xff040506, 0.002f, 3};
  const StrandWrite write{layer, 5, 0xff102030, 0xff405060, 0.001f, 7};
  for (uint32_t f = 0; f < 9; ++f) {
    run.strands.clear();
    if (f >= 2 && f < 5) run.strands = {other, {layer, 0, 0, 0, 0.0f, 0}, write};
    if (f == 5) run.strands = {other};
    const uint64_t digest = run.Step(f), untouched = plain.Step(f);
    EXPECT_EQ(digest == untouched, run.strands.empty()) << f;
    if (run.strands.empty()) continue;
    const StrandWrite& last = run.strands.back();
    const StrandCurve curve = CurveOf(run.scene(), layer, 5);
    EXPECT_EQ(curve.base_colour, last.base_colour);
    EXPECT_EQ(curve.tip_colour, last.tip_colour);
    EXPECT_EQ(curve.film_strip, last.film_strip);
    EXPECT_FLOAT_EQ(curve.point[0][3], last.width);
  }
}

// ---- What all of them have in common --------------------------------------------------------------

TEST(LayerLists, AreInputThatASnapshotNeedNotHold) {
  Scenario scenario = PlainTiny();
  Lists straight(scenario), back(scenario), elsewhere(scenario);
  const auto prepare = [](Lists& run, uint32_t f) {
    run.importance.assign(run.scene().shape().layer_count, f % 4 == 3 ? 0.0f : 2.0f);
    run.importance[0] = 1.0f;
    run.cut.assign(run.scene().shape().chunk_count * kStrandsPerChunk, 0);
    for (size_t place = f % 3; place < run.cut.size(); place += 3) run.cut[place] = 1;
    run.strands = {{0, f % 5, 0xff00ff00, 0xffff00ff, 0.002f, f}};
  };
  std::vector<uint64_t> truth;
  std::vector<std::byte> bytes(straight.scene().SnapshotBytes());
  for (uint32_t f = 0; f < 10; ++f) {
    if (f == 6) {
      ASSERT_EQ(straight.scene().Snapshot(bytes), nullptr);
    }
    for (Lists* run : {&straight, &back}) prepare(*run, f);
    truth.push_back(straight.Step(f));
    EXPECT_EQ(back.Step(f), truth[f]);
  }
  for (Lists* run : {&back, &elsewhere}) {
    ASSERT_EQ(run->scene().Restore(bytes), nullptr);
    prepare(*run, 5);
    FrameInput again = run->Prepare(5);
    again.dt_s = 0.0;  // shows frame 5
    again.importance = run->importance, again.cut = run->cut, again.strands = run->strands;
    RunInput(run->running, again);
    EXPECT_EQ(run->scene().DigestFrame(), truth[5]);
    for (uint32_t f = 6; f < 10; ++f) {
      prepare(*run, f);
      EXPECT_EQ(run->Step(f), truth[f]) << f;
    }
  }
  Lists copy(scenario);
  ASSERT_TRUE(copy.scene().CopyStateFrom(straight.scene()));
  for (Lists* run : {&straight, &copy}) prepare(*run, 10);
  EXPECT_EQ(copy.Step(10), straight.Step(10));
  Scenario fewer = PlainTiny();
  fewer.strand_writes = kWrites - 1;
  EXPECT_FALSE(Lists(fewer).scene().CopyStateFrom(straight.scene()));
}

TEST(LayerLists, OtherGroomsAreWrittenOver) {
  Scenario scenario = PlainTiny();
  Lists run(scenario), plain(scenario);
  run.strands = {{0, 1, 0xff00ff00, 0xffff00ff, 0.002f, 1}};
  run.Step(0);
  plain.Step(0);
  ASSERT_TRUE(run.scene().ReplaceGrooms(scenario.ActorGrooms()));
  run.Step(1);
  plain.Step(1);
  EXPECT_EQ(CurveOf(run.scene(), 0, 1).base_colour, 0xff00ff00);
  run.strands.clear();
  EXPECT_EQ(run.Step(2), plain.Step(2));
}

TEST(LayerLists, AreRefusedWhereTheyAreNotOfTheScene) {
  Scenario scenario = EveryOutputScenario();
  scenario.strand_writes = 2;
  Lists run(scenario);
  const FurScene& scene = run.scene();
  const uint32_t layers = scene.shape().layer_count;
  const auto expect = [&](const char* part, auto member, const auto& list) {
    FrameInput in = run.Prepare(0);
    in.*member = list;
    const std::string said = BeginError(run.scene(), in);
    EXPECT_NE(said.find(part), std::string::npos) << part << ": " << said;
  };
  std::vector<float> importance(layers - 1, 1.0f);
  expect("importance of", &FrameInput::importance, importance);
  importance.push_back(1.0f);
  for (const float bad : {0.001f, 101.0f, -1.0f, kNaN, kInf}) {
    importance[2] = bad;
    expect("importance of layer 2 is", &FrameInput::importance, importance);
  }
  expect("cut of", &FrameInput::cut, std::vector<uint8_t>(7));
  expect("3 strands are written, the scene was made for 2", &FrameInput::strands,
         std::vector<StrandWrite>(3));
  const uint32_t places = scene.StrandPlaces(0), shells = LayerOf(scene, "shells");
  const std::pair<StrandWrite, const char*> bad[] = {
      {{layers, 0, 0, 0, 0.001f, 0}, "has no strand 0"},
      {{0, places, 0, 0, 0.001f, 0}, "has no strand"},
      {{shells, 0, 0, 0, 0.001f, 0}, "has no strand 0"},
      {{0, 0, 0, 0, 0.2f, 0}, "its width is 0.2"},
      {{0, 0, 0, 0, kNaN, 0}, "its width is"},
      {{0, 0, 0, 0, 0.001f, 256}, "its film strip is 256"}};
  for (const auto& [write, part] : bad)
    expect(part, &FrameInput::strands, std::vector<StrandWrite>{StrandWrite{}, write});
}

}  // namespace
}  // namespace pelt::testing
