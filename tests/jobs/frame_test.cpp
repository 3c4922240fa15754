// What runs on which item: gates, kinds, belonging, and the two executors that need no thread.
#include <gtest/gtest.h>

#include <map>
#include <vector>

#include "jobs/frame_recording.hpp"
#include "tests/jobs/synthetic_scene.hpp"

namespace pelt {
namespace {

using namespace testing;

struct AddParams {
  uint32_t add;
};

// Adds to the first key of its chunk: shows which chunks a stage ran on, and how often.
struct AddToKey {
  static constexpr std::string_view kName = "add_to_key";
  using Params = AddParams;
  struct Ports {
    InOut<&Streams::sort_keys> keys;
  };
  static void Run(const Params& p, const Ports& ports) { ports.keys->key[0] += p.add; }
};
struct AddToLayer {
  static constexpr std::string_view kName = "add_to_layer";
  using Params = AddParams;
  struct Ports {
    InOut<&Streams::lod> lod;
  };
  static void Run(const Params& p, const Ports& ports) { ports.lod->was_visible += p.add; }
};
// Brings the character's root and the layer's box to the chunk.
struct FetchParents {
  static constexpr std::string_view kName = "fetch_parents";
  using Params = AddParams;
  struct Ports {
    Shared<&Streams::pose> pose;
    Shared<&Streams::bounds> bounds;
    Out<&Streams::order> order;
  };
  static void Run(const Params&, const Ports& ports) {
    ports.order->strand[0] = ports.pose->joint_count;
    std::memcpy(&ports.order->strand[1], ports.bounds->low, 4);
  }
};
struct UseVertexPoints {
  static constexpr std::string_view kName = "use_vertex_points";
  using Params = AddParams;
  struct Ports {
    InOut<&Streams::vertex_points> points;
  };
  static void Run(const Params& p, const Ports& ports) {
    ports.points->position[0][0][0] = float(p.add);
  }
};

constexpr AddParams kOne{1};
const std::vector<LayerSpec> kLayers = {
    {0, 0, 2}, {0, kLayerVertexChains, 3}, {1, kLayerVertexChains | kLayerVerlet, 1}};

std::vector<uint32_t> FirstKeys(SyntheticScene& scene) {
  std::vector<uint32_t> keys;
  for (uint32_t c = 0; c < scene.shape().chunk_count; ++c)
    keys.push_back(scene.Block<SortKeyBlock>(StreamOf<&Streams::sort_keys>, c).key[0]);
  return keys;
}
using Counts = std::vector<uint32_t>;

// How often each chunk's stage ran under this gate and kind mask.
Counts CountRuns(SyntheticScene& scene, Gate gate, KindMask kinds = {}) {
  for (uint32_t c = 0; c < scene.shape().chunk_count; ++c)
    scene.Block<SortKeyBlock>(StreamOf<&Streams::sort_keys>, c).key[0] = 0;
  const Plan plan =
      CompilePlan({MakeStage<AddToKey>(Domain::kChunk, kOne, gate, kinds)}, scene.shape(), {});
  SerialExecutor().Run({&plan, &scene.memory()});
  return FirstKeys(scene);
}

TEST(Frame, RunsEveryItemOnce) {
  SyntheticScene scene(kLayers);
  EXPECT_EQ(CountRuns(scene, {}), Counts({1, 1, 1, 1, 1, 1}));
}

TEST(Frame, ChunkGateWantsAllItsFlags) {
  SyntheticScene scene(kLayers);
  const auto flags = [&](uint32_t chunk) -> uint32_t& {
    return scene.Block<ChunkStateBlock>(StreamOf<&Streams::chunk_state>, chunk).flags;
  };
  for (uint32_t c = 0; c < 6; ++c) flags(c) = 0;
  flags(1) = kChunkSkin;
  flags(3) = kChunkFit;
  flags(5) = kChunkSkin | kChunkFit;
  EXPECT_EQ(CountRuns(scene, {.chunk_flags = kChunkSkin}), Counts({0, 1, 0, 0, 0, 1}));
  EXPECT_EQ(CountRuns(scene, {.chunk_flags = kChunkSkin | kChunkFit}), Counts({0, 0, 0, 0, 0, 1}));
}

TEST(Frame, LayerFlagGateLooksAtTheLayersBlock) {
  SyntheticScene scene(kLayers);
  for (uint32_t l = 0; l < 3; ++l) scene.Block<LayerBlock>(StreamOf<&Streams::layers>, l).flags = 0;
  scene.Block<LayerBlock>(StreamOf<&Streams::layers>, 1).flags = kLayerWind;
  EXPECT_EQ(CountRuns(scene, {.layer_flags = kLayerWind}), Counts({0, 0, 1, 1, 1, 0}));
}

TEST(Frame, SortGateOpensWhenKeysChanged) {
  SyntheticScene scene(kLayers);
  for (uint32_t l = 0; l < 3; ++l)
    scene.Block<LayerSortBlock>(StreamOf<&Streams::layer_sort>, l) = {
        kStrandsPerChunk, l == 2, 0, {}};
  EXPECT_EQ(CountRuns(scene, {.layer = LayerGate::kKeysChanged}), Counts({0, 0, 0, 0, 0, 1}));
}

TEST(Frame, RedrawGateOpensForPiecesThatHoldDrawnStrands) {
  SyntheticScene scene(kLayers);
  const auto set = [&](uint32_t layer, uint32_t visible, uint32_t keys, uint32_t records) {
    scene.Block<LayerSortBlock>(StreamOf<&Streams::layer_sort>, layer) = {
        visible, keys, records, {}};
  };
  set(0, kStrandsPerChunk, 0, 1);      // the first piece only: the second begins behind the last
  set(1, kStrandsPerChunk + 1, 1, 0);  // two of three
  set(2, 5, 0, 0);                     // nothing changed
  EXPECT_EQ(CountRuns(scene, {.layer = LayerGate::kRedraw}), Counts({1, 0, 1, 1, 0, 0}));
}

TEST(Frame, KindsExcludeLayers) {
  SyntheticScene scene(kLayers);
  EXPECT_EQ(CountRuns(scene, {}, {kLayerVertexChains, 0}), Counts({0, 0, 1, 1, 1, 1}));
  EXPECT_EQ(CountRuns(scene, {}, {kLayerVertexChains, kLayerVerlet}), Counts({0, 0, 1, 1, 1, 0}));
  EXPECT_EQ(CountRuns(scene, {}, {0, kLayerVertexChains}), Counts({1, 1, 0, 0, 0, 0}));
}

TEST(Frame, StreamsThatAChunkLacksKeepItsStageAway) {
  SyntheticScene scene(kLayers);
  const AddParams seven{7};
  const Plan plan =
      CompilePlan({MakeStage<UseVertexPoints>(Domain::kChunk, seven)}, scene.shape(), {});
  SerialExecutor().Run({&plan, &scene.memory()});
  EXPECT_EQ(scene.memory().Block(StreamOf<&Streams::vertex_points>, 0), nullptr);
  for (uint32_t c = 2; c < 6; ++c)
    EXPECT_EQ(scene.Block<PointBlock<4>>(StreamOf<&Streams::vertex_points>, c).position[0][0][0],
              7.0f);
}

TEST(Frame, LayerStagesRunOncePerLayer) {
  SyntheticScene scene(kLayers);
  for (uint32_t l = 0; l < 3; ++l)
    scene.Block<LodBlock>(StreamOf<&Streams::lod>, l).was_visible = 10 * l;
  const Plan plan = CompilePlan({MakeStage<AddToLayer>(Domain::kLayer, kOne)}, scene.shape(), {});
  SerialExecutor().Run({&plan, &scene.memory()});
  for (uint32_t l = 0; l < 3; ++l)
    EXPECT_EQ(scene.Block<LodBlock>(StreamOf<&Streams::lod>, l).was_visible, 10 * l + 1);
}

TEST(Frame, SharedBlocksAreThoseOfTheItemsOwnParents) {
  SyntheticScene scene(kLayers);
  const Plan plan = CompilePlan({MakeStage<FetchParents>(Domain::kChunk, kOne)}, scene.shape(), {});
  SerialExecutor().Run({&plan, &scene.memory()});
  const uint32_t layer_of[] = {0, 0, 1, 1, 1, 2}, character_of[] = {0, 0, 0, 0, 0, 1};
  for (uint32_t c = 0; c < 6; ++c) {
    const auto& order = scene.Block<OrderBlock>(StreamOf<&Streams::order>, c);
    EXPECT_EQ(order.strand[0],
              scene.Block<PoseBlock>(StreamOf<&Streams::pose>, character_of[c]).joint_count);
    uint32_t low;
    std::memcpy(&low, scene.Block<BoundsBlock>(StreamOf<&Streams::bounds>, layer_of[c]).low, 4);
    EXPECT_EQ(order.strand[1], low);
    EXPECT_EQ(PlaceOf(scene.shape(), Domain::kChunk, c).first[size_t(Domain::kScene)], 0u);
  }
}

TEST(Frame, ChildrenOfALayerAreItsChunks) {
  const SceneShape shape = MakeShape(kLayers);
  const ItemPlace layer = PlaceOf(shape, Domain::kLayer, 1);
  EXPECT_EQ(layer.first[size_t(Domain::kChunk)], 2u);
  EXPECT_EQ(layer.count[size_t(Domain::kChunk)], 3u);
  const ItemPlace all = PlaceOf(shape, Domain::kScene, 0);
  EXPECT_EQ(all.first[size_t(Domain::kLayer)], 0u);
  EXPECT_EQ(all.count[size_t(Domain::kLayer)], 3u);
}

TEST(Frame, ProfileTellsWhatRanAndWhatDidNot) {
  SyntheticScene scene(kLayers);
  scene.Block<ChunkStateBlock>(StreamOf<&Streams::chunk_state>, 4).flags = 0;
  const Plan plan =
      CompilePlan({MakeStage<AddToKey>(Domain::kChunk, kOne, {.chunk_flags = kChunkSkin}),
                   MakeStage<AddToLayer>(Domain::kLayer, kOne)},
                  scene.shape(), {});
  const FrameRecording recording(plan, scene.shape());
  SerialExecutor().Run({&plan, &scene.memory(), recording.profile()});
  for (uint32_t i = 0; i < 6; ++i) EXPECT_EQ(recording.Stage(0, i).Ran(), i != 4) << i;
  for (uint32_t i = 0; i < 3; ++i) EXPECT_TRUE(recording.Stage(1, i).Ran()) << i;
  for (uint32_t i = 0; i < 6; ++i) {
    const Slice& item = recording.Item(0, i);
    EXPECT_GE(item.begin_ticks, recording.Pass(0).begin_ticks);
    EXPECT_LE(item.end_ticks, recording.Pass(0).end_ticks);
    if (recording.Stage(0, i).Ran()) {
      EXPECT_GE(recording.Stage(0, i).begin_ticks, item.begin_ticks);
      EXPECT_LE(recording.Stage(0, i).end_ticks, item.end_ticks);
    }
  }
  EXPECT_GT(recording.Pass(1).Ticks(), 0u);
  EXPECT_GT(recording.NsPerTick(), 0.0);

  FrameRecording items_only(plan, scene.shape());
  items_only.TimeStages(false);
  SerialExecutor().Run({&plan, &scene.memory(), items_only.profile()});
  for (uint32_t i = 0; i < 6; ++i) {
    EXPECT_EQ(items_only.Stage(0, i).Ran(), i != 4) << i;
    EXPECT_EQ(items_only.Stage(0, i).Ticks(), 0u);
    EXPECT_GT(items_only.Item(0, i).Ticks(), 0u);
  }
}

// ---- Permuted -----------------------------------------------------------------------------------

// Notes the order in which chunks run, in a place outside the scene: the one thing no kernel may
// do.
std::vector<uint32_t> g_visited;
struct NoteOrder {
  static constexpr std::string_view kName = "note_order";
  using Params = AddParams;
  struct Ports {
    In<&Streams::chunk_state> state;
  };
  static void Run(const Params&, const Ports& ports) {
    g_visited.push_back(ports.state->first_place / kStrandsPerChunk);
  }
};

Counts VisitedBy(Executor& executor) {
  SyntheticScene scene({{0, 0, 6}});
  const Plan plan = CompilePlan({MakeStage<NoteOrder>(Domain::kChunk, kOne)}, scene.shape(), {});
  g_visited.clear();
  executor.Run({&plan, &scene.memory()});
  return g_visited;
}

TEST(PermutedExecutor, SeedZeroRunsBackwards) {
  PermutedExecutor executor(0);
  EXPECT_EQ(VisitedBy(executor), Counts({5, 4, 3, 2, 1, 0}));
}

TEST(PermutedExecutor, SeedsGiveOrdersThatVisitAllAndCanBeRepeated) {
  std::map<Counts, int> orders;
  for (uint64_t seed = 1; seed <= 8; ++seed) {
    PermutedExecutor a(seed), b(seed);
    const Counts visited = VisitedBy(a);
    EXPECT_EQ(VisitedBy(b), visited);
    ++orders[visited];
    EXPECT_NE(VisitedBy(a), visited) << "the next frame has another order";
    Counts sorted = visited;
    std::sort(sorted.begin(), sorted.end());
    EXPECT_EQ(sorted, Counts({0, 1, 2, 3, 4, 5}));
  }
  EXPECT_GE(orders.size(), 7u) << "8 seeds, 720 orders";
}

}  // namespace
}  // namespace pelt
