// What no plan is made from: ports that cannot be bound, streams that race within a stage, gates of
// another domain. The text names stage, port and stream.
#include <gtest/gtest.h>

#include <string>

#include "core/error.hpp"
#include "jobs/plan.hpp"
#include "tests/jobs/synthetic_scene.hpp"

namespace pelt {
namespace {

using namespace testing;

const SceneShape kShape = MakeShape({{0, 0, 3}, {0, 0, 2}});

template <class K>
Stage Chunk() {
  return MakeStage<K>(Domain::kChunk);
}

std::string ErrorOf(std::vector<Stage> stages) {
  return CompilePlan(std::move(stages), kShape, {}).error();
}

struct SumLayer {
  static constexpr std::string_view kName = "sum_layer";
  struct Ports {
    All<&Toys::keys> keys;
    Out<&Toys::sum> sum;
  };
  static void Run(const Ports&) {}
};
struct OutToCoarser {
  static constexpr std::string_view kName = "out_to_coarser";
  struct Ports {
    Out<&Toys::box> bounds;
  };
  static void Run(const Ports&) {}
};
struct SharedOfOwnDomain {
  static constexpr std::string_view kName = "shared_of_own";
  struct Ports {
    Shared<&Toys::keys> keys;
  };
  static void Run(const Ports&) {}
};
struct GatherWithoutList {
  static constexpr std::string_view kName = "gather_without_list";
  struct Ports {
    Gather<&Toys::records, &Toys::sum> curves;
  };
  static void Run(const Ports&) {}
};
struct ReadsAndScatters {
  static constexpr std::string_view kName = "reads_and_scatters";
  struct Ports {
    In<&Toys::pairs_a> pairs;
    Scatter<&Toys::pairs_a> sorted;
  };
  static void Run(const Ports&) {}
};

TEST(PlanErrors, RefusesPortsThatCannotBeBound) {
  const auto has = [](const std::string& text, std::string_view part) {
    return text.find(part) != std::string::npos;
  };
  const std::string coarser = ErrorOf({Chunk<OutToCoarser>()});
  EXPECT_TRUE(has(coarser, "stage out_to_coarser: port 'box': ")) << coarser;
  const std::string shared = ErrorOf({Chunk<SharedOfOwnDomain>()});
  EXPECT_TRUE(has(shared, "coarser domain")) << shared;
  const std::string list = ErrorOf({Chunk<GatherWithoutList>()});
  EXPECT_TRUE(has(list, "no record list")) << list;
  const std::string all = ErrorOf({Chunk<SumLayer>()});
  EXPECT_TRUE(has(all, "stage sum_layer: port 'keys'")) << all;
  const std::string race = ErrorOf({Chunk<ReadsAndScatters>()});
  EXPECT_TRUE(has(race, "two ports are of stream pairs_a")) << race;
}

struct OtherTable {
  StreamRow<KeyBlock> keys{"keys", Domain::kChunk, Role::kValue};
  static constexpr uint32_t kChunkLanes = kToyLanes;
};
struct UseOtherTable {
  static constexpr std::string_view kName = "use_other_table";
  struct Ports {
    InOut<&OtherTable::keys> keys;
  };
  static void Run(const Ports&) {}
};

TEST(PlanErrors, RefusesStagesOfTwoTables) {
  const std::string error = ErrorOf({MakeStage<SumLayer>(Domain::kLayer), Chunk<UseOtherTable>()});
  EXPECT_NE(error.find("stage use_other_table: its ports are of another table"), std::string::npos)
      << error;
  EXPECT_EQ(ErrorOf({Chunk<UseOtherTable>()}), "");
}

TEST(PlanErrors, RefusesGatesOfAnotherDomain) {
  const std::string error = ErrorOf({MakeStage<SumLayer>(Domain::kLayer, {kWithToyFlags<1>})});
  EXPECT_NE(error.find("stage sum_layer: its gate is for chunks"), std::string::npos) << error;
}

}  // namespace
}  // namespace pelt
