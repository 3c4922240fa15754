// The bounds of layer parameters: one table for the fur setup and the groom reader.
#include "core/groom/layer_params.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <set>

#include "core/groom/setup_schema.hpp"

namespace pelt {
namespace {

TEST(LayerParams, SetupAndGroomHaveTheSameBounds) {
  std::set<std::string_view> bounded;
  for (const auto& row : Schema<LayerSetup>()) {
    const ParamBounds* bounds = FindParamBounds(row.info.key);
    if (!bounds) continue;
    bounded.insert(row.info.key);
    const double high = row.info.words.empty() ? row.info.high : double(row.info.words.size() - 1);
    EXPECT_EQ(bounds->low, row.info.low) << row.info.key;
    EXPECT_EQ(bounds->high, high) << row.info.key;
  }
  EXPECT_EQ(bounded.size(), 28u);
}

TEST(LayerParams, ValuesOnTheBoundsAreGoodAndBeyondAreNot) {
  EXPECT_EQ(FindBadParam({}), "");
  LayerParams params;
  params.wet_weight = 10.0f;
  EXPECT_EQ(FindBadParam(params), "");
  params.wet_weight = 10.001f;
  EXPECT_EQ(FindBadParam(params), "wet_weight is not between 0 and 10");
  params = {};
  params.output = Output(2);
  EXPECT_EQ(FindBadParam(params), "output is not between 0 and 1");
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
