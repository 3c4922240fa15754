// What runs on which item: gates, kinds, belonging, and the two executors that need no thread.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <iterator>
#include <map>
#include <utility>
#include <vector>

#include "jobs/frame_recording.hpp"
#include "tests/jobs/synthetic_scene.hpp"

namespace pelt::testing {
namespace {

struct AddParams {
  uint32_t add;
};

// Adds to the first key of its chunk: shows which chunks a stage ran on, and how often.
struct AddToKey {
  static constexpr std::string_view kName = "add_to_key";
  using Params = AddParams;
  struct Ports {
    InOut<&Toys::keys> keys;
  };
  static void Run(const Params& p, const Ports& ports) { ports.keys->key[0] += p.add; }
};
struct AddToLayer {
  static constexpr std::string_view kName = "add_to_layer";
  using Params = AddParams;
  struct Ports {
    InOut<&Toys::box> box;
  };
  static void Run(const Params& p, const Ports& ports) { ports.box->word += p.add; }
};
// Brings the character's root and the layer's box to the chunk.
struct FetchParents {
  static constexpr std::string_view kName = "fetch_parents";
  using Params = AddParams;
  struct Ports {
    Shared<&Toys::body> body;
    Shared<&Toys::box> box;
    Out<&Toys::order> order;
  };
  static void Run(const Params&, const Ports& ports) {
    ports.order->place[0] = ports.body->word;
    ports.order->place[1] = ports.box->word;
  }
};
// As AddToKey, to a patch's mark.
struct AddToMark {
  static constexpr std::string_view kName = "add_to_mark";
  using Params = AddParams;
  struct Ports {
    InOut<&Toys::marks> mark;
  };
  static void Run(const Params& p, const Ports& ports) { ports.mark->word += p.add; }
};
struct CopyParts {
  static constexpr std::string_view kName = "copy_parts";
  struct Ports {
    In<&Toys::order> order;
    Gather<&Toys::parts, &Toys::order> parts;
    Out<&Toys::copies> copies;
  };
  static void Run(const Ports& ports) {
    for (uint32_t i = 0; i < kToyLanes; ++i) ports.copies->record[i] = ports.parts[i];
  }
};
struct SumMarks {
  static constexpr std::string_view kName = "sum_marks";
  struct Ports {
    In<&Toys::list> list;
    GatherBlocks<&Toys::marks, &Toys::list> marks;
    InOut<&Toys::keys> keys;
  };
  static void Run(const Ports& ports) {
    ports.keys->key[0] = 0;
    for (uint32_t i = 0; i < kToyListed && ports.list->patch[i] != ~0u; ++i)
      ports.keys->key[0] += ports.marks[i].word;
  }
};
struct SumAllMarks {
  static constexpr std::string_view kName = "sum_all_marks";
  struct Ports {
    All<&Toys::marks> marks;
    Out<&Toys::box> box;
  };
  static void Run(const Ports& ports) {
    ports.box->word = 0;
    for (uint32_t i = 0; i < ports.marks.count; ++i) ports.box->word += ports.marks[i].word;
  }
};

constexpr AddParams kOne{1};
const std::vector<LayerSpec> kLayers = {{0, 0, 2, 1}, {0, kLong, 3, 2}, {1, kLong | kRound, 1, 3}};

void RunStages(SyntheticScene& scene, std::vector<Stage> stages, const PlanOptions& options = {}) {
  const Plan plan = CompilePlan(std::move(stages), scene.shape(), options).OrThrow();
  SerialExecutor().Run({&plan, &scene.memory()});
}

std::vector<uint32_t> FirstKeys(SyntheticScene& scene) {
  std::vector<uint32_t> keys;
  for (uint32_t c = 0; c < scene.shape().chunk_count; ++c)
    keys.push_back(scene.Of<&Toys::keys>(c).key[0]);
  return keys;
}
using Counts = std::vector<uint32_t>;

// How often each chunk's stage ran under this gate and kind mask.
Counts CountRuns(SyntheticScene& scene, Gate gate, KindMask kinds = {}) {
  for (uint32_t c = 0; c < scene.shape().chunk_count; ++c) scene.Of<&Toys::keys>(c).key[0] = 0;
  RunStages(scene, {MakeStage<AddToKey>(Domain::kChunk, kOne, gate, kinds)});
  return FirstKeys(scene);
}

TEST(Frame, RunsEveryItemOnce) {
  SyntheticScene scene(kLayers);
  EXPECT_EQ(CountRuns(scene, {}), Counts({1, 1, 1, 1, 1, 1}));
}

TEST(Frame, AConditionIsAskedOfEveryItem) {
  SyntheticScene scene(kLayers);
  const auto flags = [&](uint32_t chunk) -> uint32_t& {
    return scene.Of<&Toys::state>(chunk).flags;
  };
  for (uint32_t c = 0; c < 6; ++c) flags(c) = 0;
  flags(1) = 1;
  flags(3) = 2;
  flags(5) = 3;
  EXPECT_EQ(CountRuns(scene, {kWithToyFlags<1>}), Counts({0, 1, 0, 0, 0, 1}));
  EXPECT_EQ(CountRuns(scene, {kWithToyFlags<3>}), Counts({0, 0, 0, 0, 0, 1}));
}

bool IsBoxed(const FrameMemory& memory, const ItemPlace& place) {
  return memory.Of<&Toys::box>(place.first[size_t(Domain::kLayer)])->word == 7;
}

TEST(Frame, AConditionMayLookAtWhatTheItemBelongsTo) {
  SyntheticScene scene(kLayers);
  for (uint32_t l = 0; l < 3; ++l) scene.Of<&Toys::box>(l).word = l == 1 ? 7 : 8;
  const Condition boxed{&IsBoxed, Domain::kLayer, {StreamOf<&Toys::box>, Stream::kNone}};
  EXPECT_EQ(CountRuns(scene, {boxed}), Counts({0, 0, 1, 1, 1, 0}));
}

TEST(Frame, HeldAndPausedItemsAreLeftOut) {
  SyntheticScene scene(kLayers);
  const uint8_t held[] = {0, 1, 0, 0, 0, 1};
  scene.memory().held[size_t(Domain::kChunk)] = held;
  const Counts all(6, 1), none(6, 0);
  EXPECT_EQ(CountRuns(scene, {}), all);
  EXPECT_EQ(CountRuns(scene, {.frame = FrameGate::kNotHeld}), Counts({1, 0, 1, 1, 1, 0}));
  scene.memory().paused = true;
  EXPECT_EQ(CountRuns(scene, {}), none);
  EXPECT_EQ(CountRuns(scene, {.frame = FrameGate::kNotHeld}), none);
  EXPECT_EQ(CountRuns(scene, {.frame = FrameGate::kAlsoPaused}), all);
}

TEST(Frame, KindsExcludeLayers) {
  SyntheticScene scene(kLayers);
  EXPECT_EQ(CountRuns(scene, {}, {kLong, 0}), Counts({0, 0, 1, 1, 1, 1}));
  EXPECT_EQ(CountRuns(scene, {}, {kLong, kRound}), Counts({0, 0, 1, 1, 1, 0}));
  EXPECT_EQ(CountRuns(scene, {}, {0, kLong}), Counts({1, 1, 0, 0, 0, 0}));
}

TEST(Frame, StreamsThatAChunkLacksKeepItsStageAway) {
  SyntheticScene scene(kLayers);
  RunStages(scene, {Chunk<UseVertexPoints>()});
  EXPECT_EQ(scene.memory().Block(StreamOf<&Toys::of_long>, 0), nullptr);
  for (uint32_t c = 2; c < 6; ++c) EXPECT_EQ(scene.Of<&Toys::of_long>(c).a[0][0], 7.0f);
}

TEST(Frame, LayerStagesRunOncePerLayer) {
  SyntheticScene scene(kLayers);
  for (uint32_t l = 0; l < 3; ++l) scene.Of<&Toys::box>(l).word = 10 * l;
  RunStages(scene, {MakeStage<AddToLayer>(Domain::kLayer, kOne)});
  for (uint32_t l = 0; l < 3; ++l) EXPECT_EQ(scene.Of<&Toys::box>(l).word, 10 * l + 1);
}

TEST(Frame, SharedBlocksAreThoseOfTheItemsOwnParents) {
  SyntheticScene scene(kLayers);
  RunStages(scene, {MakeStage<FetchParents>(Domain::kChunk, kOne)});
  const uint32_t layer_of[] = {0, 0, 1, 1, 1, 2}, character_of[] = {0, 0, 0, 0, 0, 1};
  for (uint32_t c = 0; c < 6; ++c) {
    const auto& order = scene.Of<&Toys::order>(c);
    EXPECT_EQ(order.place[0], scene.Of<&Toys::body>(character_of[c]).word);
    EXPECT_EQ(order.place[1], scene.Of<&Toys::box>(layer_of[c]).word);
    EXPECT_EQ(PlaceOf(scene.shape(), Domain::kChunk, c).first[size_t(Domain::kScene)], 0u);
  }
}

TEST(Frame, ChildrenOfALayerAreItsChunksAndPatches) {
  const SceneShape shape = MakeShape(kLayers);
  const auto expect = [](const ItemPlace& place, Domain of, uint32_t first, uint32_t count) {
    EXPECT_EQ(place.first[size_t(of)], first) << int(of);
    EXPECT_EQ(place.count[size_t(of)], count) << int(of);
  };
  expect(PlaceOf(shape, Domain::kLayer, 1), Domain::kChunk, 2, 3);
  expect(PlaceOf(shape, Domain::kLayer, 1), Domain::kPatch, 1, 2);
  expect(PlaceOf(shape, Domain::kScene, 0), Domain::kLayer, 0, 3);
  expect(PlaceOf(shape, Domain::kScene, 0), Domain::kPatch, 0, 6);
}

TEST(Frame, PatchesAndChunksKnowTheirLayersFirst) {
  const SceneShape shape = MakeShape(kLayers);
  const uint32_t layer_of_patch[] = {0, 1, 1, 2, 2, 2}, layer_of_chunk[] = {0, 0, 1, 1, 1, 2};
  const uint32_t first_patch[] = {0, 1, 3}, first_chunk[] = {0, 2, 5};
  for (uint32_t i = 0; i < 6; ++i)
    for (const Domain domain : {Domain::kPatch, Domain::kChunk}) {
      const uint32_t layer = domain == Domain::kPatch ? layer_of_patch[i] : layer_of_chunk[i];
      const ItemPlace place = PlaceOf(shape, domain, i);
      EXPECT_EQ(place.first[size_t(domain)], i);
      EXPECT_EQ(place.count[size_t(domain)], 1u);
      EXPECT_EQ(place.first[size_t(Domain::kLayer)], layer);
      EXPECT_EQ(place.first[size_t(Domain::kCharacter)], layer == 2 ? 1u : 0u);
      EXPECT_EQ(place.layer_first[size_t(Domain::kPatch)], first_patch[layer]);
      EXPECT_EQ(place.layer_first[size_t(Domain::kChunk)], first_chunk[layer]);
    }
}

TEST(Frame, StreamsOfPatchesHaveABlockForEachThatTheirKindsAdmit) {
  SyntheticScene scene(kLayers);
  const SceneShape& shape = scene.shape();
  const auto& table = TableOf<Toys>();
  EXPECT_EQ(CountBlocks(table[StreamOf<&Toys::parts>], shape), 6u);
  EXPECT_EQ(CountBlocks(table[StreamOf<&Toys::long_parts>], shape), 5u);
  EXPECT_EQ(scene.memory().Block(StreamOf<&Toys::long_parts>, 0), nullptr);
  const std::byte* first = scene.memory().Block(StreamOf<&Toys::long_parts>, 1);
  for (uint32_t p = 1; p < 6; ++p)
    EXPECT_EQ(scene.memory().Block(StreamOf<&Toys::long_parts>, p),
              first + (p - 1) * sizeof(RowBlock));
  const SceneShape none = MakeShape({{0, 0, 2, 3}});
  const FrameMemory placed = PlaceStreams(table, none, nullptr);
  EXPECT_EQ(placed.streams[size_t(StreamOf<&Toys::parts>)].block_count, 3u);
  EXPECT_EQ(placed.streams[size_t(StreamOf<&Toys::long_parts>)].block_count, 0u);
  EXPECT_EQ(placed.Block(StreamOf<&Toys::long_parts>, 2), nullptr);
}

bool HasOddMark(const FrameMemory& memory, const ItemPlace& place) {
  return memory.Of<&Toys::marks>(place.first[size_t(Domain::kPatch)])->word % 2 != 0;
}

TEST(Frame, PatchStagesRunOnEveryPatchThatTheirGateAndKindsLet) {
  const Condition odd{&HasOddMark, Domain::kPatch, {StreamOf<&Toys::marks>, Stream::kNone}};
  const auto marks_after = [&](Gate gate, KindMask kinds) {
    SyntheticScene scene(kLayers);
    for (uint32_t p = 0; p < 6; ++p) scene.Of<&Toys::marks>(p).word = p;
    RunStages(scene, {MakeStage<AddToMark>(Domain::kPatch, kOne, gate, kinds)});
    Counts marks;
    for (uint32_t p = 0; p < 6; ++p) marks.push_back(scene.Of<&Toys::marks>(p).word);
    return marks;
  };
  EXPECT_EQ(marks_after({}, {}), Counts({1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(marks_after({odd}, {}), Counts({0, 2, 2, 4, 4, 6}));
  EXPECT_EQ(marks_after({}, {kLong, kRound}), Counts({0, 2, 3, 3, 4, 5}));
}

TEST(Frame, StreamsThatAPatchLacksKeepItsStageAway) {
  SyntheticScene scene(kLayers);
  RunStages(scene, {MakeStage<UseLongParts>(Domain::kPatch)});
  for (uint32_t p = 1; p < 6; ++p) EXPECT_EQ(scene.Of<&Toys::long_parts>(p).a[0][0], 7.0f);
}

// By places in the layer: patch in layer * lanes + lane.
TEST(Frame, ChunksGatherRecordsOfTheirLayersPatches) {
  SyntheticScene scene(kLayers);
  const SceneShape& shape = scene.shape();
  Random random(9);
  for (uint32_t c = 0; c < shape.chunk_count; ++c)
    for (uint32_t& place : scene.Of<&Toys::order>(c).place)
      place = random.Below(shape.LayerPatches(shape.chunk_layer[c]) * kToyLanes);
  RunStages(scene, {MakeStage<CopyParts>(Domain::kChunk)}, {.must_fit = false});
  for (uint32_t c = 0; c < shape.chunk_count; ++c)
    for (uint32_t i = 0; i < kToyLanes; ++i) {
      const uint32_t place = scene.Of<&Toys::order>(c).place[i];
      const uint32_t patch = shape.layer_first_patch[shape.chunk_layer[c]] + place / kToyLanes;
      const Record& from = scene.Of<&Toys::parts>(patch).record[place % kToyLanes];
      const Record& to = scene.Of<&Toys::copies>(c).record[i];
      ASSERT_EQ(std::memcmp(&from, &to, sizeof to), 0) << c << ' ' << i;
    }
}

TEST(Frame, ChunksGatherBlocksOfThePatchesTheyList) {
  SyntheticScene scene(kLayers);
  for (uint32_t p = 0; p < 6; ++p) scene.Of<&Toys::marks>(p).word = 1u << p;
  scene.Of<&Toys::list>(5).patch[1] = ~0u;  // its layer's first alone
  RunStages(scene, {MakeStage<SumMarks>(Domain::kChunk)});
  EXPECT_EQ(FirstKeys(scene), Counts({1, 1, 2 + 4, 2 + 4, 2 + 4, 8}));
}

TEST(Frame, ALayerHasAllItsPatches) {
  SyntheticScene scene(kLayers);
  for (uint32_t p = 0; p < 6; ++p) scene.Of<&Toys::marks>(p).word = 1u << p;
  RunStages(scene, {MakeStage<SumAllMarks>(Domain::kLayer)});
  const uint32_t sums[] = {1, 2 + 4, 8 + 16 + 32};
  for (uint32_t l = 0; l < 3; ++l) EXPECT_EQ(scene.Of<&Toys::box>(l).word, sums[l]);
}

TEST(Frame, ProfileTellsWhatRanAndWhatDidNot) {
  SyntheticScene scene(kLayers);
  scene.Of<&Toys::state>(4).flags = 0;
  const Plan plan = CompilePlan({MakeStage<AddToKey>(Domain::kChunk, kOne, {kWithToyFlags<1>}),
                                 MakeStage<AddToLayer>(Domain::kLayer, kOne)},
                                scene.shape(), {})
                        .OrThrow();
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
    In<&Toys::state> state;
  };
  static void Run(const Params&, const Ports& ports) {
    g_visited.push_back(ports.state->first_place / kToyLanes);
  }
};

Counts VisitedBy(Executor& executor) {
  SyntheticScene scene({{0, 0, 6}});
  const Plan plan =
      CompilePlan({MakeStage<NoteOrder>(Domain::kChunk, kOne)}, scene.shape(), {}).OrThrow();
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

struct MarkPatch {
  static constexpr std::string_view kName = "mark_patch";
  struct Ports {
    Out<&Toys::marks> mark;
  };
  static void Run(const Ports& ports) { ports.mark->word = 1; }
};

// A chunk whose list names one patch of three waits for that one.
TEST(FrameGraph, ListsThatCanBeReadSayWhichItemsAreAwaited) {
  SyntheticScene scene({{0, 0, 2, 3}});
  const uint32_t named[] = {1, 2};  // by chunks 0 and 1
  for (uint32_t c = 0; c < 2; ++c) {
    auto& list = scene.Of<&Toys::list>(c);
    std::fill(std::begin(list.patch), std::end(list.patch), ~0u);
    list.patch[0] = named[c];
  }
  const Plan plan =
      CompilePlan({MakeStage<MarkPatch>(Domain::kPatch), MakeStage<SumMarks>(Domain::kChunk)},
                  scene.shape(), {})
          .OrThrow();
  const FrameGraph graph = BuildGraph(plan, scene.shape(), &scene.memory());
  std::vector<uint32_t> opened_by(2, ~0u);  // of chunks: the patch after which they are open
  for (uint32_t patch = 0; patch < 3; ++patch) {
    const uint32_t end = graph.item_node[graph.pass_first[0] + patch];
    for (uint32_t n = graph.nodes[end].first_next; n < graph.nodes[end + 1].first_next; ++n)
      graph.ForEachOpened(graph.next[n], [&](uint32_t pass, uint32_t chunk, uint32_t) {
        ASSERT_EQ(pass, 1u);
        EXPECT_EQ(graph.nodes[graph.next[n]].waits_for, 1u);
        opened_by[chunk] = patch;
      });
  }
  EXPECT_EQ(opened_by, std::vector<uint32_t>(std::begin(named), std::end(named)));
}

}  // namespace
}  // namespace pelt::testing
