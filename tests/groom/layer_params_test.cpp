// Layer parameters: one row each for the fur setup, the groom file and the frame.
#include "core/groom/layer_params.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <set>
#include <string>

#include "core/groom/setup_schema.hpp"

namespace pelt {
namespace {

TEST(LayerParams, EveryRowIsAKeyOfTheSetupWithItsBounds) {
  ForEachLayerParam([](const auto& row) {
    const auto keys = Schema<LayerSetup>();
    const auto found = std::ranges::find_if(
        keys, [&](const KeyRow<LayerSetup>& key) { return key.info.key == row.key; });
    ASSERT_NE(found, keys.end()) << row.key;
    EXPECT_EQ(found->info.low, row.low) << row.key;
    EXPECT_EQ(found->info.high, row.high) << row.key;
    EXPECT_EQ(found->info.unit, row.unit) << row.key;
  });
}

TEST(LayerParams, RowsStandInTheOrderOfTheMembersWhichIsTheFiles) {
  const LayerParams params;
  const void* last = nullptr;
  std::set<std::string_view> keys;
  ForEachLayerParam([&](const auto& row) {
    EXPECT_LT(last, static_cast<const void*>(&(params.*row.member))) << row.key;
    last = &(params.*row.member);
    EXPECT_TRUE(keys.insert(row.key).second) << row.key;
  });
}

TEST(LayerParams, ValuesOnTheBoundsAreGoodAndBeyondAreNot) {
  EXPECT_EQ(FindBadParam({}), "");
  LayerParams params;
  params.wet_weight = 10.0f;
  EXPECT_EQ(FindBadParam(params), "");
  params.wet_weight = 10.001f;
  EXPECT_EQ(FindBadParam(params), "wet_weight is not between 0 and 10");
  params = {};
  params.output = Output(kOutputCount);
  EXPECT_EQ(FindBadParam(params),
            "output is not between 0 and " + std::to_string(kOutputCount - 1));
  params = {};
  params.max_distance = kLeastMaxDistance;
  EXPECT_EQ(FindBadParam(params), "");
  params.solver = Solver::kPbd;
  EXPECT_EQ(FindBadParam(params), "max_distance: only solver = \"modal\" keeps it");
  params = {};
  params.dirt_colour[2] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(FindBadParam(params), "dirt_colour is not between 0 and 1");
}

}  // namespace
}  // namespace pelt
