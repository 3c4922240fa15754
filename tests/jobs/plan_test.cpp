// The plan is derived: barriers, fusion, residency and who takes part follow from the ports alone.
// Kernels here do little; what counts is what they declare.
#include "jobs/plan.hpp"

#include <gtest/gtest.h>

#include <string>

#include "core/error.hpp"
#include "tests/jobs/synthetic_scene.hpp"

namespace pelt {
namespace {

using testing::LayerSpec;
using testing::MakeShape;
using testing::MakeStage;

// keys -> order, own chunk.
struct KeysToOrder {
  static constexpr std::string_view kName = "keys_to_order";
  struct Ports {
    In<&Streams::sort_keys> keys;
    Out<&Streams::order> order;
  };
  static void Run(const Ports&) {}
};
struct MakeKeys {
  static constexpr std::string_view kName = "make_keys";
  struct Ports {
    Out<&Streams::sort_keys> keys;
  };
  static void Run(const Ports&) {}
};
// Scratch between two chunk stages: pairs_b is written and read here and nowhere else.
struct MakePairs {
  static constexpr std::string_view kName = "make_pairs";
  struct Ports {
    In<&Streams::sort_keys> keys;
    Out<&Streams::sort_pairs_b> pairs;
  };
  static void Run(const Ports&) {}
};
struct UsePairs {
  static constexpr std::string_view kName = "use_pairs";
  struct Ports {
    In<&Streams::sort_pairs_b> pairs;
    Out<&Streams::order> order;
  };
  static void Run(const Ports&) {}
};
struct ScatterPairs {
  static constexpr std::string_view kName = "scatter_pairs";
  struct Ports {
    In<&Streams::sort_keys> keys;
    Scatter<&Streams::sort_pairs_a> sorted;
  };
  static void Run(const Ports&) {}
};
struct ReadScattered {
  static constexpr std::string_view kName = "read_scattered";
  struct Ports {
    In<&Streams::sort_pairs_a> pairs;
    Out<&Streams::digits> digits;
  };
  static void Run(const Ports&) {}
};
struct MakeCurves {
  static constexpr std::string_view kName = "make_curves";
  struct Ports {
    Out<&Streams::curves> curves;
  };
  static void Run(const Ports&) {}
};
struct GatherCurves {
  static constexpr std::string_view kName = "gather_curves";
  struct Ports {
    In<&Streams::order> order;
    Gather<&Streams::curves, &Streams::order> curves;
    Out<&Streams::instances> instances;
  };
  static void Run(const Ports&) {}
};
struct SumLayer {
  static constexpr std::string_view kName = "sum_layer";
  struct Ports {
    All<&Streams::sort_keys> keys;
    Out<&Streams::layer_sort> sum;
  };
  static void Run(const Ports&) {}
};
struct UseVertexPoints {
  static constexpr std::string_view kName = "use_vertex_points";
  struct Ports {
    InOut<&Streams::vertex_points> points;
  };
  static void Run(const Ports&) {}
};
struct UseBounds {
  static constexpr std::string_view kName = "use_bounds";
  struct Ports {
    Shared<&Streams::bounds> bounds;
    InOut<&Streams::sort_keys> keys;
  };
  static void Run(const Ports&) {}
};

const SceneShape kShape = MakeShape({{0, 0, 3}, {0, 0, 2}});

template <class K>
Stage Chunk(Gate gate = {}, KindMask kinds = {}) {
  return MakeStage<K>(Domain::kChunk, gate, kinds);
}

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
  ADD_FAILURE() << "pass has no stream " << DescribeStream(stream).name;
  return pass.streams.front();
}

std::string ErrorOf(std::vector<Stage> stages, const SceneShape& shape, PlanOptions options = {}) {
  try {
    CompilePlan(std::move(stages), shape, options);
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

TEST(Plan, FusesNeighboursThatTouchOnlyTheirItem) {
  const Plan plan = CompilePlan({Chunk<MakeKeys>(), Chunk<KeysToOrder>()}, kShape, {});
  EXPECT_EQ(PassNames(plan), Names({"make_keys keys_to_order"}));
}

TEST(Plan, UnfusedHasOnePassAStage) {
  const Plan plan = CompilePlan({Chunk<MakeKeys>(), Chunk<KeysToOrder>()}, kShape, {.fuse = false});
  EXPECT_EQ(PassNames(plan), Names({"make_keys", "keys_to_order"}));
}

TEST(Plan, PutsABarrierWhereTheDomainChanges) {
  const Plan plan = CompilePlan(
      {Chunk<MakeKeys>(), MakeStage<SumLayer>(Domain::kLayer), Chunk<KeysToOrder>()}, kShape, {});
  EXPECT_EQ(PassNames(plan), Names({"make_keys", "sum_layer", "keys_to_order"}));
  EXPECT_EQ(plan.passes[1].domain, Domain::kLayer);
}

TEST(Plan, PutsABarrierBetweenScatterAndReader) {
  const Plan plan = CompilePlan({Chunk<ScatterPairs>(), Chunk<ReadScattered>()}, kShape, {});
  EXPECT_EQ(PassNames(plan), Names({"scatter_pairs", "read_scattered"}));
}

TEST(Plan, PutsABarrierBetweenReaderAndScatter) {
  const Plan plan = CompilePlan({Chunk<ReadScattered>(), Chunk<ScatterPairs>()}, kShape, {});
  EXPECT_EQ(PassNames(plan), Names({"read_scattered", "scatter_pairs"}));
}

TEST(Plan, PutsABarrierBetweenWriterAndGather) {
  const Plan plan = CompilePlan({Chunk<MakeCurves>(), Chunk<GatherCurves>()}, kShape, {});
  EXPECT_EQ(PassNames(plan), Names({"make_curves", "gather_curves"}));
}

TEST(Plan, PutsABarrierBetweenARecordListAndItsGather) {
  const Plan plan = CompilePlan({Chunk<KeysToOrder>(), Chunk<GatherCurves>()}, kShape, {});
  EXPECT_EQ(PassNames(plan), Names({"keys_to_order", "gather_curves"}));
}

TEST(Plan, FusesAGatherWithStagesThatDoNotConcernIt) {
  const Plan plan = CompilePlan({Chunk<MakeKeys>(), Chunk<GatherCurves>()}, kShape, {});
  EXPECT_EQ(PassNames(plan), Names({"make_keys gather_curves"}));
}

TEST(Plan, FusesOnlyWhatFitsTwiceOver) {
  const uint32_t keys = sizeof(SortKeyBlock), pairs = sizeof(SortPairBlock),
                 order = sizeof(OrderBlock);
  // Pairs live and die inside the fused pass: one copy. Keys and order stream through: two.
  const uint32_t fused = 2 * keys + pairs + 2 * order;
  const std::vector<Stage> stages = {Chunk<MakePairs>(), Chunk<UsePairs>()};
  const Plan fits = CompilePlan(stages, kShape, {.local_store_data_bytes = fused});
  EXPECT_EQ(PassNames(fits), Names({"make_pairs use_pairs"}));
  EXPECT_EQ(fits.passes[0].resident_bytes, fused);
  EXPECT_TRUE(fits.passes[0].double_buffered);
  const Plan cut = CompilePlan(stages, kShape, {.local_store_data_bytes = fused - 1});
  EXPECT_EQ(PassNames(cut), Names({"make_pairs", "use_pairs"}));
}

TEST(Plan, KnowsTransientsAndCountsTheirBytesNowhere) {
  const std::vector<Stage> stages = {Chunk<MakePairs>(), Chunk<UsePairs>()};
  const Plan fused = CompilePlan(stages, kShape, {});
  const PassStream& pairs = FindStream(fused.passes[0], StreamOf<&Streams::sort_pairs_b>);
  EXPECT_TRUE(pairs.transient);
  EXPECT_FALSE(pairs.get);
  EXPECT_EQ(fused.passes[0].get_bytes, sizeof(SortKeyBlock));
  EXPECT_EQ(fused.passes[0].put_bytes, sizeof(OrderBlock));

  const Plan unfused = CompilePlan(stages, kShape, {.fuse = false});
  EXPECT_FALSE(FindStream(unfused.passes[0], StreamOf<&Streams::sort_pairs_b>).transient);
  EXPECT_EQ(unfused.passes[0].put_bytes, sizeof(SortPairBlock));
  EXPECT_EQ(unfused.passes[1].get_bytes, sizeof(SortPairBlock));
}

TEST(Plan, OutCostsNoGetAndInNoPut) {
  const Plan plan = CompilePlan({Chunk<KeysToOrder>()}, kShape, {});
  const PassStream& keys = FindStream(plan.passes[0], StreamOf<&Streams::sort_keys>);
  const PassStream& order = FindStream(plan.passes[0], StreamOf<&Streams::order>);
  EXPECT_TRUE(keys.get);
  EXPECT_FALSE(keys.put);
  EXPECT_FALSE(order.get);
  EXPECT_TRUE(order.put);
  EXPECT_FALSE(order.transient) << "an output of the frame must be put";
}

TEST(Plan, SharedBlocksAreResidentOnceAndNotCountedPerItem) {
  const Plan plan = CompilePlan({Chunk<UseBounds>()}, kShape, {});
  EXPECT_EQ(plan.passes[0].resident_bytes, sizeof(BoundsBlock) + 2 * sizeof(SortKeyBlock));
  EXPECT_EQ(plan.passes[0].get_bytes, sizeof(SortKeyBlock));
}

TEST(Plan, BuffersSinglyWhatFitsOnlyOnce) {
  const uint32_t once = 3 * sizeof(SortKeyBlock) + sizeof(LayerSortBlock);
  const std::vector<Stage> stages = {MakeStage<SumLayer>(Domain::kLayer)};
  const Plan plan = CompilePlan(stages, kShape, {.local_store_data_bytes = once});
  EXPECT_FALSE(plan.passes[0].double_buffered);
  EXPECT_EQ(plan.passes[0].resident_bytes, once) << "the largest layer, 3 chunks, counts";
  EXPECT_TRUE(
      CompilePlan(stages, kShape, {.local_store_data_bytes = 2 * once}).passes[0].double_buffered);
}

TEST(Plan, RefusesAStageThatDoesNotFitAndSaysByHowMuch) {
  const uint32_t once = 3 * sizeof(SortKeyBlock) + sizeof(LayerSortBlock);
  const std::string error =
      ErrorOf({MakeStage<SumLayer>(Domain::kLayer)}, kShape, {.local_store_data_bytes = once - 1});
  EXPECT_NE(error.find("stage sum_layer"), std::string::npos) << error;
  EXPECT_NE(error.find("one layer needs " + std::to_string(once) + " bytes"), std::string::npos)
      << error;
  EXPECT_NE(error.find("1 more than"), std::string::npos) << error;
}

TEST(Plan, InMainMemoryAStageThatDoesNotFitIsAPassOfItsOwn) {
  const uint32_t once = 3 * sizeof(SortKeyBlock) + sizeof(LayerSortBlock);
  const Stage sum = MakeStage<SumLayer>(Domain::kLayer);
  const Plan roomy = CompilePlan({sum, sum}, kShape, {.must_fit = false});
  EXPECT_EQ(PassNames(roomy), Names({"sum_layer sum_layer"}));
  const Plan tight =
      CompilePlan({sum, sum}, kShape, {.local_store_data_bytes = once - 1, .must_fit = false});
  EXPECT_EQ(PassNames(tight), Names({"sum_layer", "sum_layer"}));
  EXPECT_EQ(tight.passes[0].resident_bytes, once);
}

TEST(Plan, StreamsSayWhichLayersAStageRunsOn) {
  const SceneShape shape = MakeShape({{0, kLayerVertexChains, 1}, {0, 0, 1}});
  const Plan plan = CompilePlan({Chunk<UseVertexPoints>()}, shape, {});
  ASSERT_EQ(plan.stages.size(), 1u);
  EXPECT_TRUE(plan.stages[0].kinds.Admits(kLayerVertexChains));
  EXPECT_FALSE(plan.stages[0].kinds.Admits(0));
  EXPECT_FALSE(plan.stages[0].kinds.Admits(kLayerFivePoints));
}

TEST(Plan, LeavesOutStagesThatNoLayerHasTheKindFor) {
  const std::vector<Stage> stages = {Chunk<MakeKeys>(), Chunk<UseVertexPoints>(),
                                     Chunk<KeysToOrder>({}, {kLayerVerlet, 0}),
                                     Chunk<ReadScattered>({}, {0, kLayerVerlet})};
  const Plan strands = CompilePlan(stages, MakeShape({{0, 0, 1}}), {});
  EXPECT_EQ(PassNames(strands), Names({"make_keys read_scattered"}));
  const Plan verlet = CompilePlan(stages, MakeShape({{0, kLayerVerlet, 1}}), {});
  EXPECT_EQ(PassNames(verlet), Names({"make_keys keys_to_order"}));
  const Plan both =
      CompilePlan(stages, MakeShape({{0, kLayerVerlet, 1}, {0, kLayerVertexChains, 1}}), {});
  EXPECT_EQ(PassNames(both), Names({"make_keys use_vertex_points keys_to_order read_scattered"}));
}

TEST(Plan, MeasuresTheKindThatNeedsMost) {
  // Vertex-chain layers use points, the others only keys (which nothing reads here: transient).
  const std::vector<Stage> stages = {Chunk<MakeKeys>(), Chunk<UseVertexPoints>()};
  const Plan plan = CompilePlan(stages, MakeShape({{0, 0, 9}, {0, kLayerVertexChains, 1}}), {});
  EXPECT_EQ(plan.passes[0].resident_bytes, sizeof(SortKeyBlock) + 2 * sizeof(PointBlock<4>));
}

TEST(Plan, SortableChunksNeverWrapsRound) {
  EXPECT_EQ(SortableChunks(0), 0u);
  EXPECT_EQ(SortableChunks(4 * 1024), 0u);
  EXPECT_GT(SortableChunks(176 * 1024), 32u);
  EXPECT_LT(SortableChunks(176 * 1024), 176u);
}

}  // namespace
}  // namespace pelt
