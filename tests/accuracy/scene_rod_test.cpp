// Strands of whole scenes against their own rods: nearer the better they are simulated, and off by what is planted.
#include <gtest/gtest.h>

#include <algorithm>

#include "bench/accuracy/scene_precision.hpp"

namespace pelt::accuracy {
namespace {

constexpr uint32_t kFrames = 90, kWarmUp = 30, kRate = 8;

// `tiny`, dry, with one layer.
Scenario OnlyLayer(std::string_view name) {
  Scenario scene = LoadScenario("tiny");
  scene.weather_course = {};
  for (GroomLayer& layer : scene.grooms[0].layers) layer.params.enabled = layer.name == name;
  return scene;
}
LayerParams& ParamsOf(Scenario& scene, std::string_view name) {
  for (GroomLayer& layer : scene.grooms[0].layers)
    if (layer.name == name) return layer.params;
  throw std::logic_error("no such layer");
}

struct Errors {
  std::vector<SceneWay> ways = AllSceneWays();
  SceneRodErrors found;

  std::optional<double> Of(std::string_view way) const {
    for (size_t w = 0; w < ways.size(); ++w)
      if (ways[w].name == way) return found.ways[w];
    throw std::logic_error("no such way");
  }
};

Errors ErrorsOf(const Scenario& scene) {
  SceneRods rods(scene, kRate, kWarmUp, 16);
  Scenario recorded = AtRate(scene, kRate, 1);
  SetWay(RigidWay(), scene, recorded);
  SceneRun run(RigidWay(), recorded, BestIsa());
  for (uint32_t f = 0; f <= (kFrames - 1) * kRate; ++f) {
    run.RunFrame(f);
    rods.Record(run.scene());
  }
  Errors errors;
  errors.found = rods.Compare(errors.ways, BestIsa(), [] {});
  return errors;
}

TEST(SceneRods, FourNodesAreNearTheirRodAndPbdIsNot) {
  const Errors errors = ErrorsOf(OnlyLayer("modal5"));
  std::printf("modal5 off its rods: fast %.4f, fine %.4f, best %.4f, pbd %.3f; the rods %.5f\n",
              *errors.Of("fast"), *errors.Of("fine"), *errors.Of("best"), *errors.Of("pbd"),
              errors.found.self_error);
  EXPECT_LT(*errors.Of("fine"), 0.01);
  EXPECT_LT(*errors.Of("best"), 0.01);
  EXPECT_GT(*errors.Of("pbd"), 3.0 * *errors.Of("best"));
  EXPECT_GT(errors.found.self_error, 0.0);
  EXPECT_LT(errors.found.self_error, 0.2 * *errors.Of("best"));
  EXPECT_GT(errors.found.secondary_m, 1e-4);
  // What is carried or skipped says nothing of the solver.
  EXPECT_FALSE(errors.Of("fine-halved") || errors.Of("fine-lod-2") || errors.Of("rigid"));
  ASSERT_EQ(errors.found.layers.size(), 1u);
  EXPECT_EQ(errors.found.layers[0].layer, "modal5");
  EXPECT_EQ(errors.found.layers[0].error, *errors.Of("best"));  // as it is set up
  EXPECT_EQ(errors.found.layers[0].sampled, 16u);
  EXPECT_TRUE(errors.found.notes.empty());
}

// Water takes stiffness from the strands and, here, nothing else; rods are dry.
TEST(SceneRods, AWrongFrequencyIsSeen) {
  Scenario scene = OnlyLayer("modal5");
  LayerParams& params = ParamsOf(scene, "modal5");
  params.wet_weight = 1.0f;
  params.wet_clump = 0.0f;
  params.wet_hardness = 0.8f;
  const Errors right = ErrorsOf(scene);
  scene.weather_course = {1.0f, 0.0f, 0};
  const Errors wrong = ErrorsOf(scene);
  EXPECT_GT(*wrong.Of("best"), 2.0 * *right.Of("best"));
}

TEST(SceneRods, LayersWithoutRodsAreNamed) {
  Scenario scene = OnlyLayer("modal5");
  ParamsOf(scene, "modal5").max_distance = 0.5f;
  const Errors errors = ErrorsOf(scene);
  EXPECT_TRUE(std::ranges::none_of(errors.found.ways, [](const auto& e) { return e.has_value(); }));
  ASSERT_EQ(errors.found.notes.size(), 1u);
  EXPECT_EQ(errors.found.notes[0], "no rod to be off for modal5: max_distance");
}

TEST(CurveDynamics, AGroomThatIsHeldUpIsWhereItRests) {
  const RestCurve rest{kZero3, {0.0, 0.6, 0.8}, {1.0, 0.0, 0.0}, 0.7};
  const Preset soft = kPresets[1];
  const auto turned = [&](const StrandWeight& weight) {
    const CurveDynamics dynamics(RodOfStrand(), soft, rest, CurlModel::kRoot, weight);
    const UnknownVectors d = dynamics.Equilibrium(StillPose());
    double most = 0.0;
    for (size_t i = 0; i < dynamics.count(); ++i)
      most = std::max(most, Length(d[i] - dynamics.rest()[i]));
    return most;
  };
  EXPECT_LT(turned({.held = {0.0, -9.81, 0.0}}), 1e-9);
  EXPECT_GT(turned({}), 0.1);
}

}  // namespace
}  // namespace pelt::accuracy
