// Layer parameters: one entry each for the fur setup, the groom file and the frame.
#include "core/groom/layer_params.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <set>
#include <string>

#include "core/groom/setup_schema.hpp"

namespace pelt {
namespace {

TEST(LayerParams, EveryEntryIsAKeyOfTheSetupWithItsBounds) {
  ForEachLayerParam([](const auto& entry) {
    const auto keys = Schema<LayerSetup>();
    const auto found = std::ranges::find_if(
        keys, [&](const KeyEntry<LayerSetup>& key) { return key.info.key == entry.key; });
    ASSERT_NE(found, keys.end()) << entry.key;
    EXPECT_EQ(found->info.low, entry.low) << entry.key;
    EXPECT_EQ(found->info.high, entry.high) << entry.key;
    EXPECT_EQ(found->info.unit, entry.unit) << entry.key;
  });
}

TEST(LayerParams, EntriesStandInTheOrderOfTheMembersWhichIsTheFiles) {
  const LayerParams params;
  const void* last = nullptr;
  std::set<std::string_view> keys;
  ForEachLayerParam([&](const auto& entry) {
    EXPECT_LT(last, static_cast<const void*>(&(params.*entry.member))) << entry.key;
    last = &(params.*entry.member);
    EXPECT_TRUE(keys.insert(entry.key).second) << entry.key;
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
  params = {};
  params.look.scatter = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(FindBadParam(params), "look.scatter is not between 0 and 1");
  params.look = {};
  params.look.tint[1] = -0.1f;
  EXPECT_EQ(FindBadParam(params), "look.tint is not between 0 and 4");
}

}  // namespace
}  // namespace pelt
