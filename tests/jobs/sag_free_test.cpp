// Sag-free layers as part of whole frames: the same bits everywhere, in grooms and their files. How well
// they hold their groom: tests/accuracy/resting_layers_test.cpp.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/groom/groom_file.hpp"
#include "core/kernels/frame_table.hpp"
#include "platform_sim/local_store.hpp"
#include "tests/jobs/tiny_scene.hpp"

namespace pelt::testing {
namespace {

TEST(SagFree, HasTheSameBitsOnEveryInstructionSetAndInLocalStores) {
  constexpr uint32_t kFrames = 8;
  Scenario scenario = SagFreeTiny();
  for (const bool velocities : {false, true}) {
    SceneOptions options = OptionsFor(Isa::kReference);
    options.velocities = velocities;
    const std::vector<uint64_t> expected = RunDigests(scenario, options, kFrames);
    for (const Isa isa : kAllIsas)
      if (FindKernels(isa)) {
        options.isa = isa;
        EXPECT_EQ(RunDigests(scenario, options, kFrames), expected) << IsaName(isa);
      }
    LocalStoreExecutor local(options.plan.local_store_data_bytes);
    EXPECT_EQ(RunDigests(scenario, options, local, kFrames), expected);
    ExpectNoFaults(local);
    Scenario plain = TinyScenario();
    EXPECT_NE(RunDigests(plain, options, kFrames), expected);
  }
}

TEST(SagFree, GroomsKeepWhichWayWasDown) {
  const Groom groom = SagFreeTiny().grooms[0];
  // Where its chains stand: at the vertices, or at the strands.
  uint32_t patches = 0, chunks = 0;
  for (const GroomLayer& layer : groom.layers) {
    if (!layer.params.sag_free) continue;
    if (layer.params.chain == ChainKind::kVertex)
      patches += layer.patch_count;
    else
      chunks += layer.chunk_count;
  }
  ASSERT_GT(patches, 0u);
  ASSERT_GT(chunks, 1u);
  const auto bytes = WriteGroom(groom).OrThrow();
  const Groom back = ReadGroom(bytes, "g").OrThrow();
  const auto expect_kept = [&](std::vector<DownBlock> Groom::*downs, uint32_t count,
                               const char* section) {
    SCOPED_TRACE(section);
    ASSERT_EQ((groom.*downs).size(), count);
    ASSERT_EQ((back.*downs).size(), count);
    EXPECT_EQ(std::memcmp((back.*downs).data(), (groom.*downs).data(), count * sizeof(DownBlock)),
              0);

    Groom longer = groom;
    (longer.*downs).back().down[2][3] = 2.0f;
    EXPECT_NE(FindGroomFault(longer, "g").find(section), std::string::npos);
    Groom shorter = groom;
    for (auto& row : (shorter.*downs).back().down) row[3] *= 0.5f;
    EXPECT_NE(FindGroomFault(shorter, "g").find("not a direction"), std::string::npos);
    EXPECT_NE(FindGroomFault(shorter, "g").find(section), std::string::npos);
    Groom fewer = groom;
    (fewer.*downs).pop_back();
    EXPECT_NE(FindGroomFault(fewer, "g").find("where the layers need"), std::string::npos);
  };
  expect_kept(&Groom::vertex_down, patches, "vertex_down");
  expect_kept(&Groom::strand_down, chunks, "strand_down");
}

// Of the layers that stand on the chains of the mesh's vertices: every point of every strand.
std::vector<float> PointsOnVertices(const FurScene& scene) {
  std::vector<float> all;
  for (uint32_t c = 0; c < scene.shape().chunk_count; ++c) {
    const uint32_t kind = scene.shape().layer_kind[scene.shape().chunk_layer[c]];
    if (!(kind & kLayerSagFree) || !(kind & kLayerVertexChains)) continue;
    const auto& points = *scene.memory().Of<&Streams::strand_points4>(c);
    const uint32_t live = scene.memory().Of<&Streams::chunk_state>(c)->live_strands;
    for (const auto& point : points.position)
      for (const auto& row : point) all.insert(all.end(), row, row + live);
  }
  return all;
}

// Each is combed otherwise than the chains about it, and stays as it was groomed.
TEST(SagFree, StrandsBetweenChainsKeepTheirGroom) {
  Scenario scenario = SagFreeTiny();
  for (GroomLayer& layer : scenario.grooms[0].layers)
    layer.params.clump = layer.params.surface_hardness = 0.0f;
  scenario.actors[0].clip = scenario.actors[0].teleport_frame = -1;
  scenario.rest_from_frame = 0;
  scenario.base.use_ground = false;
  scenario.spheres.clear();
  scenario.capsules.clear();
  scenario.weather_course = {};
  RunningScenario run(scenario, {});
  std::vector<float> groom;
  for (uint32_t f = 0; f < 60; ++f) {
    RunFrame(run, f);
    if (f == 0) groom = PointsOnVertices(run.scene());
  }
  const std::vector<float> now = PointsOnVertices(run.scene());
  ASSERT_GT(groom.size(), 500u);
  ASSERT_EQ(now.size(), groom.size());
  float farthest = 0.0f;
  for (size_t i = 0; i < now.size(); ++i)
    farthest = std::max(farthest, std::abs(now[i] - groom[i]));
  EXPECT_LT(farthest, 1e-4f) << "m";
}

TEST(SagFree, OnlyTheModalSolverHoldsAGroomUp) {
  LayerParams params;
  params.sag_free = true;
  EXPECT_EQ(FindBadParam(params), "");
  params.solver = Solver::kPbd;
  EXPECT_NE(FindBadParam(params).find("sag_free"), std::string::npos);
  params.solver = Solver::kModal;
  params.output = Output::kShells;
  EXPECT_NE(FindBadParam(params).find("sag_free"), std::string::npos);
}

}  // namespace
}  // namespace pelt::testing
