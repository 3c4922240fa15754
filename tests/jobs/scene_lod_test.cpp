// LOD: a prefix of every chunk, in its share, within its budget, and bit for bit what the full
// scene has for those strands.
#include <gtest/gtest.h>

#include <bit>
#include <cstring>
#include <tuple>

#include "core/modal/modal_quality.hpp"
#include "jobs/scene.hpp"
#include "tests/jobs/tiny_scene.hpp"

namespace pelt::testing {
namespace {

// ---- LOD ----------------------------------------------------------------------------------------

// A layer far too small on the screen for its strands, held at `fraction`.
LodSettings HeldAt(float fraction) {
  LodSettings lod;
  lod.full_detail_px = 1e9f;
  lod.min_fraction = fraction;
  lod.hysteresis = lod.fade_share = 0.0f;
  lod.least_chains = 1.0f;
  return lod;
}

TEST(FurSceneLod, APrefixKeepsTheBitsOfTheFullRun) {
  Scenario scenario = TinyScenario();
  RunningScenario full(scenario, {}), half(scenario, {});
  for (uint32_t f = 0; f < 24; ++f) {
    RunFrame(full, f, {}, {});
    RunFrame(half, f, {.lod = true}, HeldAt(0.5f));
  }
  const FurScene &a = full.scene(), &b = half.scene();
  uint32_t compared = 0;
  const auto same = [&](Stream stream, uint32_t item, uint32_t rows) {
    const auto *p = a.memory().As<uint32_t>(stream, item),
               *q = b.memory().As<uint32_t>(stream, item);
    if (!p) return;
    for (uint32_t row = 0; row < rows; ++row)
      ASSERT_EQ(std::memcmp(p + row * kStrandsPerChunk, q + row * kStrandsPerChunk,
                            4 * b.LiveLanes(stream, item)),
                0)
          << DescribeStream(stream).name << " of item " << item << ", row " << row;
    ++compared;
  };
  for (uint32_t c = 0; c < a.shape().chunk_count; ++c) {
    const uint32_t strands = a.memory().Of<&Streams::strands>(c)->strand_count;
    const uint32_t live = b.LiveLanes(StreamOf<&Streams::roots>, c);
    EXPECT_EQ(live, (strands + 1) / 2);
    same(StreamOf<&Streams::roots>, c, 12);
    same(StreamOf<&Streams::strand_points4>, c, 9);
    same(StreamOf<&Streams::strand_points5>, c, 12);
    if (const auto* p = a.memory().Of<&Streams::curves>(c)) {
      EXPECT_EQ(std::memcmp(p, b.memory().Of<&Streams::curves>(c), live * sizeof(CurveRecord)), 0);
    }
  }
  EXPECT_GE(compared, 2 * a.shape().chunk_count);
  compared = 0;
  for (uint32_t p = 0; p < a.shape().patch_count; ++p) {
    const uint32_t live = b.LiveLanes(StreamOf<&Streams::skinned>, p);
    ASSERT_GT(live, 0u);
    EXPECT_EQ(std::memcmp(a.memory().Of<&Streams::skinned>(p), b.memory().Of<&Streams::skinned>(p),
                          live * sizeof(SkinnedVertex)),
              0)
        << "patch " << p;
    same(StreamOf<&Streams::anchors>, p, 12);
    same(StreamOf<&Streams::vertex_points>, p, 9);
    if (const auto* loads = a.memory().Of<&Streams::vertex_loads>(p)) {
      EXPECT_EQ(
          std::memcmp(loads, b.memory().Of<&Streams::vertex_loads>(p), live * sizeof(ChainLoad)), 0)
          << "patch " << p;
    }
  }
  EXPECT_GT(compared, 2u);
}

// Of a patch in which chains are thinned: what is simulated has the bits that it has among all.
TEST(FurSceneLod, ChainsThatStayKeepTheBitsOfTheFullRun) {
  Scenario scenario = PatchedScenario();
  scenario.base.wind.velocity[0] = 4.0f;
  RunningScenario full(scenario, {}), thin(scenario, {});
  LodSettings lod = HeldAt(0.25f);
  lod.least_chains = 0.0f;
  uint32_t thinned = 0;
  for (uint32_t f = 0; f < 24; ++f) {
    RunFrame(full, f, {}, {});
    RunFrame(thin, f, {.lod = true}, lod);
    const FrameMemory &a = full.scene().memory(), &b = thin.scene().memory();
    for (uint32_t p = 0; p < a.shape->patch_count; ++p) {
      const uint32_t count = a.Of<&Streams::patches>(p)->vertex_count;
      const ChunkStateBlock& state = *b.Of<&Streams::patch_state>(p);
      ASSERT_EQ(state.live_chains, CountChains(count, 3)) << "patch " << p;
      thinned += state.live_chains < count;
      for (uint32_t i = 0; i < 3; ++i)
        for (uint32_t k = 0; k < 3; ++k)
          ASSERT_EQ(
              std::memcmp(a.Of<&Streams::vertex_modal>(p)->direction[i][k],
                          b.Of<&Streams::vertex_modal>(p)->direction[i][k], 4 * state.live_chains),
              0)
              << "frame " << f << ", patch " << p;
      EXPECT_EQ(std::memcmp(a.Of<&Streams::vertex_loads>(p), b.Of<&Streams::vertex_loads>(p),
                            state.live_chains * sizeof(ChainLoad)),
                0);
    }
  }
  EXPECT_GT(thinned, 0u);
}

// What a frame at this fraction has of the vertices; fails where a lane that is worked on, in the
// last group without a living strand too, has a corner that does not live.
uint32_t CountLiveVertices(Scenario scenario, float fraction) {
  SCOPED_TRACE(fraction);
  RunningScenario running(scenario, {});
  RunFrame(running, 0, {.lod = true}, HeldAt(fraction));
  const FrameMemory& memory = running.scene().memory();
  const SceneShape& shape = running.scene().shape();
  for (uint32_t c = 0; c < shape.chunk_count; ++c) {
    const StrandBlock& strands = *memory.Of<&Streams::strands>(c);
    const uint32_t live = memory.Of<&Streams::chunk_state>(c)->live_strands;
    EXPECT_GT(live, 0u);
    for (uint32_t lane = 0; lane < RoundUpToLaneGroups(live); ++lane)
      for (const auto& corner : strands.vertex) {
        const VertexPlace vertex = FindVertex(memory, c, corner[lane]);
        EXPECT_EQ(shape.patch_layer[vertex.patch], shape.chunk_layer[c]);
        EXPECT_LT(vertex.lane, memory.Of<&Streams::patch_state>(vertex.patch)->live_vertices)
            << "chunk " << c << ", lane " << lane;
      }
  }
  uint32_t vertices = 0, all = 0;
  for (uint32_t p = 0; p < shape.patch_count; ++p) {
    vertices += memory.Of<&Streams::patch_state>(p)->live_vertices;
    all += memory.Of<&Streams::mesh>(p)->vertex_count;
  }
  if (fraction == 1.0f) {
    EXPECT_EQ(vertices, all);
  }
  return vertices;
}

TEST(FurSceneLod, APrefixOfVerticesIsEnoughForThePrefixOfStrands) {
  for (const Scenario& scenario : {PatchedScenario(), EveryOutputScenario()}) {
    uint32_t most = CountLiveVertices(scenario, 1.0f);
    for (const float fraction : {0.8f, 0.5f, 0.25f, 0.126f, 0.125f, 0.05f}) {
      const uint32_t vertices = CountLiveVertices(scenario, fraction);
      EXPECT_LE(vertices, most) << fraction;
      most = vertices;
    }
  }
  const Scenario patched = PatchedScenario();
  EXPECT_LT(CountLiveVertices(patched, 0.05f), CountLiveVertices(patched, 0.5f));
}

TEST(FurSceneLod, DrawsItsShareOfEveryChunk) {
  Scenario scenario = TinyScenario();
  for (const float fraction : {0.05f, 0.25f, 0.8f, 1.0f}) {
    RunningScenario running(scenario, {});
    RunFrame(running, 0, {.lod = true}, HeldAt(fraction));
    const double wanted = double(fraction) * double(scenario.StrandCount());
    EXPECT_GE(running.scene().LiveStrands(), wanted * 0.999);
    EXPECT_LE(running.scene().LiveStrands(), wanted + running.scene().shape().chunk_count);
  }
}

TEST(FurSceneLod, KeepsToItsBudget) {
  Scenario scenario = TinyScenario();
  LodSettings lod;
  lod.full_detail_px = 0.0f;
  lod.hysteresis = 0.0f;
  lod.strand_budget = 200;
  RunningScenario running(scenario, {});
  for (uint32_t f = 0; f < 10; ++f) {
    RunFrame(running, f, {.lod = true}, lod);
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
  for (uint32_t f = 0; f < 8; ++f) {
    RunFrame(full, f, {}, {});
    RunFrame(grown, f, {.lod = true}, HeldAt(f < 4 ? 0.5f : 1.0f));
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

// ---- the modal solver's quality by size on the screen -------------------------------------------

// `tiny` with all layers modal, of one quality.
Scenario ModalScenario(ModalQuality quality) {
  Scenario scenario = TinyScenario();
  for (LayerParams* layer : LayersOf(scenario)) {
    layer->solver = Solver::kModal;
    layer->quality = quality;
  }
  return scenario;
}

// Of what is simulated: the order of drawing is the camera's.
uint64_t DigestOfPoints(const FurScene& scene) {
  Digest digest;
  const auto add = [&](const auto* points) {
    if (!points) return;
    for (const auto& point : points->position)
      for (const auto& row : point)
        for (const float value : row) digest.Add(std::bit_cast<uint32_t>(value));
  };
  for (uint32_t c = 0; c < scene.shape().chunk_count; ++c) {
    add(scene.memory().Of<&Streams::strand_points4>(c));
    add(scene.memory().Of<&Streams::strand_points5>(c));
  }
  return digest.Value();
}

// Seen from `distance_m`.
uint64_t DigestOfModal(ModalQuality quality, float allowed_px, double distance_m) {
  Scenario scenario = ModalScenario(quality);
  scenario.camera.radius_m = distance_m;
  LodSettings lod;
  lod.fast_quality_px = allowed_px;
  RunningScenario running(scenario, {});
  for (uint32_t f = 0; f < 12; ++f) RunFrame(running, f, {.cull = false}, lod);
  return DigestOfPoints(running.scene());
}

// The first frame knows no box and is fur on its groom in either quality: so all are the same.
TEST(QualityByScreen, FarLayersAreFastAndNearOnesAreNot) {
  const double near = 1.0, far = 40.0;
  const uint64_t fast = DigestOfModal(ModalQuality::kFast, 0.0f, near);
  const uint64_t exact = DigestOfModal(ModalQuality::kFine, 0.0f, near);
  const uint64_t best = DigestOfModal(ModalQuality::kBest, 0.0f, near);
  ASSERT_NE(fast, exact);
  EXPECT_EQ(DigestOfModal(ModalQuality::kFine, 0.0f, far), exact);
  EXPECT_EQ(DigestOfModal(ModalQuality::kFine, 0.5f, far), fast);
  EXPECT_EQ(DigestOfModal(ModalQuality::kFine, 0.05f, near), exact);
  EXPECT_EQ(DigestOfModal(ModalQuality::kFine, 100.0f, near), fast);
  // Who asked for it has it.
  EXPECT_EQ(DigestOfModal(ModalQuality::kBest, 0.5f, far), best);
}

// Strands that lie still in one quality may lie elsewhere in the other.
TEST(QualityByScreen, AnotherOneWakesWhatSleeps) {
  constexpr uint32_t kRest = 12, kOther = 400;
  Scenario scenario = ModalScenario(ModalQuality::kFine);
  // A soft surface would be another one in the other quality, which says enough.
  for (GroomLayer& layer : scenario.grooms[0].layers) layer.params.surface_hardness = 0.0f;
  scenario.rest_from_frame = kRest;
  scenario.base.wind = {};
  scenario.weather_course = {};
  RunningScenario asleep(scenario, {}), awake(scenario, {});
  LodSettings lod;
  lod.fast_quality_px = 0.0f;
  uint64_t still = 0;
  for (uint32_t f = 0; f < kOther + 60; ++f) {
    if (f == kOther) lod.fast_quality_px = 1.0e6f;
    RunFrame(asleep, f, {}, lod);
    RunFrame(awake, f, {.sleep = false}, lod);
    if (f + 1 < kOther) continue;
    ASSERT_EQ(DigestOfPoints(asleep.scene()), DigestOfPoints(awake.scene())) << "frame " << f;
    if (f + 1 == kOther) still = DigestOfPoints(awake.scene());
  }
  EXPECT_NE(DigestOfPoints(awake.scene()), still);
}

// The whole scene: the frame after one that has boxes has what the budget leaves.
TEST(QualityByScreen, ABudgetTakesFastFirstAndThenStrands) {
  Scenario scenario = ModalScenario(ModalQuality::kFine);
  scenario.base.lod.fast_quality_px = 0.0f;
  scenario.base.lod.costs = {0.0f, 2.0f, 50.0f, {10.0f, 8.0f, 20.0f, 60.0f, 90.0f}};
  const auto run = [&](uint32_t us, bool with_lod) {
    scenario.base.lod.budget_us = us;
    scenario.base.lod.worst_px = 1.0e5f;
    scenario.base.lod.full_detail_px = 0.0f;
    RunningScenario running(scenario, {});
    for (uint32_t f = 0; f < 4; ++f) {
      RunFrame(running, f, {.cull = false, .lod = with_lod}, scenario.base.lod);
    }
    uint32_t fast = 0;
    for (uint32_t l = 0; l < running.scene().shape().layer_count; ++l)
      fast += running.scene().QualityOf(l).quality == ModalQuality::kFast;
    return std::tuple(fast, running.scene().LiveStrands(), running.scene().budget().ns);
  };
  const auto layers = uint32_t(scenario.grooms[0].layers.size());
  const auto [none, all, free_ns] = run(1'000'000, true);
  EXPECT_EQ(none, 0u);
  const auto [some, same, less_ns] = run(uint32_t(0.9e-3 * free_ns), true);
  EXPECT_GT(some, 0u);
  EXPECT_LT(some, layers);
  EXPECT_EQ(same, all);
  EXPECT_LE(less_ns, 0.9 * free_ns);
  const auto [every, few, least_ns] = run(uint32_t(0.1e-3 * free_ns), true);
  EXPECT_EQ(every, layers);
  EXPECT_LT(few, all / 2);
  EXPECT_GT(few, 0u);
  // A chunk costs something without a strand, and small chunks are more.
  EXPECT_LE(least_ns, 0.1 * 128.0 / kStrandsPerChunk * free_ns);
  // Without --lod no strand goes.
  EXPECT_EQ(std::get<1>(run(uint32_t(0.1e-3 * free_ns), false)), all);
}

TEST(QualityByScreen, TheBoundIsInPixelsAndKeptByABand) {
  View view{};
  view.pixels_per_unit_at_1m = 1000.0f;
  view.near_m = 0.05f;
  BoundsBlock box{};  // a point; the eye is 2 m before it
  view.eye[2] = 2.0f;
  const auto quality = [&](float length, float px, ModalQuality last = ModalQuality::kFine) {
    return QualityOnScreen(ModalQuality::kFine, last, view, box, length, px);
  };
  const float length = 0.1f, error_px = kFastTypicalError * length * 1000.0f / 2.0f;
  EXPECT_EQ(quality(length, 1.001f * error_px), ModalQuality::kFast);
  EXPECT_EQ(quality(length, 0.999f * error_px), ModalQuality::kFine);
  EXPECT_EQ(quality(length, 0.95f * error_px, ModalQuality::kFast), ModalQuality::kFast);
  EXPECT_EQ(quality(length, 0.90f * error_px, ModalQuality::kFast), ModalQuality::kFine);
  EXPECT_EQ(quality(length, 0.0f), ModalQuality::kFine);
  EXPECT_NEAR(LengthOnScreenPx(view, box, length), length * 500.0f, 1e-3f);
  // Nothing is nearer than the near plane.
  view.eye[2] = 0.0f;
  EXPECT_NEAR(LengthOnScreenPx(view, box, length), length * 20000.0f, 0.1f);
  EXPECT_EQ(quality(length, 1.001f * kFastTypicalError * length * 1000.0f / 0.05f),
            ModalQuality::kFast);
}

}  // namespace
}  // namespace pelt::testing
