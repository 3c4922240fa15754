// What whole scenes survive: every promise of every row, and that the rows detect a broken one.
#include <gtest/gtest.h>

#include <cstdio>

#include "bench/accuracy/stress.hpp"
#include "core/isa.hpp"

namespace pelt::accuracy {
namespace {

TEST(SceneStress, PromisesAreKept) {
  const std::vector<SceneStressResult> rows = RunSceneStress(BestIsa());
  EXPECT_EQ(rows.size(), 17u);
  for (const SceneStressResult& row : rows) {
    std::printf("%-44s stretch %.1e, unsettled %llu, apart %.1e of %.1e, rests %.1e\n",
                row.name.c_str(), row.worst_stretch, (unsigned long long)row.unsettled,
                row.apart.value_or(0.0), row.rigid_apart.value_or(0.0),
                row.apart_at_end.value_or(0.0));
    EXPECT_GT(row.strands, 300u) << row.name;
    for (const std::string& broken : BrokenPromises(row))
      ADD_FAILURE() << row.name << ": " << broken;
    if (row.name.starts_with("a bar")) {
      EXPECT_GT(*row.apart, 0.03) << row.name << " that touches nothing";
    }
    // In the world's floats the same strands are off by what a float is: the row shows it.
    if (row.promised) continue;
    EXPECT_GT(row.worst_stretch, 1e-3) << row.name;
    EXPECT_GT(*row.apart, 5e-3) << row.name;
  }
}

TEST(SceneStress, BrokenPromisesAreTold) {
  SceneStressResult row;
  EXPECT_TRUE(BrokenPromises(row).empty());
  row.strands = 100;
  row.non_finite = 1;
  row.unsettled = 4;
  row.worst_stretch = 1.0;
  row.apart = row.apart_at_end = 0.2;
  EXPECT_EQ(BrokenPromises(row).size(), 3u);
  row.most_apart = row.most_at_end = 0.1;
  EXPECT_EQ(BrokenPromises(row).size(), 5u);
  row.promised = false;
  EXPECT_TRUE(BrokenPromises(row).empty());
}

}  // namespace
}  // namespace pelt::accuracy
