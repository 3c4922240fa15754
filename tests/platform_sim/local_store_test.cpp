// The local-store executor: what it moves, what it counts, what it finds. (Which faults of a kernel
// it finds is in tests/determinism/planted_faults_test.cpp.)
#include "platform_sim/local_store.hpp"

#include <gtest/gtest.h>

#include "tests/jobs/synthetic_scene.hpp"

namespace pelt::testing {
namespace {

// key -> pair -> order, so that pairs stay in local store when fused.
struct MakePairs {
  static constexpr std::string_view kName = "make_pairs";
  struct Ports {
    In<&Toys::keys> keys;
    Out<&Toys::pairs_b> pairs;
  };
  static void Run(const Ports& ports) {
    for (uint32_t i = 0; i < kToyLanes; ++i)
      ports.pairs->pair[i] = {ports.keys->key[i], kToyLanes - 1 - i};
  }
};
struct UsePairs {
  static constexpr std::string_view kName = "use_pairs";
  struct Ports {
    In<&Toys::pairs_b> pairs;
    Out<&Toys::order> order;
  };
  static void Run(const Ports& ports) {
    for (uint32_t i = 0; i < kToyLanes; ++i)
      ports.order->place[i] = ports.pairs->pair[i].key ^ ports.pairs->pair[i].place;
  }
};
struct SumLayer {
  static constexpr std::string_view kName = "sum_layer";
  struct Ports {
    All<&Toys::keys> keys;
    Out<&Toys::sum> sum;
  };
  static void Run(const Ports& ports) {
    *ports.sum = {};
    for (uint32_t c = 0; c < ports.keys.count; ++c) ports.sum->word += ports.keys[c].key[0];
  }
};
struct GatherCurves {
  static constexpr std::string_view kName = "gather_curves";
  struct Ports {
    In<&Toys::order> order;
    Gather<&Toys::records, &Toys::order> records;
    Out<&Toys::copies> copies;
  };
  static void Run(const Ports& ports) {
    for (uint32_t i = 0; i < kToyLanes; ++i)
      ports.copies->record[i] = i < kToyLanes / 2 ? ports.records[i] : Record{};
  }
};
struct GatherStates {
  static constexpr std::string_view kName = "gather_states";
  struct Ports {
    In<&Toys::order> order;
    GatherBlocks<&Toys::state, &Toys::order> states;
    Out<&Toys::pairs_b> pairs;
  };
  static void Run(const Ports& ports) {
    for (uint32_t i = 0; i < kToyLanes; ++i)
      ports.pairs->pair[i] = i < kToyLanes / 2
                                 ? KeyPlace{ports.states[i].flags, ports.states[i].first_place}
                                 : KeyPlace{};
  }
};
struct ReverseIntoLayer {
  static constexpr std::string_view kName = "reverse_into_layer";
  struct Ports {
    In<&Toys::state> state;
    In<&Toys::keys> keys;
    Scatter<&Toys::pairs_a> pairs;
  };
  // Every other strand, so that some list entries stay unused.
  static void Run(const Ports& ports) {
    for (uint32_t i = 0; i < kToyLanes; i += 2)
      ports.pairs.Put(i, ports.state->first_place + (kToyLanes - 1 - i), {ports.keys->key[i], i});
  }
};

const std::vector<LayerSpec> kLayers = {{0, 0, 3}, {1, 0, 2}};
constexpr uint32_t kChunks = 5;

// Runs `stages` once on each executor, on scenes filled like that, and compares these streams.
LocalStoreCounts ExpectSameAsSerial(const std::vector<Stage>& stages, bool fuse,
                                    std::initializer_list<Stream> streams,
                                    void (*fill)(SyntheticScene&) = nullptr) {
  SyntheticScene a(kLayers), b(kLayers);
  for (SyntheticScene* scene : {&a, &b})
    if (fill) fill(*scene);
  const Plan plan = CompilePlan(stages, a.shape(), {.fuse = fuse}).OrThrow();
  SerialExecutor serial;
  serial.Run({&plan, &a.memory()});
  LocalStoreExecutor local(PlanOptions{}.local_store_data_bytes);
  local.Run({&plan, &b.memory()});
  EXPECT_EQ(a.DigestOf(streams), b.DigestOf(streams));
  for (const LocalStoreFault& f : local.faults()) ADD_FAILURE() << f.stage << ": " << f.what;
  return local.counts();
}

TEST(LocalStore, OwnBlocksMoveAsDeclared) {
  const std::vector<Stage> stages = {MakeStage<MakePairs>(Domain::kChunk),
                                     MakeStage<UsePairs>(Domain::kChunk)};
  const auto unfused = ExpectSameAsSerial(stages, false, {StreamOf<&Toys::order>});
  EXPECT_EQ(unfused.get_bytes, kChunks * (sizeof(KeyBlock) + sizeof(PairBlock)));
  EXPECT_EQ(unfused.put_bytes, kChunks * (sizeof(PairBlock) + sizeof(PlaceBlock)));
  EXPECT_EQ(unfused.transient_bytes, 0u);
  EXPECT_EQ(unfused.dma_commands, 4 * kChunks);

  const auto fused = ExpectSameAsSerial(stages, true, {StreamOf<&Toys::order>});
  EXPECT_EQ(fused.get_bytes, kChunks * sizeof(KeyBlock));
  EXPECT_EQ(fused.put_bytes, kChunks * sizeof(PlaceBlock));
  EXPECT_EQ(fused.transient_bytes, kChunks * sizeof(PairBlock));
  EXPECT_EQ(fused.peak_bytes, sizeof(KeyBlock) + sizeof(PairBlock) + sizeof(PlaceBlock));
}

TEST(LocalStore, WholeLayersMoveAsOne) {
  const auto counts =
      ExpectSameAsSerial({MakeStage<SumLayer>(Domain::kLayer)}, true, {StreamOf<&Toys::sum>});
  EXPECT_EQ(counts.get_bytes, kChunks * sizeof(KeyBlock));
  EXPECT_EQ(counts.put_bytes, 2 * sizeof(WordBlock));
  EXPECT_EQ(counts.peak_bytes, 3 * sizeof(KeyBlock) + sizeof(WordBlock));
}

// Lists of places among so many of the layer for each of its chunks.
void FillLists(SyntheticScene& scene, uint32_t each) {
  for (uint32_t c = 0; c < kChunks; ++c) {
    auto& order = scene.Of<&Toys::order>(c);
    const uint32_t places = (c < 3 ? 3 : 2) * each;
    for (uint32_t i = 0; i < kToyLanes; ++i)  // the second half means nothing
      order.place[i] = i < kToyLanes / 2 ? (i * 37 + c) % places : ~0u;
  }
}

TEST(LocalStore, GathersListedRecordsAndNothingElse) {
  const auto counts =
      ExpectSameAsSerial({MakeStage<GatherCurves>(Domain::kChunk)}, true, {StreamOf<&Toys::copies>},
                         [](auto& s) { FillLists(s, kToyLanes); });
  EXPECT_EQ(counts.list_elements, kChunks * kToyLanes / 2);
}

TEST(LocalStore, GathersWholeBlocksToo) {
  const auto fill = [](SyntheticScene& scene) {
    FillLists(scene, 1);
    for (uint32_t c = 0; c < kChunks; ++c) scene.Of<&Toys::state>(c).flags = 100 + c;
  };
  const std::vector<Stage> stages = {MakeStage<GatherStates>(Domain::kChunk)};
  const auto counts = ExpectSameAsSerial(stages, true, {StreamOf<&Toys::pairs_b>}, fill);
  constexpr uint64_t kElements = kChunks * kToyLanes / 2;
  EXPECT_EQ(counts.list_elements, kElements);
  EXPECT_EQ(counts.get_bytes, kChunks * sizeof(PlaceBlock) + kElements * sizeof(StateBlock));
  SyntheticScene scene(kLayers);
  fill(scene);
  const Plan plan = CompilePlan(stages, scene.shape(), {}).OrThrow();
  SerialExecutor().Run({&plan, &scene.memory()});
  const auto& found = scene.Of<&Toys::pairs_b>(4);
  EXPECT_EQ(found.pair[0].key, 100u + 3 + 4 % 2) << "of its own layer";
  EXPECT_EQ(found.pair[1].key, 100u + 3 + (37 + 4) % 2);
}

TEST(LocalStore, ScattersWhatWasPutAndLeavesTheRest) {
  const auto counts = ExpectSameAsSerial({MakeStage<ReverseIntoLayer>(Domain::kChunk)}, true,
                                         {StreamOf<&Toys::pairs_a>});
  EXPECT_EQ(counts.list_elements, kChunks * kToyLanes / 2);
}

TEST(LocalStore, LargeTransfersTakeSeveralCommands) {
  // A layer of 40 chunks of keys is 20 KiB: two commands of at most 16 KiB, and one for the sum.
  SyntheticScene scene({{0, 0, 40}});
  const Plan plan = CompilePlan({MakeStage<SumLayer>(Domain::kLayer)}, scene.shape(), {}).OrThrow();
  LocalStoreExecutor local(PlanOptions{}.local_store_data_bytes);
  local.Run({&plan, &scene.memory()});
  const uint64_t bytes = 40 * sizeof(KeyBlock);
  EXPECT_EQ(local.counts().dma_commands, (bytes + 16383) / 16384 + 1);
}

// A plan made for a larger store must not run off this one.
TEST(LocalStore, ReportsAPlanThatNeedsMoreThanThereIs) {
  SyntheticScene scene({{0, 0, 600}});
  const Plan plan = CompilePlan({MakeStage<SumLayer>(Domain::kLayer)}, scene.shape(),
                                {.local_store_data_bytes = 1 << 20})
                        .OrThrow();
  const uint64_t before = scene.DigestOf({StreamOf<&Toys::sum>});
  for (const uint32_t data_bytes : {600 * uint32_t(sizeof(KeyBlock)) - 1, 1u << 20}) {
    LocalStoreExecutor local(data_bytes);
    local.Run({&plan, &scene.memory()});
    ASSERT_EQ(local.faults().size(), 1u);
    EXPECT_EQ(local.faults()[0].stage, "sum_layer");
    EXPECT_NE(local.faults()[0].what.find("port 'keys' needs"), std::string::npos)
        << local.faults()[0].what;
    EXPECT_EQ(scene.DigestOf({StreamOf<&Toys::sum>}), before) << "the stage must not have run";
  }
}

}  // namespace
}  // namespace pelt::testing
