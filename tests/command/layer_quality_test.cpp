// What a run says of the quality that its layers ran in. In the scene here the camera decides each layer's quality.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "bench/report/run_report.hpp"
#include "core/modal/modal_quality.hpp"

namespace pelt {
namespace {

// All layers `fine` but one in `best` and one of PBD.
Scenario MixedScene(double distance_m) {
  Scenario scenario = LoadScenario("tiny");
  std::vector<GroomLayer>& layers = scenario.grooms[0].layers;
  for (GroomLayer& layer : layers) {
    layer.params.solver = Solver::kModal;
    layer.params.quality = ModalQuality::kFine;
  }
  layers[1].params.quality = ModalQuality::kBest;
  layers[0].params.solver = Solver::kPbd;
  scenario.camera.radius_m = distance_m;
  return scenario;
}

ReportTree RunOf(double distance_m, float allowed_px, bool lod = false) {
  Scenario scenario = MixedScene(distance_m);
  RunOptions options;
  options.frames = 4;
  options.executor = "serial";
  options.lod.fast_quality_px = allowed_px;
  options.skip.lod = lod;
  RunningScenario running(scenario, options.scene);
  return MakeRunTree(RunFrames(scenario, running, options));
}
nlohmann::json QualityOf(double distance_m, float allowed_px, bool lod = false) {
  return nlohmann::json::parse(RunOf(distance_m, allowed_px, lod).Json())["layer_quality"];
}

TEST(LayerQuality, IsThatOfTheFramesThatRan) {
  const nlohmann::json layers = QualityOf(40.0, 0.5f);
  ASSERT_EQ(layers.size(), LoadScenario("tiny").grooms[0].layers.size());
  EXPECT_EQ(layers[0]["solver"], "pbd");
  for (const char* of_modal : {"asked", "ran", "error_px"})
    EXPECT_FALSE(layers[0].contains(of_modal)) << of_modal;
  EXPECT_EQ(layers[1]["asked"], "best");
  EXPECT_EQ(layers[1]["ran"], nlohmann::json({{"fast", 0.0}, {"fine", 0.0}, {"best", 1.0}}));
  for (size_t l = 2; l < layers.size(); ++l) {
    EXPECT_EQ(layers[l]["solver"], "modal");
    EXPECT_EQ(layers[l]["asked"], "fine");
    // The first frame knows no box.
    EXPECT_EQ(layers[l]["ran"], nlohmann::json({{"fast", 0.75}, {"fine", 0.25}, {"best", 0.0}}))
        << layers[l];
  }
  for (const auto& layer : QualityOf(40.0, 0.0f))
    if (layer.value("asked", "") == "fine") {
      EXPECT_EQ(layer["ran"]["fine"], 1.0) << layer;
    }
}

TEST(LayerQuality, ItsBoundIsSmallerFromFurther) {
  const nlohmann::json near = QualityOf(10.0, 1e6f), far = QualityOf(40.0, 1e6f);
  for (size_t l = 1; l < near.size(); ++l) {
    const double ratio = double(near[l]["error_px"]) / double(far[l]["error_px"]);
    EXPECT_NEAR(ratio, 4.0, 0.5) << near[l];  // boxes are not points
  }
}

// With LOD an eighth of the chains at vertices is left, and the bound says what that costs.
TEST(LayerQuality, ChainsThatAreThinnedWidenTheBound) {
  const nlohmann::json all = QualityOf(40.0, 0.5f), thin = QualityOf(40.0, 0.5f, true);
  uint32_t thinned = 0;
  for (size_t l = 1; l < all.size(); ++l) {
    EXPECT_EQ(all[l]["least_chains"], 1.0);
    if (thin[l]["least_chains"] == 1.0) continue;  // of strands
    EXPECT_EQ(thin[l]["least_chains"], 0.125);
    EXPECT_GT(double(thin[l]["error_px"]), 1.3 * double(all[l]["error_px"]));
    ++thinned;
  }
  EXPECT_GT(thinned, 0u);
}

TEST(LayerQuality, TextHasOneRowForLayersThatAreAlike) {
  const std::string text = RunOf(40.0, 0.5f).Text();
  const size_t at = text.find("layers  solver");
  ASSERT_NE(at, std::string::npos) << text;
  const std::string table = text.substr(at, text.find("\n\n", at) - at);
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 4)
      << table;  // heading, units, three kinds
  EXPECT_NE(table.find("modal   fine      75.0   25.0    0.0"), std::string::npos) << table;
}

}  // namespace
}  // namespace pelt
