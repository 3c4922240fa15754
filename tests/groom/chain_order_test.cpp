// Chains thin evenly, and those left out follow what lies about them.
#include "core/groom/chain_order.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <limits>

#include "core/random.hpp"

namespace pelt {
namespace {

glm::vec3 PlaceOf(const ChainPlace& place) {
  return {place.position[0], place.position[1], place.position[2]};
}

// A sheet, 1 m wide.
std::vector<ChainPlace> MakePlaces(uint32_t side) {
  std::vector<ChainPlace> places;
  const float step = 1.0f / float(side - 1);
  for (uint32_t i = 0; i < side * side; ++i)
    places.push_back({{float(i % side) * step, 0.0f, float(i / side) * step}, {0.0f, 1.0f, 0.0f}});
  return places;
}

std::vector<ChainPlace> InOrder(const std::vector<ChainPlace>& places) {
  const std::vector<uint32_t> levels = FindChainLevels(places);
  std::vector<ChainPlace> ordered;
  for (uint32_t level = kChainLevels; level-- > 0;)
    for (size_t i = 0; i < places.size(); ++i)
      if (levels[i] == level) ordered.push_back(places[i]);
  return ordered;
}

// The farthest that a place is from those of a prefix.
double FarthestFrom(const std::vector<ChainPlace>& places, uint32_t prefix) {
  double worst = 0.0;
  for (const ChainPlace& place : places) {
    double nearest = std::numeric_limits<double>::max();
    for (uint32_t i = 0; i < prefix; ++i)
      nearest = std::min(nearest, double(glm::distance(PlaceOf(place), PlaceOf(places[i]))));
    worst = std::max(worst, nearest);
  }
  return worst;
}

TEST(ChainOrder, LevelsAreWholeGroupsOfHalves) {
  for (const uint32_t count : {0u, 1u, 15u, 16u, 17u, 40u, kVerticesPerChunk}) {
    std::vector<ChainPlace> places = MakePlaces(12);
    places.resize(std::min<size_t>(count, places.size()));
    const std::vector<uint32_t> levels = FindChainLevels(places);
    ASSERT_EQ(levels.size(), places.size());
    for (uint32_t level = 0; level < kChainLevels; ++level)
      EXPECT_EQ(uint32_t(std::ranges::count_if(levels, [&](uint32_t l) { return l >= level; })),
                CountChains(uint32_t(places.size()), level))
          << count << ", level " << level;
  }
  EXPECT_EQ(CountChains(kVerticesPerChunk, 0), kVerticesPerChunk);
  EXPECT_EQ(CountChains(kVerticesPerChunk, 1), kVerticesPerChunk / 2);
  EXPECT_EQ(CountChains(40, 1), 32u);
  EXPECT_EQ(CountChains(40, 3), 16u);
  EXPECT_EQ(CountChains(5, 3), 5u);
}

// As few squares of the sheet cover it: no hole is wider than two of their diagonals.
TEST(ChainOrder, EveryPrefixCoversTheSheet) {
  std::vector<ChainPlace> places = MakePlaces(11);
  const std::vector<ChainPlace> ordered = InOrder(places);
  for (uint32_t level = 1; level < kChainLevels; ++level) {
    const uint32_t kept = CountChains(uint32_t(places.size()), level);
    EXPECT_LT(FarthestFrom(ordered, kept), 1.42 / (std::sqrt(double(kept)) - 1.0)) << kept;
  }
}

TEST(ChainOrder, VerticesOfTheFirstStrandsStay) {
  std::vector<ChainPlace> places = MakePlaces(10);
  for (uint32_t i = 0; i < 60; ++i) places[i].use = 2;
  const std::vector<uint32_t> levels = FindChainLevels(places);
  for (uint32_t i = 60; i < 100; ++i) EXPECT_GE(levels[i], 1u) << i;  // 40 of the 64 that stay
}

TEST(ChainOrder, ParentsLieInTheCoarserPrefix) {
  for (const uint32_t side : {3u, 5u, 8u, 11u}) {
    const std::vector<ChainPlace> places = InOrder(MakePlaces(side));
    const uint32_t count = uint32_t(places.size());
    const ChainParentBlock parents = FindChainParents(places);
    for (uint32_t lane = 0; lane < kVerticesPerChunk; ++lane) {
      uint32_t end = 0;
      for (uint32_t level = 1; level < kChainLevels && end == 0; ++level)
        if (lane < count && lane >= CountChains(count, level)) end = CountChains(count, level);
      float sum = 0.0f;
      for (uint32_t k = 0; k < 3; ++k) {
        sum += parents.share[k][lane];
        if (parents.share[k][lane] > 0.0f) {
          EXPECT_LT(parents.lanes[lane] >> 8 * k & 0xffu, end) << lane;
        }
      }
      EXPECT_NEAR(sum, end > 0 ? 1.0f : 0.0f, 1e-6f) << lane;
    }
  }
}

// What changes evenly over the sheet is found again, to some of what lies between neighbours.
TEST(ChainOrder, ParentsLieAbout) {
  const std::vector<ChainPlace> places = InOrder(MakePlaces(11));
  const uint32_t count = uint32_t(places.size());
  const ChainParentBlock parents = FindChainParents(places);
  for (uint32_t lane = CountChains(count, kChainLevels - 1); lane < count; ++lane) {
    glm::vec3 there(0.0f);
    for (uint32_t k = 0; k < 3; ++k)
      there += parents.share[k][lane] * PlaceOf(places[parents.lanes[lane] >> 8 * k & 0xffu]);
    EXPECT_LT(glm::distance(there, PlaceOf(places[lane])), 0.16f) << lane;
  }
}

// On a line, the last place a quarter metre beyond the 16 that stay: by the inverse square of 1/4, 5/4 and 9/4.
TEST(ChainOrder, SaysWhereFollowersArePut) {
  std::vector<ChainPlace> places;
  for (uint32_t i = 0; i < 17; ++i)
    places.push_back({{i < 16 ? float(i) : 15.25f, 0.0f, 0.0f}, {0.0f, 1.0f, 0.0f}});
  EXPECT_TRUE(MeasureFollowing(places, 17).empty());
  const std::vector<double> apart = MeasureFollowing(places, 16);
  ASSERT_EQ(apart.size(), 1u);
  const double weights[] = {16.0, 16.0 / 25.0, 16.0 / 81.0};
  const double put = (weights[0] * 15.0 + weights[1] * 14.0 + weights[2] * 13.0) /
                     (weights[0] + weights[1] + weights[2]);
  EXPECT_NEAR(apart[0], 15.25 - put, 1e-5);
}

// Two sides of a thing 1 mm thick: a vertex follows its own.
TEST(ChainOrder, SidesOfAnEarAreNoNeighbours) {
  std::vector<ChainPlace> places = MakePlaces(8);
  for (size_t i = 0; i < 64; ++i) {
    const float* p = places[i].position;
    places.push_back({{p[0], p[1] - 0.001f, p[2]}, {0.0f, -1.0f, 0.0f}});
  }
  const std::vector<ChainPlace> ordered = InOrder(places);
  const ChainParentBlock parents = FindChainParents(ordered);
  for (uint32_t lane = 16; lane < 128; ++lane) {
    float same = 0.0f;
    for (uint32_t k = 0; k < 3; ++k) {
      const ChainPlace& parent = ordered[parents.lanes[lane] >> 8 * k & 0xffu];
      if (parent.normal[1] == ordered[lane].normal[1]) same += parents.share[k][lane];
    }
    EXPECT_GT(same, 0.7f) << lane;
  }
}

}  // namespace
}  // namespace pelt
