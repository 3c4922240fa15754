// A scene fitted to a time: on platforms whose prices are made up, and on a modelled one, where the plan costs what was
// said.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "bench/fit/console_price.hpp"
#include "bench/fit/tiers.hpp"
#include "core/error.hpp"
#include "tests/jobs/tiny_scene.hpp"
#include "tests/test_folder.hpp"

namespace pelt {
namespace {

uint64_t PriceOf(const LayerParams& params) {
  if (params.solver != Solver::kModal) return params.solver == Solver::kVerlet ? 1'000 : 2'000;
  const bool root = params.curl_follows == CurlFollows::kRoot;
  return 4'000 + 3'000 * uint64_t(params.quality) - (root ? 500 : 0);
}

// Frames get dearer faster than their core time, as where units are not kept busy.
FitPlatform MadeUp(uint64_t per_million) {
  const auto price = [=](Scenario& scenario) {
    PlatformCost cost;
    for (const GroomLayer& layer : scenario.grooms[0].layers) {
      cost.layer_ns.push_back(PriceOf(layer.params));
      cost.live_strands.push_back(layer.strand_count);
    }
    cost.rest_ns = 10'000;
    const uint64_t core = cost.CoreNs();
    cost.frame_ns = core / 4 + core * core / 1'000'000 * per_million / 1'000'000;
    return cost;
  };
  const auto price_layers = [=](std::span<Scenario> scenes) {
    std::vector<PlatformCost> costs;
    for (Scenario& scene : scenes) costs.push_back(price(scene));
    return costs;
  };
  return {.name = "made up", .price = price, .price_layers = price_layers};
}

SceneFit FitTiny(uint64_t target_ns, uint64_t per_million = 1'000'000) {
  return FitScene(testing::TinyScenario(), {.target_ns = target_ns,
                                            .worst_px = 1e9f,
                                            .platforms = {MadeUp(per_million)},
                                            .warm_up = 4,
                                            .frames = 8});
}

// As FitTiny's, where layers of chains at mesh vertices cost as many as they have, and all layers by their strands.
SceneFit FitShares(uint64_t target_ns, float worst_px) {
  FitPlatform platform = MadeUp(1'000'000);
  const auto whole = platform.price;
  platform.price = [whole](Scenario& scenario) {
    PlatformCost cost = whole(scenario);
    for (size_t l = 0; l < cost.layer_ns.size(); ++l) {
      const GroomLayer& layer = scenario.grooms[0].layers[l];
      cost.layer_ns[l] = uint64_t(double(cost.layer_ns[l]) * layer.params.chain_share);
      cost.layer_ns[l] += 10 * layer.strand_count;
    }
    cost.frame_ns = cost.CoreNs();
    return cost;
  };
  platform.price_layers = [price = platform.price](std::span<Scenario> scenes) {
    std::vector<PlatformCost> costs;
    for (Scenario& scene : scenes) costs.push_back(price(scene));
    return costs;
  };
  return FitScene(testing::TinyScenario(), {.target_ns = target_ns,
                                            .worst_px = worst_px,
                                            .platforms = {platform},
                                            .warm_up = 4,
                                            .frames = 8});
}

TEST(FitScene, IsWithinTheTargetAndBuysWhatItPaysFor) {
  double least_px = 1e30;
  for (const uint64_t target_ns : {13'000, 20'000, 30'000}) {
    const SceneFit fit = FitTiny(target_ns);
    ASSERT_TRUE(fit.Fits()) << target_ns;
    EXPECT_LE(fit.costs[0].frame_ns, target_ns);
    EXPECT_LE(fit.plans_priced, 20u);
    double px = 0.0;
    for (const SceneFit::Layer& layer : fit.layers)
      px += double(layer.strands) * layer.error.p99_micropixels;
    EXPECT_LT(px, least_px) << target_ns;
    least_px = px;
  }
  // All that can be bought.
  const SceneFit rich = FitTiny(1'000'000'000);
  ASSERT_TRUE(rich.Fits());
  EXPECT_FALSE(rich.next);
}

TEST(FitScene, SaysTheLeastThatFits) {
  const SceneFit poor = FitTiny(1'000);
  EXPECT_FALSE(poor.Fits());
  EXPECT_FALSE(poor.next);
  const uint64_t least = poor.costs[0].frame_ns;
  EXPECT_GT(least, 1'000u);
  EXPECT_TRUE(FitTiny(least).Fits());
  EXPECT_FALSE(FitTiny(least - 1).Fits());
}

// The error that was measured of the plan is that of its tiers by themselves: layers have nothing to do
// with each other.
TEST(FitScene, LayersErrorsAreTheirTiers) {
  const Scenario tiny = testing::TinyScenario();
  const SceneFit fit = FitTiny(20'000);
  std::vector<Scenario> ways;
  std::vector<bool> has;
  for (const Tier& tier : Tiers()) ways.push_back(AtTier(tiny, tier, has));
  const auto errors = MeasureTipErrors(tiny, ways, {.warm_up = 4, .frames = 8});
  std::set<std::string> tiers;
  for (size_t l = 0; l < fit.layers.size(); ++l) {
    const auto tier = std::ranges::find(Tiers(), fit.layers[l].tier, &Tier::name) - Tiers().begin();
    ASSERT_LT(size_t(tier), Tiers().size()) << fit.layers[l].tier;
    tiers.insert(fit.layers[l].tier);
    EXPECT_EQ(errors[size_t(tier)][l].off_m, fit.layers[l].error.off_m) << l;
    EXPECT_EQ(errors[size_t(tier)][l].p99_micropixels, fit.layers[l].error.p99_micropixels) << l;
  }
  EXPECT_GT(tiers.size(), 1u);
}

// There is room for two layers of it, whichever.
TEST(FitScene, ATierGetsAsManyLayersAsAPlatformCanRun) {
  FitRequest request{
      .target_ns = 1'000'000'000, .platforms = {MadeUp(1)}, .warm_up = 4, .frames = 4};
  const FitPlatform roomy = request.platforms[0];
  request.platforms[0].price = [roomy](Scenario& scenario) {
    const auto is_best = [](const GroomLayer& layer) {
      return layer.params.quality == ModalQuality::kBest && layer.params.solver == Solver::kModal;
    };
    if (std::ranges::count_if(scenario.grooms[0].layers, is_best) > 2)
      throw Error("no room for it");
    return roomy.price(scenario);
  };
  const SceneFit fit = FitScene(testing::TinyScenario(), request);
  EXPECT_TRUE(fit.Fits());
  ASSERT_EQ(fit.notes.size(), 1u);
  EXPECT_NE(fit.notes[0].find("best: no room for it"), std::string::npos) << fit.notes[0];
  EXPECT_EQ(std::ranges::count(fit.layers, "best", &SceneFit::Layer::tier), 2);
}

TEST(FitScene, FewerChainsAreAChoiceOfLayersThatHaveThem) {
  const Scenario tiny = testing::TinyScenario();
  const SceneFit fit = FitShares(50'000, 1e9f);
  ASSERT_TRUE(fit.Fits()) << fit.costs[0].frame_ns;
  EXPECT_EQ(fit.strand_share, 1.0f);
  uint32_t thinned = 0;
  for (size_t l = 0; l < fit.layers.size(); ++l) {
    const auto share = fit.layers[l].choice.choice.chain_share;
    if (!share) continue;
    ++thinned;
    EXPECT_EQ(tiny.grooms[0].layers[l].params.chain, ChainKind::kVertex)
        << fit.layers[l].choice.name;
    EXPECT_LT(*share, 1.0f);
  }
  EXPECT_GT(thinned, 0u);
}

// Then as many as fit: with a sixteenth more they would not.
TEST(FitScene, StrandsGoWhereNothingElseFits) {
  const SceneFit whole = FitShares(1'000'000, 1e9f);
  ASSERT_TRUE(whole.Fits());
  uint64_t strands = 0;
  for (const SceneFit::Layer& layer : whole.layers) strands += layer.strands;
  const SceneFit least = FitShares(1, 1e9f);
  EXPECT_FALSE(least.Fits());
  EXPECT_EQ(least.strand_share, 0.25f);
  const uint64_t target_ns = least.costs[0].frame_ns + 10 * strands / 3;
  const SceneFit fit = FitShares(target_ns, 1e9f);
  ASSERT_TRUE(fit.Fits());
  EXPECT_FALSE(fit.next);
  EXPECT_GT(fit.strand_share, 0.25f);
  EXPECT_LT(fit.strand_share, 1.0f);
  EXPECT_GT(fit.costs[0].frame_ns + 10 * strands / 16, target_ns);
  for (const SceneFit::Layer& layer : fit.layers)
    EXPECT_EQ(layer.choice.choice.strand_share, fit.strand_share) << layer.choice.name;
  uint64_t kept = 0;
  for (const SceneFit::Layer& layer : fit.layers) kept += layer.strands;
  EXPECT_NEAR(double(kept), double(strands) * double(fit.strand_share), 0.1 * double(strands));
}

// A layer that can be within the allowed error is, regardless of what that costs.
TEST(FitScene, NoLayerIsWorseThanItMustBe) {
  const auto worst = [](const SceneFit& fit) {
    uint32_t most = 0;
    for (const SceneFit::Layer& layer : fit.layers)
      most = std::max(most, layer.error.p99_micropixels);
    return most;
  };
  // What fewer chains add is estimated, so the plan may be over it.
  const uint32_t any = worst(FitShares(1, 1e9f));
  EXPECT_LT(worst(FitShares(1, 0.25e-6f * float(any))), any / 2);
}

// What `pelt fit` states of a console is what `pelt budget --plan` will state.
TEST(FitScene, PlansCostWhatWasSaid) {
  const ConsoleRequest request{.console = Console::kPs3, .frames = 6, .warm_up = 6};
  Scenario planned = testing::TinyScenario();
  const SceneFit fit = FitScene(
      planned,
      {.target_ns = 700'000, .platforms = {OnConsole(request)}, .warm_up = 6, .frames = 6});
  ASSERT_TRUE(fit.Fits());
  const std::string path = test::TestFile(LayerPlanText(fit.Plan()));
  Scenario read = LoadScenario(ScenarioRequest{.scene = "tiny", .plan = path});
  const ConsoleBudget budget = ConsoleRun(read, request).Run();
  EXPECT_NEAR(budget.VerdictMs(), 1e-6 * double(fit.costs[0].frame_ns), 2e-6);
  // Parts of the frame add up to it.
  double parts = fit.LayerMs(0, fit.costs[0].rest_ns);
  for (const uint64_t ns : fit.costs[0].layer_ns) parts += fit.LayerMs(0, ns);
  EXPECT_NEAR(parts, budget.VerdictMs(), 1e-5);
}

}  // namespace
}  // namespace pelt
