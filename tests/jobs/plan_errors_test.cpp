// What no plan is made from: ports that cannot be bound, streams that race within a stage, gates of
// another domain. The text names stage, port and stream.
#include <gtest/gtest.h>

#include <string>

#include "core/error.hpp"
#include "jobs/plan.hpp"
#include "tests/jobs/synthetic_scene.hpp"

namespace pelt::testing {
namespace {

std::string ErrorOf(std::vector<Stage> stages) {
  return CompilePlan(std::move(stages), MakeShape({{0, 0, 3}, {0, 0, 2}}), {}).error();
}

using SumOfLayer = Declares<"sum_layer", All<&Toys::keys>, Out<&Toys::sum>>;
using OutToCoarser = Declares<"out_to_coarser", Out<&Toys::box>>;
using SharedOfOwnDomain = Declares<"shared_of_own", Shared<&Toys::keys>>;
using GatherWithoutList = Declares<"gather_without_list", Gather<&Toys::records, &Toys::sum>>;
using ReadsAndScatters =
    Declares<"reads_and_scatters", In<&Toys::pairs_a>, Scatter<&Toys::pairs_a>>;

using SharedPatch = Declares<"shared_patch", Shared<&Toys::marks>, InOut<&Toys::keys>>;
using SharedChunk = Declares<"shared_chunk", Shared<&Toys::keys>, InOut<&Toys::marks>>;
using OwnPatch = Declares<"own_patch", InOut<&Toys::marks>>;
using GatherPartsAlone = Declares<"gather_parts", Gather<&Toys::parts, &Toys::order>>;
using GatherPartsByPatch = Declares<"gather_parts_by_patch", Gather<&Toys::parts, &Toys::marks>>;
using AllPatches = Declares<"all_patches", All<&Toys::marks>>;
using AllLongPatches = Declares<"all_long_patches", All<&Toys::long_parts>>;

bool Has(const std::string& text, std::string_view part) {
  return text.find(part) != std::string::npos;
}

TEST(PlanErrors, RefusesPortsThatCannotBeBound) {
  const std::string coarser = ErrorOf({Chunk<OutToCoarser>()});
  EXPECT_TRUE(Has(coarser, "stage out_to_coarser: port 'box': ")) << coarser;
  const std::string shared = ErrorOf({Chunk<SharedOfOwnDomain>()});
  EXPECT_TRUE(Has(shared, "coarser domain")) << shared;
  const std::string list = ErrorOf({Chunk<GatherWithoutList>()});
  EXPECT_TRUE(Has(list, "no record list")) << list;
  const std::string all = ErrorOf({Chunk<SumOfLayer>()});
  EXPECT_TRUE(Has(all, "stage sum_layer: port 'keys'")) << all;
  const std::string race = ErrorOf({Chunk<ReadsAndScatters>()});
  EXPECT_TRUE(Has(race, "two ports are of stream pairs_a")) << race;
}

// Patches and chunks are beside each other: none is part of the other, and chunks alone gather.
TEST(PlanErrors, RefusesPatchesWhereTheyAreNotPartOfTheItem) {
  const std::string patch = ErrorOf({Chunk<SharedPatch>()});
  EXPECT_TRUE(Has(patch, "stage shared_patch: port 'marks': ")) << patch;
  EXPECT_TRUE(Has(patch, "coarser domain")) << patch;
  const std::string chunk = ErrorOf({MakeStage<SharedChunk>(Domain::kPatch)});
  EXPECT_TRUE(Has(chunk, "stage shared_chunk: port 'keys': ")) << chunk;
  EXPECT_TRUE(Has(chunk, "coarser domain")) << chunk;
  const std::string own = ErrorOf({Chunk<OwnPatch>()});
  EXPECT_TRUE(Has(own, "own blocks are of one domain")) << own;
  EXPECT_EQ(ErrorOf({MakeStage<OwnPatch>(Domain::kPatch)}), "");

  EXPECT_EQ(ErrorOf({Chunk<GatherPartsAlone>()}), "");
  const std::string gather = ErrorOf({MakeStage<GatherPartsAlone>(Domain::kPatch)});
  EXPECT_TRUE(Has(gather, "gathered and scattered by chunks")) << gather;
  const std::string list = ErrorOf({Chunk<GatherPartsByPatch>()});
  EXPECT_TRUE(Has(list, "no record list")) << list;

  EXPECT_EQ(ErrorOf({MakeStage<AllPatches>(Domain::kLayer)}), "");
  EXPECT_EQ(ErrorOf({MakeStage<AllPatches>(Domain::kScene)}), "");
  for (const Domain domain : {Domain::kChunk, Domain::kPatch, Domain::kCharacter}) {
    const std::string all = ErrorOf({MakeStage<AllPatches>(domain)});
    EXPECT_TRUE(Has(all, "stage all_patches: port 'marks': ")) << all;
  }
  const SceneShape mixed = MakeShape({{0, kLong, 1, 1}, {0, 0, 1, 1}});
  const std::string some =
      CompilePlan({MakeStage<AllLongPatches>(Domain::kScene)}, mixed, {}).error();
  EXPECT_TRUE(Has(some, "not every layer has the stream")) << some;
}

struct OtherTable {
  StreamRow<KeyBlock> keys{"keys", Domain::kChunk, Role::kValue};
  static constexpr uint32_t kChunkLanes = kToyLanes;
};
using UseOtherTable = Declares<"use_other_table", InOut<&OtherTable::keys>>;

TEST(PlanErrors, RefusesStagesOfTwoTables) {
  const std::string error =
      ErrorOf({MakeStage<SumOfLayer>(Domain::kLayer), Chunk<UseOtherTable>()});
  EXPECT_NE(error.find("stage use_other_table: its ports are of another table"), std::string::npos)
      << error;
  EXPECT_EQ(ErrorOf({Chunk<UseOtherTable>()}), "");
}

TEST(PlanErrors, RefusesGatesOfAnotherDomain) {
  const std::string error = ErrorOf({MakeStage<SumOfLayer>(Domain::kLayer, {kWithToyFlags<1>})});
  EXPECT_NE(error.find("stage sum_layer: its gate is for a chunk"), std::string::npos) << error;
  const Condition of_patches{[](const FrameMemory&, const ItemPlace&) { return true; },
                             Domain::kPatch,
                             {StreamOf<&Toys::marks>, Stream::kNone}};
  const std::string patch = ErrorOf({MakeStage<GatherPartsAlone>(Domain::kChunk, {of_patches})});
  EXPECT_TRUE(Has(patch, "stage gather_parts: its gate is for a patch")) << patch;
  EXPECT_EQ(ErrorOf({MakeStage<OwnPatch>(Domain::kPatch, {of_patches})}), "");
}

}  // namespace
}  // namespace pelt::testing
