// The plan is derived: passes, waits, residency and who takes part follow from the ports alone.
// Kernels here do little; what counts is what they declare.
#include "jobs/plan.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <map>
#include <string>
#include <utility>

#include "core/error.hpp"
#include "tests/jobs/synthetic_scene.hpp"

namespace pelt::testing {
namespace {

// keys -> order, own chunk.
using KeysToOrder = Declares<"keys_to_order", In<&Toys::keys>, Out<&Toys::order>>;
using MakeKeys = Declares<"make_keys", Out<&Toys::keys>>;
// Scratch between two chunk stages: pairs_b is written and read here and nowhere else.
using MakePairs = Declares<"make_pairs", In<&Toys::keys>, Out<&Toys::pairs_b>>;
using UsePairs = Declares<"use_pairs", In<&Toys::pairs_b>, Out<&Toys::order>>;
using ScatterPairs = Declares<"scatter_pairs", In<&Toys::keys>, Scatter<&Toys::pairs_a>>;
using ReadScattered = Declares<"read_scattered", In<&Toys::pairs_a>, Out<&Toys::counts>>;
using MakeCurves = Declares<"make_curves", Out<&Toys::records>>;
using GatherCurves = Declares<"gather_curves", In<&Toys::order>,
                              Gather<&Toys::records, &Toys::order>, Out<&Toys::copies>>;
using SumLayer = Declares<"sum_layer", All<&Toys::keys>, Out<&Toys::sum>>;
using UseBounds = Declares<"use_bounds", Shared<&Toys::box>, InOut<&Toys::keys>>;

using UseBox = Declares<"use_box", InOut<&Toys::box>>;
using SumBoxes = Declares<"sum_boxes", AllInOut<&Toys::box>>;
using SetState = Declares<"set_state", Out<&Toys::state>>;
using UseSum = Declares<"use_sum", Shared<&Toys::sum>, InOut<&Toys::keys>>;
using SumSums = Declares<"sum_sums", AllInOut<&Toys::sum>>;

using MakeParts = Declares<"make_parts", Out<&Toys::parts>, Out<&Toys::marks>>;
using GatherParts = Declares<"gather_parts", In<&Toys::order>, Gather<&Toys::parts, &Toys::order>,
                             Out<&Toys::copies>>;
using GatherMarks = Declares<"gather_marks", In<&Toys::list>,
                             GatherBlocks<&Toys::marks, &Toys::list>, InOut<&Toys::keys>>;
using SumParts = Declares<"sum_parts", All<&Toys::parts>, Out<&Toys::sum>>;

const SceneShape kShape = MakeShape({{0, 0, 3}, {0, 0, 2}});
const SceneShape kPatched = MakeShape({{0, 0, 3, 4}, {0, 0, 2, 1}});

std::vector<std::string> PassNames(const Plan& plan) {
  std::vector<std::string> names;
  for (const Pass& pass : plan.passes) {
    std::string name;
    for (uint32_t s = 0; s < pass.stage_count; ++s) {
      if (s) name += " ";
      name += plan.stages[pass.first_stage + s].kernel.name;
    }
    names.push_back(name);
  }
  return names;
}
using Names = std::vector<std::string>;

const PassStream& FindStream(const Pass& pass, Stream stream) {
  for (const PassStream& s : pass.streams)
    if (s.stream == stream) return s;
  ADD_FAILURE() << "pass has no stream " << TableOf<Toys>()[stream].name;
  return pass.streams.front();
}

std::string Refusal(std::vector<Stage> stages, const SceneShape& shape, PlanOptions options = {}) {
  return CompilePlan(std::move(stages), shape, options).error();
}

Plan Compile(std::vector<Stage> stages, const SceneShape& shape = kShape,
             const PlanOptions& options = {}) {
  return CompilePlan(std::move(stages), shape, options).OrThrow();
}

// Of an unfused plan: one pass per stage.
Plan Unfused(std::vector<Stage> stages, const SceneShape& shape = kPatched) {
  return Compile(std::move(stages), shape, {.fuse = false});
}

TEST(Plan, FusesStagesThatTouchOnlyTheirItem) {
  struct Case {
    const char* what;
    std::vector<Stage> stages;
    Names passes;
  };
  const Case cases[] = {
      {"only their item", {Chunk<MakeKeys>(), Chunk<KeysToOrder>()}, {"make_keys keys_to_order"}},
      {"a gather and what does not concern it",
       {Chunk<MakeKeys>(), Chunk<GatherCurves>()},
       {"make_keys gather_curves"}},
      {"the domain changes",
       {Chunk<MakeKeys>(), MakeStage<SumLayer>(Domain::kLayer), Chunk<KeysToOrder>()},
       {"make_keys", "sum_layer", "keys_to_order"}},
      {"scatter and reader",
       {Chunk<ScatterPairs>(), Chunk<ReadScattered>()},
       {"scatter_pairs", "read_scattered"}},
      {"not the first of its pass scatters",
       {Chunk<MakeKeys>(), Chunk<ScatterPairs>(), Chunk<ReadScattered>()},
       {"make_keys scatter_pairs", "read_scattered"}},
      {"reader and scatter",
       {Chunk<ReadScattered>(), Chunk<ScatterPairs>()},
       {"read_scattered", "scatter_pairs"}},
      {"writer and gather",
       {Chunk<MakeCurves>(), Chunk<GatherCurves>()},
       {"make_curves", "gather_curves"}},
      {"a record list and its gather",
       {Chunk<KeysToOrder>(), Chunk<GatherCurves>()},
       {"keys_to_order", "gather_curves"}},
  };
  for (const Case& c : cases) EXPECT_EQ(PassNames(Compile(c.stages)), c.passes) << c.what;
  EXPECT_EQ(Compile(cases[2].stages).passes[1].domain, Domain::kLayer);
}

TEST(Plan, UnfusedHasOnePassAStage) {
  const Plan plan = Unfused({Chunk<MakeKeys>(), Chunk<KeysToOrder>()}, kShape);
  EXPECT_EQ(PassNames(plan), Names({"make_keys", "keys_to_order"}));
}

template <class K>
Stage Patch() {
  return MakeStage<K>(Domain::kPatch);
}

// Chunks reach any patch of their layer, so all of these are done before.
TEST(Plan, EndsAPassBetweenPatchesAndTheChunksThatGatherThem) {
  const Plan plan =
      Compile({Patch<MakeParts>(), Chunk<MakeKeys>(), Chunk<GatherParts>()}, kPatched);
  EXPECT_EQ(PassNames(plan), Names({"make_parts", "make_keys gather_parts"}));
  EXPECT_EQ(plan.passes[0].domain, Domain::kPatch);
  EXPECT_EQ(plan.passes[1].domain, Domain::kChunk);
  const Plan apart =
      Compile({Patch<MakeParts>(), Chunk<MakeKeys>(), Chunk<KeysToOrder>()}, kPatched);
  EXPECT_EQ(PassNames(apart), Names({"make_parts", "make_keys keys_to_order"}));
}

// What chunks gather in a later pass is not gone with the pass that made it.
TEST(Plan, KeepsWhatPatchesMakeForChunks) {
  const Plan plan = Compile({Patch<MakeParts>(), Chunk<GatherParts>()}, kPatched);
  const PassStream& made = FindStream(plan.passes[0], StreamOf<&Toys::parts>);
  EXPECT_FALSE(made.transient);
  EXPECT_TRUE(made.put);
  EXPECT_EQ(made.bytes, sizeof(RecordBlock));
  const PassStream& gathered = FindStream(plan.passes[1], StreamOf<&Toys::parts>);
  EXPECT_TRUE(gathered.get);
  EXPECT_FALSE(gathered.put);
  EXPECT_EQ(gathered.bytes, kToyLanes * sizeof(Record));
}

// Of whole blocks as many are resident as the list is long, however many lanes a chunk has.
TEST(Plan, GatheredBlocksAreAsManyAsTheirList) {
  const Plan plan = Compile({Patch<MakeParts>(), Chunk<GatherMarks>()}, kPatched);
  EXPECT_EQ(PassNames(plan), Names({"make_parts", "gather_marks"}));
  const PassStream& marks = FindStream(plan.passes[1], StreamOf<&Toys::marks>);
  EXPECT_EQ(marks.access, Access::kGather);
  EXPECT_EQ(marks.bytes, kToyListed * sizeof(WordBlock));
  const PortDesc& port = plan.stages[1].kernel.ports[1];
  EXPECT_EQ(port.records, kToyListed);
  EXPECT_EQ(port.block_bytes, sizeof(WordBlock));
  EXPECT_EQ(port.record_list, StreamOf<&Toys::list>);
}

using Waits = std::vector<Wait>;

TEST(PlanWaits, AreForTheItemWhereBothSidesHaveOnlyTheirOwn) {
  const Plan plan = Unfused({Chunk<MakeKeys>(), Chunk<KeysToOrder>()});
  EXPECT_EQ(plan.passes[0].waits, Waits());
  EXPECT_EQ(plan.passes[1].waits, Waits({{0, Domain::kChunk}}));
  EXPECT_EQ(plan.waits_of_end, Waits({{1, Domain::kScene}}));
}

TEST(PlanWaits, AreForTheLayerWhereOneSideReachesAcrossIt) {
  const Plan sum = Unfused({Chunk<MakeKeys>(), MakeStage<SumLayer>(Domain::kLayer)});
  EXPECT_EQ(sum.passes[1].waits, Waits({{0, Domain::kLayer}}));
  const Plan scatter = Unfused({Chunk<ScatterPairs>(), Chunk<ReadScattered>()});
  EXPECT_EQ(scatter.passes[1].waits, Waits({{0, Domain::kLayer}}));
  const Plan before = Unfused({Chunk<ReadScattered>(), Chunk<ScatterPairs>()});
  EXPECT_EQ(before.passes[1].waits, Waits({{0, Domain::kLayer}})) << "reading comes first";
}

TEST(PlanWaits, AreForWhatABakedListNames) {
  const Plan listed = Unfused({Patch<MakeParts>(), Chunk<GatherMarks>()});
  EXPECT_EQ(listed.passes[1].waits, Waits({{0, Domain::kLayer, StreamOf<&Toys::list>}}));
  EXPECT_EQ(listed.waits_of_end, Waits({{0, Domain::kScene}, {1, Domain::kScene}}))
      << "a list may leave some out";
  const Plan made = Unfused({Patch<MakeParts>(), Chunk<GatherParts>()});
  EXPECT_EQ(made.passes[1].waits, Waits({{0, Domain::kLayer}})) << "the frame makes the list";
}

TEST(PlanWaits, AreForTheUnitThatIsShared) {
  const Plan plan = Unfused({MakeStage<UseBox>(Domain::kLayer), Chunk<UseBounds>()});
  EXPECT_EQ(plan.passes[1].waits, Waits({{0, Domain::kLayer}}));
  const Plan scene =
      Unfused({MakeStage<UseBox>(Domain::kLayer), MakeStage<SumBoxes>(Domain::kScene)});
  EXPECT_EQ(scene.passes[1].waits, Waits({{0, Domain::kScene}}));
}

TEST(PlanWaits, AreForWhatAConditionLooksAt) {
  const Gate gate{kWithToyFlags<1>};
  const Plan plan = Unfused({Chunk<SetState>(), Chunk<MakeKeys>(gate)});
  EXPECT_EQ(plan.passes[1].waits, Waits({{0, Domain::kChunk}}));
}

// The last one reads the keys as well; but it waits for a sum that was made of them.
TEST(PlanWaits, LeaveOutWhatFollows) {
  const std::vector<Stage> stages = {Chunk<MakeKeys>(), MakeStage<SumLayer>(Domain::kLayer),
                                     Chunk<UseSum>()};
  EXPECT_EQ(Unfused(stages).passes[2].waits, Waits({{1, Domain::kLayer}}));
  // Where a character has no layers at all nothing follows.
  const SceneShape gap = MakeShape({{0, 0, 1, 1}, {2, 0, 1, 1}});
  EXPECT_EQ(Unfused(stages, gap).passes[2].waits,
            Waits({{0, Domain::kChunk}, {1, Domain::kLayer}}));
}

// Found without the graph: every item once, and none before what it waits for.
TEST(FrameGraph, OpensEveryItemAfterWhatItWaitsFor) {
  const SceneShape shape = MakeShape({{0, 0, 3, 4}, {0, 0, 0, 2}, {1, 0, 70, 1}, {1, 0, 2, 0}});
  const Plan plan = Unfused({Patch<MakeParts>(), Chunk<MakeKeys>(), Chunk<GatherMarks>(),
                             MakeStage<SumLayer>(Domain::kLayer), Chunk<UseSum>(),
                             Chunk<KeysToOrder>(), MakeStage<SumSums>(Domain::kScene)},
                            shape);
  const FrameGraph& graph = plan.graph;
  std::vector<uint32_t> left;
  for (const FrameGraph::Node& node : graph.nodes) left.push_back(node.waits_for);
  std::vector<std::pair<uint32_t, uint32_t>> ran;
  const std::function<void(uint32_t)> fire = [&](uint32_t node) {
    std::vector<std::pair<uint32_t, uint32_t>> opened;
    graph.ForEachOpened(
        node, [&](uint32_t pass, uint32_t item, uint32_t) { opened.emplace_back(pass, item); });
    for (const auto& [pass, item] : opened) {
      for (const Wait& wait : plan.passes[pass].waits)
        for (uint32_t i = 0; i < shape.ItemCount(plan.passes[wait.pass].domain); ++i) {
          const bool awaited =
              PlaceOf(shape, plan.passes[wait.pass].domain, i).first[size_t(wait.within)] ==
              PlaceOf(shape, plan.passes[pass].domain, item).first[size_t(wait.within)];
          if (!awaited) continue;
          EXPECT_EQ(std::count(ran.begin(), ran.end(), std::pair(wait.pass, i)), 1)
              << "item " << item << " of pass " << pass << " runs before item " << i << " of pass "
              << wait.pass;
        }
    }
    for (const auto& [pass, item] : opened) {
      ran.emplace_back(pass, item);
      const uint32_t counts = graph.item_node[graph.pass_first[pass] + item];
      if (--left[counts] == 0) fire(counts);
    }
    for (uint32_t n = graph.nodes[node].first_next; n < graph.nodes[node + 1].first_next; ++n)
      if (--left[graph.next[n]] == 0) fire(graph.next[n]);
  };
  fire(0);
  EXPECT_EQ(left[graph.LastNode()], 0u) << "the frame has no end";
  std::sort(ran.begin(), ran.end());
  EXPECT_EQ(std::unique(ran.begin(), ran.end()), ran.end());
  EXPECT_EQ(ran.size(), graph.items.size());
}

TEST(Plan, ALayerTakesAllItsPatches) {
  const Plan plan = Compile({Patch<MakeParts>(), MakeStage<SumParts>(Domain::kLayer)}, kPatched);
  EXPECT_EQ(PassNames(plan), Names({"make_parts", "sum_parts"}));
  const PassStream& parts = FindStream(plan.passes[1], StreamOf<&Toys::parts>);
  EXPECT_EQ(parts.bytes, 4 * sizeof(RecordBlock)) << "patches of the layer, not its chunks";
}

TEST(Plan, StreamsOfPatchesSayWhichLayersAStageRunsOn) {
  const std::vector<Stage> stages = {Patch<MakeParts>(), Patch<UseLongParts>()};
  const Plan without = Compile(stages, kPatched);
  EXPECT_EQ(PassNames(without), Names({"make_parts"}));
  const SceneShape mixed = MakeShape({{0, 0, 1, 1}, {0, kLong, 1, 1}});
  const Plan with = Compile(stages, mixed);
  EXPECT_EQ(PassNames(with), Names({"make_parts use_long_parts"}));
  EXPECT_TRUE(with.stages[1].kinds.Admits(kLong));
  EXPECT_FALSE(with.stages[1].kinds.Admits(0));
}

TEST(Plan, FusesOnlyWhatFitsTwiceOver) {
  const uint32_t keys = sizeof(KeyBlock), pairs = sizeof(PairBlock), order = sizeof(PlaceBlock);
  // Pairs live and die inside the fused pass: one copy. Keys and order stream through: two.
  const uint32_t fused = 2 * keys + pairs + 2 * order;
  const std::vector<Stage> stages = {Chunk<MakePairs>(), Chunk<UsePairs>()};
  const Plan fits = Compile(stages, kShape, {.local_store_data_bytes = fused});
  EXPECT_EQ(PassNames(fits), Names({"make_pairs use_pairs"}));
  EXPECT_EQ(fits.passes[0].resident_bytes, fused);
  EXPECT_TRUE(fits.passes[0].double_buffered);
  const Plan cut = Compile(stages, kShape, {.local_store_data_bytes = fused - 1});
  EXPECT_EQ(PassNames(cut), Names({"make_pairs", "use_pairs"}));
}

// A pass with much code has less room for its own data, and no other has.
TEST(Plan, CodeTakesOfItsOwnPassAlone) {
  const uint32_t fused = 2 * sizeof(KeyBlock) + sizeof(PairBlock) + 2 * sizeof(PlaceBlock);
  const std::vector<Stage> stages = {Chunk<MakePairs>(), Chunk<UsePairs>(),
                                     MakeStage<SumLayer>(Domain::kLayer)};
  PlanOptions options{.local_store_data_bytes = 0, .code_and_data_bytes = 100'000};
  std::map<std::string_view, uint32_t> code;
  options.code_bytes = [&](std::string_view kernel) { return code[kernel]; };
  code["make_pairs"] = 1'000;
  code["use_pairs"] = 100'000 - 1'000 - fused;
  const Names whole({"make_pairs use_pairs", "sum_layer"}),
      cut({"make_pairs", "use_pairs", "sum_layer"});
  EXPECT_EQ(PassNames(Compile(stages, kShape, options)), whole);
  code["sum_layer"] = 50'000;
  EXPECT_EQ(PassNames(Compile(stages, kShape, options)), whole);
  ++code["use_pairs"];
  EXPECT_EQ(PassNames(Compile(stages, kShape, options)), cut);
  code["sum_layer"] = 100'000;
  EXPECT_NE(Refusal(stages, kShape, options).find("the 0 there are beside 100000 of code"),
            std::string::npos)
      << Refusal(stages, kShape, options);
}

TEST(Plan, InMainMemoryStagesFuseWhileTheyFitACacheTwiceOver) {
  const uint32_t fused = 2 * sizeof(KeyBlock) + sizeof(PairBlock) + 2 * sizeof(PlaceBlock);
  const std::vector<Stage> stages = {Chunk<MakePairs>(), Chunk<UsePairs>()};
  PlanOptions options{.local_store_data_bytes = fused - 1, .cache_bytes = fused, .must_fit = false};
  const Plan whole = Compile(stages, kShape, options);
  EXPECT_EQ(PassNames(whole), Names({"make_pairs use_pairs"}));
  options.cache_bytes = fused - 1;
  const Plan cut = Compile(stages, kShape, options);
  EXPECT_EQ(PassNames(cut), Names({"make_pairs", "use_pairs"}));
  options = {.local_store_data_bytes = fused - 1, .cache_bytes = fused};
  const Plan local = Compile(stages, kShape, options);
  EXPECT_EQ(PassNames(local), Names({"make_pairs", "use_pairs"})) << "a local store has no cache";
}

TEST(Plan, KnowsTransientsAndCountsTheirBytesNowhere) {
  const std::vector<Stage> stages = {Chunk<MakePairs>(), Chunk<UsePairs>()};
  const Plan fused = Compile(stages);
  const PassStream& pairs = FindStream(fused.passes[0], StreamOf<&Toys::pairs_b>);
  EXPECT_TRUE(pairs.transient);
  EXPECT_FALSE(pairs.get);
  EXPECT_EQ(fused.passes[0].get_bytes, sizeof(KeyBlock));
  EXPECT_EQ(fused.passes[0].put_bytes, sizeof(PlaceBlock));

  const Plan unfused = Compile(stages, kShape, {.fuse = false});
  EXPECT_FALSE(FindStream(unfused.passes[0], StreamOf<&Toys::pairs_b>).transient);
  EXPECT_EQ(unfused.passes[0].put_bytes, sizeof(PairBlock));
  EXPECT_EQ(unfused.passes[1].get_bytes, sizeof(PairBlock));
}

TEST(Plan, OutCostsNoGetAndInNoPut) {
  const Plan plan = Compile({Chunk<KeysToOrder>()});
  const PassStream& keys = FindStream(plan.passes[0], StreamOf<&Toys::keys>);
  const PassStream& order = FindStream(plan.passes[0], StreamOf<&Toys::order>);
  EXPECT_TRUE(keys.get);
  EXPECT_FALSE(keys.put);
  EXPECT_FALSE(order.get);
  EXPECT_TRUE(order.put);
  EXPECT_FALSE(order.transient) << "an output of the frame must be put";
}

TEST(Plan, SharedBlocksAreResidentOnceAndNotCountedPerItem) {
  const Plan plan = Compile({Chunk<UseBounds>()});
  EXPECT_EQ(plan.passes[0].resident_bytes, sizeof(WordBlock) + 2 * sizeof(KeyBlock));
  EXPECT_EQ(plan.passes[0].get_bytes, sizeof(KeyBlock));
}

TEST(Plan, BuffersSinglyWhatFitsOnlyOnce) {
  const uint32_t once = 3 * sizeof(KeyBlock) + sizeof(WordBlock);
  const std::vector<Stage> stages = {MakeStage<SumLayer>(Domain::kLayer)};
  const Plan plan = Compile(stages, kShape, {.local_store_data_bytes = once});
  EXPECT_FALSE(plan.passes[0].double_buffered);
  EXPECT_EQ(plan.passes[0].resident_bytes, once) << "the largest layer, 3 chunks, counts";
  EXPECT_TRUE(
      Compile(stages, kShape, {.local_store_data_bytes = 2 * once}).passes[0].double_buffered);
}

TEST(Plan, RefusesAStageThatDoesNotFitAndSaysByHowMuch) {
  const uint32_t once = 3 * sizeof(KeyBlock) + sizeof(WordBlock);
  const std::string error =
      Refusal({MakeStage<SumLayer>(Domain::kLayer)}, kShape, {.local_store_data_bytes = once - 1});
  EXPECT_NE(error.find("stage sum_layer"), std::string::npos) << error;
  EXPECT_NE(error.find("one layer needs " + std::to_string(once) + " bytes"), std::string::npos)
      << error;
  EXPECT_NE(error.find("1 more than"), std::string::npos) << error;
}

TEST(Plan, InMainMemoryAStageThatDoesNotFitIsAPassOfItsOwn) {
  const uint32_t once = 3 * sizeof(KeyBlock) + sizeof(WordBlock);
  const Stage sum = MakeStage<SumLayer>(Domain::kLayer);
  const Plan roomy = Compile({sum, sum}, kShape, {.must_fit = false});
  EXPECT_EQ(PassNames(roomy), Names({"sum_layer sum_layer"}));
  const Plan tight =
      Compile({sum, sum}, kShape,
              {.local_store_data_bytes = once - 1, .cache_bytes = once - 1, .must_fit = false});
  EXPECT_EQ(PassNames(tight), Names({"sum_layer", "sum_layer"}));
  EXPECT_EQ(tight.passes[0].resident_bytes, once);
}

TEST(Plan, StreamsSayWhichLayersAStageRunsOn) {
  const SceneShape shape = MakeShape({{0, kLong, 1}, {0, 0, 1}});
  const Plan plan = Compile({Chunk<UseVertexPoints>()}, shape);
  ASSERT_EQ(plan.stages.size(), 1u);
  EXPECT_TRUE(plan.stages[0].kinds.Admits(kLong));
  EXPECT_FALSE(plan.stages[0].kinds.Admits(0));
  EXPECT_FALSE(plan.stages[0].kinds.Admits(kHard));
}

TEST(Plan, LeavesOutStagesThatNoLayerHasTheKindFor) {
  const std::vector<Stage> stages = {Chunk<MakeKeys>(), Chunk<UseVertexPoints>(),
                                     Chunk<KeysToOrder>({}, {kRound, 0}),
                                     Chunk<ReadScattered>({}, {0, kRound})};
  const Plan strands = Compile(stages, MakeShape({{0, 0, 1}}));
  EXPECT_EQ(PassNames(strands), Names({"make_keys read_scattered"}));
  const Plan verlet = Compile(stages, MakeShape({{0, kRound, 1}}));
  EXPECT_EQ(PassNames(verlet), Names({"make_keys keys_to_order"}));
  const Plan both = Compile(stages, MakeShape({{0, kRound, 1}, {0, kLong, 1}}));
  EXPECT_EQ(PassNames(both), Names({"make_keys use_vertex_points keys_to_order read_scattered"}));
}

TEST(Plan, MeasuresTheKindThatNeedsMost) {
  // Vertex-chain layers use points, the others only keys (which nothing reads here: transient).
  const std::vector<Stage> stages = {Chunk<MakeKeys>(), Chunk<UseVertexPoints>()};
  const Plan plan = Compile(stages, MakeShape({{0, 0, 9}, {0, kLong, 1}}));
  EXPECT_EQ(plan.passes[0].resident_bytes, sizeof(KeyBlock) + 2 * sizeof(RowBlock));
}

TEST(Plan, MeasuresTheLargestLayerOfAKind) {
  const SceneShape shape = MakeShape({{0, 0, 3}, {0, 0, 9}, {0, 0, 2}});
  const Plan plan = Compile({MakeStage<SumLayer>(Domain::kLayer)}, shape);
  EXPECT_EQ(FindStream(plan.passes[0], StreamOf<&Toys::keys>).bytes, 9 * sizeof(KeyBlock));
}

}  // namespace
}  // namespace pelt::testing
