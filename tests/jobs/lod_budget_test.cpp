// A budget of core time: what is least seen gives way first, and no more than must.
#include "jobs/lod_budget.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace pelt {
namespace {

constexpr FurCosts kCosts{.vertex_ns = 2.0f, .strand_ns = 50.0f, .node_ns = {10, 8, 20, 60, 90}};

// Whole groups of strands with chains of three points of their own, whose error in `fast` is `px`.
LayerDemand Layer(double px, ModalQuality quality = ModalQuality::kFine) {
  return {.chunks = 1,
          .strands = 1008,
          .nodes = 3,
          .quality = quality,
          .wanted = 1.0f,
          .fast_px2 = px * px};
}
constexpr double kFineUs = 1.008 * 230.0, kFastUs = 1.008 * 110.0;  // of one
constexpr double kGroup = 0.017;                                    // of its strands

LodSettings Within(uint32_t us) {
  LodSettings lod;
  lod.fast_quality_px = 0.0f;
  lod.budget_us = us;
  lod.costs = kCosts;
  return lod;
}

LodBudget Find(const std::vector<LayerDemand>& layers, const LodSettings& lod, bool thins = true) {
  std::vector<uint32_t> order;
  return FindLodBudget(layers, lod, thins, order);
}

TEST(LodBudget, LeavesAllAsItIsWhereThereIsRoom) {
  LodSettings lod = Within(700);
  lod.fast_quality_px = 0.1f;
  const LodBudget found = Find({Layer(0.3), Layer(0.2), Layer(0.4)}, lod);
  EXPECT_EQ(found.fast_px, 0.1f);
  EXPECT_EQ(found.scale, 1.0f);
  EXPECT_NEAR(found.ns, 3e3 * kFineUs, 0.1);
  lod.budget_us = 0;  // none
  const LodBudget none = Find({Layer(0.3)}, lod);
  EXPECT_EQ(none.fast_px, 0.1f);
  EXPECT_EQ(none.keep_fast_px, 0.1f);
  EXPECT_EQ(none.scale, 1.0f);
}

TEST(LodBudget, TakesTheSmallestErrorFirstAndNoMoreThanMust) {
  const std::vector<LayerDemand> layers = {Layer(0.3), Layer(0.2), Layer(0.4)};
  const LodBudget one = Find(layers, Within(600));
  EXPECT_NEAR(one.fast_px, 0.2f, 1e-5f);
  EXPECT_NEAR(one.ns, 1e3 * (2 * kFineUs + kFastUs), 0.1);
  EXPECT_EQ(one.scale, 1.0f);
  const LodBudget two = Find(layers, Within(500));
  EXPECT_NEAR(two.fast_px, 0.3f, 1e-5f);
  EXPECT_NEAR(two.ns, 1e3 * (kFineUs + 2 * kFastUs), 0.1);
}

TEST(LodBudget, StrandsGoOnlyWhereFastIsNotEnoughOrTooFarOff) {
  const std::vector<LayerDemand> layers = {Layer(0.3), Layer(5.0)};
  const LodBudget enough = Find(layers, Within(345));  // worst_px is 2
  EXPECT_NEAR(enough.fast_px, 0.3f, 1e-5f);
  EXPECT_EQ(enough.scale, 1.0f);
  const LodBudget less = Find(layers, Within(170));
  EXPECT_LE(less.fast_px, 2.0f);
  EXPECT_NEAR(less.scale, 0.5, kGroup);
  EXPECT_LE(less.ns, 170e3);
  EXPECT_GT(less.ns, 163e3);
  // Without --lod strands stay.
  EXPECT_EQ(Find(layers, Within(170), false).scale, 1.0f);
}

TEST(LodBudget, TakesLessFromWhatIsImportant) {
  std::vector<LayerDemand> layers(2, Layer(0.1, ModalQuality::kFast));
  layers[0].importance = 4.0f;
  const LodBudget found = Find(layers, Within(150));
  EXPECT_NEAR(found.scale, (150.0 - kFastUs) / kFastUs, kGroup) << "all of the first";
  EXPECT_LE(found.ns, 150e3);
  EXPECT_GT(found.ns, 145e3);
  layers[0].importance = 0.25f;
  const LodBudget room = Find(layers, Within(250));
  EXPECT_GE(room.scale * 0.25f, 1.0f);
  EXPECT_NEAR(room.ns, 2e3 * kFastUs, 0.1);
  const LodBudget less = Find(layers, Within(150));
  EXPECT_NEAR(0.25 * double(less.scale), (150.0 - kFastUs) / kFastUs, kGroup) << "of the first";
}

TEST(LodBudget, WhatAsksForOtherQualitiesKeepsThem) {
  const std::vector<LayerDemand> layers = {Layer(0.1, ModalQuality::kBest),
                                           Layer(0.1, ModalQuality::kFast)};
  const LodBudget found = Find(layers, Within(100));
  EXPECT_EQ(found.fast_px, 0.0f);
  EXPECT_NEAR(found.scale, 100.0 / (1.008 * (320.0 + 110.0)), kGroup);
}

TEST(LodBudget, CountsNoLayerOutOfView) {
  std::vector<LayerDemand> layers = {Layer(0.3), Layer(0.2)};
  layers[1].wanted = 0.0f;
  const LodBudget found = Find(layers, Within(235));
  EXPECT_EQ(found.fast_px, 0.0f);
  EXPECT_NEAR(found.ns, 1e3 * kFineUs, 0.1);
}

// Chains at vertices thin by halves, to an eighth or to LodSettings::least_chains.
TEST(LodBudget, ChainsAtVerticesThinWithTheStrandsDownToTheirLeast) {
  LayerDemand layer = Layer(9.0);
  layer.on_vertices = true;
  layer.vertices = 128;
  layer.patches = 1;
  const double chains = 128 * (2.0 + 3 * 60.0), strands = 1008 * 50.0;  // ns
  const auto expect = [&](LodSettings lod, uint32_t us, double of_chains) {
    lod.budget_us = us;
    const LodBudget found = Find({layer}, lod);
    EXPECT_NEAR(found.scale, (1e3 * us - of_chains * chains) / strands, kGroup) << us;
    EXPECT_LE(found.ns, 1e3 * us);
    EXPECT_GT(found.ns, 0.93 * 1e3 * us);
  };
  LodSettings lod = Within(1);
  expect(lod, 42, 0.5);
  expect(lod, 14, 0.125);
  lod.least_chains = 0.5f;
  expect(lod, 18, 0.5);
  // Not with the fewest, which stay.
  lod.budget_us = 5;
  EXPECT_EQ(Find({layer}, lod).scale, 1.0f / 32);
  EXPECT_GT(Find({layer}, lod).ns, 5e3);
}

TEST(LodBudget, BlocksCostWhateverLivesOfThem) {
  LayerDemand layer = Layer(9.0);
  layer.patches = 9;  // and its chunk
  LodSettings lod = Within(100);
  lod.costs.chunk_ns = 1000.0f;
  EXPECT_NEAR(Find({layer}, lod).scale, 90.0 / kFineUs, kGroup);
}

TEST(LodBudget, FastIsKeptUntilThereIsRoomWithoutIt) {
  const std::vector<LayerDemand> layers = {Layer(0.3), Layer(0.2)};
  // Fits as it is, but for less than a tenth of the budget.
  const LodBudget tight = Find(layers, Within(470));
  EXPECT_EQ(tight.fast_px, 0.0f);
  EXPECT_NEAR(tight.keep_fast_px, 0.2f, 1e-5f);
  const LodBudget wide = Find(layers, Within(520));
  EXPECT_EQ(wide.keep_fast_px, 0.0f);
}

}  // namespace
}  // namespace pelt
