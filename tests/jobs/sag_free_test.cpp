// Sag-free layers as part of whole frames: the same bits everywhere, in grooms and their files. How well
// they hold their groom: tests/accuracy/resting_layers_test.cpp.
#include <gtest/gtest.h>

#include <cstring>

#include "core/groom/groom_file.hpp"
#include "core/kernels/frame_table.hpp"
#include "platform_sim/local_store.hpp"
#include "tests/jobs/tiny_scene.hpp"

namespace pelt::testing {
namespace {

// `tiny` with its modal layers sag-free.
Scenario HeldScenario() {
  static const Scenario kBaked = [] {
    Scenario scenario = TinyScenario();
    FurSetup setup = LoadSetup("tiny");
    for (LayerSetup& layer : setup.layers)
      layer.params.sag_free = layer.params.solver == Solver::kModal;
    const Actor& actor = scenario.actors[0];
    const Character& character = scenario.characters[actor.character];
    scenario.grooms[actor.groom] = BakeGroom(
        character, ComputeRestGeometry(character, actor.unit_scale), setup, actor.unit_scale);
    return scenario;
  }();
  return kBaked;
}

TEST(SagFree, HasTheSameBitsOnEveryInstructionSetAndInLocalStores) {
  constexpr uint32_t kFrames = 8;
  SerialExecutor serial;
  Scenario scenario = HeldScenario();
  for (const bool velocities : {false, true}) {
    SceneOptions options = OptionsFor(Isa::kReference);
    options.velocities = velocities;
    const std::vector<uint64_t> expected = RunDigests(scenario, options, serial, kFrames);
    for (const Isa isa : kAllIsas)
      if (FindKernels(isa)) {
        options.isa = isa;
        EXPECT_EQ(RunDigests(scenario, options, serial, kFrames), expected) << IsaName(isa);
      }
    LocalStoreExecutor local(options.plan.local_store_data_bytes);
    EXPECT_EQ(RunDigests(scenario, options, local, kFrames), expected);
    for (const LocalStoreFault& f : local.faults())
      ADD_FAILURE() << f.stage << ", item " << f.item << ": " << f.what;
    Scenario plain = TinyScenario();
    EXPECT_NE(RunDigests(plain, options, serial, kFrames), expected);
  }
}

TEST(SagFree, GroomsKeepWhichWayWasDown) {
  const Groom groom = HeldScenario().grooms[0];
  uint32_t chunks = 0;
  for (const GroomLayer& layer : groom.layers)
    if (layer.params.sag_free) chunks += layer.chunk_count;
  ASSERT_GT(chunks, 2u);
  ASSERT_EQ(groom.rest_down.size(), chunks);
  const auto bytes = WriteGroom(groom).OrThrow();
  const Groom back = ReadGroom(bytes, "g").OrThrow();
  ASSERT_EQ(back.rest_down.size(), chunks);
  EXPECT_EQ(std::memcmp(back.rest_down.data(), groom.rest_down.data(), chunks * sizeof(DownBlock)),
            0);

  Groom longer = groom;
  longer.rest_down[1].down[2][3] = 2.0f;
  EXPECT_NE(FindGroomFault(longer, "g").find("rest_down"), std::string::npos);
  Groom shorter = groom;
  for (auto& row : shorter.rest_down[1].down) row[3] *= 0.5f;
  EXPECT_NE(FindGroomFault(shorter, "g").find("not a direction"), std::string::npos);
  Groom fewer = groom;
  fewer.rest_down.pop_back();
  EXPECT_NE(FindGroomFault(fewer, "g").find("where the layers need"), std::string::npos);
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
