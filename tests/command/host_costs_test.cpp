// What a machine's stages cost, as a file, and what a scene costs by it: no clock has a part in that.
#include "bench/fit/host_costs.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "bench/fit/console_price.hpp"
#include "bench/fit/tiers.hpp"
#include "tests/error_from.hpp"
#include "tests/jobs/tiny_scene.hpp"
#include "tests/test_folder.hpp"

namespace pelt {
namespace {

// Of every stage that `tiny` has, in every tier.
HostCosts Flat(uint32_t picoseconds) {
  HostCosts costs{.processor = "a \"machine\"",
                  .commit = "0",
                  .isa = "avx2",
                  .workers = 2,
                  .frame_permille = 1000,
                  .stages = {}};
  Scenario tiny = testing::TinyScenario();
  const RunningScenario running(tiny, {});
  for (const Stage& stage : running.scene().plan().stages) {
    const std::string name(stage.kernel.name);
    if (!name.starts_with("simulate_modal")) {
      costs.stages.push_back({name, "", picoseconds});
      continue;
    }
    for (const Tier& tier : Tiers())
      costs.stages.push_back({name, std::string(tier.name), picoseconds});
  }
  return costs;
}

PlatformCost PriceTiny(const HostCosts& costs) {
  Scenario tiny = testing::TinyScenario();
  return OnHost(costs, "host.toml", 4, 6).price(tiny);
}

std::string CostsError(const std::string& text) {
  return test::ErrorFrom([&] { ReadHostCosts(test::TestFile(text)); });
}

TEST(HostCosts, AreReadAsTheyWereWritten) {
  const HostCosts costs = Flat(1234), read = ReadHostCosts(test::TestFile(HostCostsText(costs)));
  EXPECT_EQ(read.processor, costs.processor);
  EXPECT_EQ(read.workers, 2u);
  EXPECT_EQ(read.frame_permille, 1000u);
  ASSERT_EQ(read.stages.size(), costs.stages.size());
  EXPECT_EQ(HostCostsText(read), HostCostsText(costs));
}

TEST(HostCosts, PriceAFrame) {
  const PlatformCost once = PriceTiny(Flat(100'000));
  EXPECT_EQ(once.layer_ns.size(), 8u);
  for (const uint64_t ns : once.layer_ns) EXPECT_GT(ns, 0u);
  EXPECT_GT(once.frame_ns, 0u);
  const PlatformCost twice = PriceTiny(Flat(200'000));
  EXPECT_NEAR(double(twice.frame_ns), 2.0 * double(once.frame_ns), 4.0);
  // Workers share the core time.
  HostCosts shared = Flat(100'000);
  shared.frame_permille = 500;
  EXPECT_EQ(PriceTiny(shared).frame_ns, once.frame_ns / 2);
  EXPECT_EQ(PriceTiny(shared).layer_ns, once.layer_ns);
}

// Layers `modal5` is best, `modal4` fine.
TEST(HostCosts, OfTheModalSolverAreOfTheTierThatRan) {
  const PlatformCost flat = PriceTiny(Flat(100'000));
  HostCosts dearer = Flat(100'000);
  for (HostCosts::Stage& stage : dearer.stages)
    if (stage.tier == "best") stage.picoseconds *= 10;
  const PlatformCost cost = PriceTiny(dearer);
  const Scenario tiny = testing::TinyScenario();
  for (size_t l = 0; l < tiny.grooms[0].layers.size(); ++l) {
    const LayerParams& params = tiny.grooms[0].layers[l].params;
    const bool best = params.solver == Solver::kModal && params.quality == ModalQuality::kBest;
    EXPECT_EQ(cost.layer_ns[l] > flat.layer_ns[l], best) << l;
  }
}

// ns of tiny's fur, by LodSettings::costs.
double EstimateOfTiny(const FurCosts& costs) {
  Scenario tiny = testing::TinyScenario();
  LodSettings lod;
  lod.budget_us = 1'000'000;
  lod.costs = costs;
  RunningScenario running(tiny, {});
  for (uint32_t f = 0; f < 10; ++f) testing::RunFrame(running, f, {}, lod);
  return running.scene().budget().ns;
}
double TotalOf(const std::vector<uint64_t>& layers) {
  return std::accumulate(layers.begin(), layers.end(), 0.0);
}

// What a frame's choice goes by is what the frame's layers cost, here and on a console.
TEST(FurCosts, AreThoseOfItsLayers) {
  HostCosts costs = Flat(100'000);
  for (size_t s = 0; s < costs.stages.size(); ++s)
    costs.stages[s].picoseconds += uint32_t(1000 * s);
  const Scenario tiny = testing::TinyScenario();
  const double here = TotalOf(PriceTiny(costs).layer_ns);
  EXPECT_NEAR(EstimateOfTiny(FurCostsOnHost(costs, "host.toml", tiny)), here, 0.1 * here);

  const ConsoleRequest request{.console = Console::kPs3, .frames = 6, .warm_up = 4};
  Scenario priced = tiny;
  const double there = TotalOf(OnConsole(request).price_layers({&priced, 1})[0].layer_ns);
  EXPECT_NEAR(EstimateOfTiny(FurCostsOnConsole(tiny, request)), there, 0.15 * there);
}

TEST(HostCosts, TellWhatIsWrongAndWhere) {
  const std::string good = HostCostsText(Flat(1));
  EXPECT_EQ(CostsError(good), "");
  const std::string typo = CostsError(good + "\n[[stage]]\nname = \"x\"\npicosecond = 1\n");
  EXPECT_NE(typo.find("did you mean 'picoseconds'"), std::string::npos) << typo;
  const std::string lacks = CostsError("processor = \"x\"\n");
  EXPECT_NE(lacks.find("'commit'"), std::string::npos) << lacks;
  EXPECT_NE(CostsError("stage = 3\n").find("[[stage]]"), std::string::npos);
  EXPECT_NE(CostsError("[[stage]\n").find(".toml:1"), std::string::npos);
  // Of another program, whose stages are others.
  HostCosts few = Flat(1);
  std::erase_if(few.stages, [](const auto& stage) { return stage.name == "skin"; });
  const std::string text = test::ErrorFrom([&] { PriceTiny(few); });
  EXPECT_NE(text.find("host.toml"), std::string::npos) << text;
  EXPECT_NE(text.find("stage skin"), std::string::npos) << text;
  EXPECT_NE(text.find("pelt calibrate"), std::string::npos) << text;
}

// That it measures all that the scene has, not what.
TEST(HostCosts, AreMeasuredOfEveryStageThatRuns) {
  std::vector<std::string> disturbances;
  const HostCosts costs =
      MeasureHost({.workers = 1, .warm_up = 2, .frames = 3, .scenes = {"tiny"}}, disturbances);
  EXPECT_GT(costs.frame_permille, 0u);
  EXPECT_GT(PriceTiny(costs).frame_ns, 0u);
}

}  // namespace
}  // namespace pelt
