// What a budget buys, on tables that are made by hand.
#include "bench/fit/purchases.hpp"

#include <gtest/gtest.h>

#include "core/random.hpp"

namespace pelt {
namespace {

using Choice = Purchases::Choice;
using Costs = Purchases::Costs;

// Tiers are numbered as they stand.
LayerOptions Options(std::vector<LayerOption> options) {
  for (uint32_t o = 0; o < options.size(); ++o) options[o].tier = o;
  return options;
}

Choice Fill(const Purchases& purchases, const Costs& budget_ns) {
  Choice choice = purchases.Cheapest(budget_ns);
  for (const Purchase& purchase : purchases.Fill(choice, budget_ns))
    choice[purchase.layer] = purchase.option;
  return choice;
}

Purchases TwoLayers() {
  return Purchases({Options({{0, 100, {10}}, {0, 50, {20}}}),
                    Options({{0, 100, {10}}, {0, 80, {12}}, {0, 0, {40}}})});
}

TEST(Purchases, BeginWithTheBestForItsPrice) {
  const Purchases two = TwoLayers();
  EXPECT_EQ(Fill(two, {21}), (Choice{0, 0}));
  // 10 of error for 1, before 5 for 1.
  EXPECT_EQ(Fill(two, {22}), (Choice{0, 1}));
  EXPECT_EQ(Fill(two, {32}), (Choice{1, 1}));
  EXPECT_EQ(Fill(two, {60}), (Choice{1, 2}));
  EXPECT_EQ(Fill(two, {1000}), (Choice{1, 2}));
}

// What does not fit is passed over for what does.
TEST(Purchases, FillWhatIsLeft) {
  const Purchases two(
      {Options({{0, 1000, {10}}, {0, 0, {60}}}), Options({{0, 100, {10}}, {0, 99, {20}}})});
  EXPECT_EQ(Fill(two, {30}), (Choice{0, 1}));
  EXPECT_EQ(Fill(two, {70}), (Choice{1, 0}));
}

TEST(Purchases, NextIsTheBestThatIsNotThere) {
  const Purchases two = TwoLayers();
  const auto next = two.Next({0, 1}, {22});
  ASSERT_TRUE(next);
  EXPECT_EQ(next->layer, 0u);
  EXPECT_EQ(next->option, 1u);
  EXPECT_FALSE(two.Next({1, 2}, {60}));
}

// A tier stays open to the layers that have it.
TEST(Purchases, AClosedTierIsBoughtByNoOther) {
  const LayerOptions same = Options({{0, 100, {10}}, {0, 50, {20}}, {0, 40, {25}}});
  Purchases two({same, same});
  two.Close(1, {1, 0});
  EXPECT_EQ(Fill(two, {30}), (Choice{1, 0}));
  EXPECT_EQ(Fill(two, {45}), (Choice{1, 2}));
}

TEST(Purchases, TiesGoToTheFirstLayer) {
  const LayerOptions same = Options({{0, 100, {10}}, {0, 50, {20}}});
  const Purchases three({same, same, same});
  EXPECT_EQ(Fill(three, {40}), (Choice{1, 0, 0}));
  EXPECT_EQ(Fill(three, {50}), (Choice{1, 1, 0}));
}

TEST(Purchases, LeaveOutWhatIsNoBetter) {
  const LayerOptions left = WithoutWorse(
      Options({{0, 50, {10}}, {0, 60, {9}}, {0, 50, {11}}, {0, 70, {9}}, {0, 50, {10}}}));
  ASSERT_EQ(left.size(), 2u);
  EXPECT_EQ(left[0].tier, 0u);
  EXPECT_EQ(left[1].tier, 1u);
  // Dearer on one platform and cheaper on another: a choice.
  EXPECT_EQ(WithoutWorse(Options({{0, 50, {10, 20}}, {0, 60, {9, 30}}})).size(), 2u);
}

// A purchase costs what it takes most of, on whichever platform.
TEST(Purchases, FitEveryPlatform) {
  const Purchases two({Options({{0, 100, {10, 10}}, {0, 0, {11, 100}}}),
                       Options({{0, 100, {10, 10}}, {0, 50, {30, 30}}})});
  EXPECT_EQ(Fill(two, {1000, 60}), (Choice{0, 1}));
  EXPECT_EQ(Fill(two, {30, 1000}), (Choice{1, 0}));
  EXPECT_EQ(Fill(two, {1000, 1000}), (Choice{1, 1}));
}

TEST(Purchases, AreTheCheapestWhereNothingCanBePaid) {
  const Purchases one({Options({{0, 10, {20}}, {0, 100, {10}}, {0, 0, {30}}})});
  EXPECT_EQ(Fill(one, {5}), (Choice{1}));
  EXPECT_EQ(one.Cheapest({5}), (Choice{1}));
}

TEST(Purchases, CompareLargeNumbers) {
  const uint64_t large = uint64_t{1} << 50;
  const Purchases two({Options({{0, large, {1'000'000}}, {0, 0, {3'000'000}}}),
                       Options({{0, large + 1, {1'000'000}}, {0, 0, {3'000'000}}})});
  EXPECT_EQ(Fill(two, {4'000'000}), (Choice{0, 1}));
}

// Of tables that are drawn: within the budget, and nothing that could be paid for is left.
TEST(Purchases, SpendNoMoreThanThereIsAndAllThatHelps) {
  Random random(7);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<LayerOptions> layers;
    for (int l = 0; l < 6; ++l) {
      LayerOptions& options = layers.emplace_back();
      for (uint32_t o = 0; o < 5; ++o)
        options.push_back({o, random.U64() % 1000, {random.U64() % 500, random.U64() % 500}});
    }
    const Purchases all(layers);
    const Costs budget = {500 + random.U64() % 1500, 500 + random.U64() % 1500};
    const Choice choice = Fill(all, budget);
    const Costs spent = all.CostOf(choice);
    if (choice == all.Cheapest(budget)) continue;
    for (size_t p = 0; p < budget.size(); ++p) ASSERT_LE(spent[p], budget[p]) << trial;
    for (size_t l = 0; l < choice.size(); ++l)
      for (uint32_t o = 0; o < all.layers()[l].size(); ++o) {
        if (all.layers()[l][o].error >= all.layers()[l][choice[l]].error) continue;
        Choice better = choice;
        better[l] = o;
        const Costs cost = all.CostOf(better);
        EXPECT_TRUE(cost[0] > budget[0] || cost[1] > budget[1]) << trial;
      }
  }
}

}  // namespace
}  // namespace pelt
