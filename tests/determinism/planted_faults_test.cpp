// Every way a kernel can go wrong is planted, and each fault must be caught by the check meant for
// it, which must pass the healthy kernel.
//
//   fault                                  caught by
//   reads a neighbour that moves           execution order, local store
//   reads a neighbour that never moves     local store
//   writes through a const cast            local store (named)
//   static state                           execution order
//   reads what it declared Out             local store
//   writes past its block                  local store (named)
//   reaches across the layer undeclared    execution order (declared: the plan's wait)
//   a plan that lost a wait                execution order
//   two chunks scatter to one place        execution order
//   scatters outside its layer             local store (named)
//   lane-count-dependent sum               instruction sets
//   contracted multiply-add                instruction sets
//   unstable tie in the sort               the sort in pieces, and the order itself
//   a port left out, a write through In    the compiler (compile_errors_test.sh, and below)
#include "tests/determinism/planted_faults.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "core/kernel.hpp"
#include "core/kernels/sort_layer.hpp"
#include "core/kernels/sort_pieces.hpp"
#include "platform_sim/local_store.hpp"
#include "tests/jobs/synthetic_scene.hpp"

namespace pelt::testing {
namespace {

const std::vector<LayerSpec> kLayers = {{0, 0, 4}, {0, 0, 3}};

struct Verdict {
  bool order_matters = false;   // permuted execution gives other bits than serial
  bool fusion_matters = false;  // unfused gives other bits than fused
  bool local_store_differs = false;
  std::vector<LocalStoreFault> faults;

  bool Named(std::string_view text) const {
    return std::any_of(faults.begin(), faults.end(), [&](const LocalStoreFault& f) {
      return f.what.find(text) != std::string::npos;
    });
  }
};

uint64_t RunFrames(const std::vector<Stage>& stages, Executor& executor, bool fuse,
                   void (*tamper)(Plan&, const SceneShape&) = nullptr) {
  SyntheticScene scene(kLayers);
  // Record lists of the gather: lane i of the layer's first chunk.
  for (uint32_t c = 0; c < scene.shape().chunk_count; ++c) {
    auto* list = reinterpret_cast<uint32_t*>(scene.memory().Block(StreamOf<&Toys::pairs_a>, c));
    for (uint32_t i = 0; i < kToyLanes; ++i) list[i] = i;
  }
  Plan plan = CompilePlan(stages, scene.shape(), {.fuse = fuse}).OrThrow();
  if (tamper) tamper(plan, scene.shape());
  Digest digest;
  for (uint32_t f = 0; f < 3; ++f) {
    executor.Run({&plan, &scene.memory()});
    digest.Add64(
        scene.DigestOf({StreamOf<&Toys::keys>, StreamOf<&Toys::order>, StreamOf<&Toys::made>}));
  }
  return digest.Value();
}

// `store` off for kernels that would leave the local store's memory altogether.
Verdict Judge(const std::vector<Stage>& stages, bool store = true) {
  Verdict verdict;
  SerialExecutor serial;
  const uint64_t truth = RunFrames(stages, serial, true);
  for (uint64_t seed = 0; seed < 4; ++seed) {
    PermutedExecutor permuted(seed);
    verdict.order_matters |= RunFrames(stages, permuted, true) != truth;
  }
  verdict.fusion_matters = RunFrames(stages, serial, false) != truth;
  if (store) {
    LocalStoreExecutor local(PlanOptions{}.local_store_data_bytes);
    verdict.local_store_differs = RunFrames(stages, local, true) != truth;
    verdict.faults = local.faults();
  }
  return verdict;
}

constexpr FaultParams kParams{0x9e3779b9u};

template <class K>
Stage Chunk() {
  return MakeStage<K>(Domain::kChunk, kParams);
}
template <class K>
std::vector<Stage> FrameOf() {
  return {Chunk<Advance>(), Chunk<K>()};
}

void ExpectHealthy(const Verdict& v) {
  EXPECT_FALSE(v.order_matters);
  EXPECT_FALSE(v.fusion_matters);
  EXPECT_FALSE(v.local_store_differs);
  for (const LocalStoreFault& f : v.faults)
    ADD_FAILURE() << f.stage << ", item " << f.item << ": " << f.what;
}

TEST(PlantedFaults, HealthyFramePassesEveryCheck) { ExpectHealthy(Judge(FrameOf<Derive>())); }

TEST(PlantedFaults, MovingNeighbourIsCaughtByOrderAndLocalStore) {
  const Verdict v = Judge(FrameOf<ReadsMovingNeighbour>());
  EXPECT_TRUE(v.order_matters);
  EXPECT_TRUE(v.local_store_differs);
}

TEST(PlantedFaults, ConstantNeighbourIsCaughtByLocalStoreOnly) {
  const Verdict v = Judge(FrameOf<ReadsConstantNeighbour>());
  EXPECT_FALSE(v.order_matters) << "if order shows it, the fault is not the one meant";
  EXPECT_TRUE(v.local_store_differs);
}

TEST(PlantedFaults, ConstCastIsNamedByLocalStore) {
  const Verdict v = Judge(FrameOf<WritesThroughConstCast>());
  EXPECT_TRUE(v.Named("wrote through its read-only port 'keys'"));
  EXPECT_EQ(v.faults.front().stage, "writes_through_const_cast");
}

TEST(PlantedFaults, StaticStateIsCaughtByOrder) {
  KeepsStaticState::runs = 0;
  EXPECT_TRUE(Judge(FrameOf<KeepsStaticState>()).order_matters);
}

TEST(PlantedFaults, ReadingAnOutPortIsCaughtByLocalStore) {
  const Verdict v = Judge(FrameOf<ReadsItsOut>());
  EXPECT_FALSE(v.order_matters);
  EXPECT_TRUE(v.local_store_differs);
}

// Fused behind a stage that wrote the same stream, the block is in local store already: it is
// poisoned again for whoever declares Out.
TEST(PlantedFaults, ReadingAnOutPortIsCaughtWhenFusedToo) {
  const Verdict v = Judge({Chunk<Advance>(), Chunk<Derive>(), Chunk<ReadsItsOut>()});
  EXPECT_TRUE(v.local_store_differs);
}

TEST(PlantedFaults, WritingPastTheBlockIsNamedByLocalStore) {
  const Verdict v = Judge(FrameOf<WritesPastItsBlock>());
  EXPECT_TRUE(v.Named("past the end of its block of stream 'order'"));
}

TEST(PlantedFaults, ReachingAcrossTheLayerIsCaughtByOrder) {
  EXPECT_TRUE(Judge(FrameOf<ReachesAcrossTheLayer>(), false).order_matters);
}

TEST(PlantedFaults, ReachingAcrossTheLayerDeclaredGetsItsWait) {
  const auto stages = FrameOf<GathersAcrossTheLayer>();
  EXPECT_EQ(CompilePlan(stages, MakeShape(kLayers), {}).OrThrow().passes.size(), 2u);
  ExpectHealthy(Judge(stages));
}

void DropWait(Plan& plan, const SceneShape& shape) {
  plan.passes[1].waits.clear();
  plan.graph = BuildGraph(plan, shape);
}

TEST(PlantedFaults, AMissingWaitIsCaughtByOrder) {
  const auto stages = FrameOf<GathersAcrossTheLayer>();
  SerialExecutor serial;
  const uint64_t truth = RunFrames(stages, serial, true);
  bool caught = false;
  for (uint64_t seed = 0; seed < 4; ++seed) {
    PermutedExecutor permuted(seed), again(seed);
    EXPECT_EQ(RunFrames(stages, permuted, true), truth) << "with its wait";
    caught |= RunFrames(stages, again, true, DropWait) != truth;
  }
  EXPECT_TRUE(caught);
}

TEST(PlantedFaults, CollidingScatterIsCaughtByOrder) {
  ExpectHealthy(Judge(FrameOf<ScatterStrands<false>>()));
  EXPECT_TRUE(Judge(FrameOf<ScatterStrands<true>>()).order_matters);
}

struct ScattersOutside : ScatterStrands<false> {
  static constexpr std::string_view kName = "scatters_outside";
  static void Run(const Params&, const Ports& ports) {
    for (uint32_t i = 0; i < kToyLanes; ++i)
      ports.order.Put(i, 4 * kToyLanes + i, ports.keys->key[i]);
  }
};

TEST(PlantedFaults, ScatteringOutsideTheLayerIsNamedByLocalStore) {
  SyntheticScene scene(kLayers);
  const Plan plan = CompilePlan({Chunk<ScattersOutside>()}, scene.shape(), {}).OrThrow();
  const uint64_t before = scene.DigestOf({StreamOf<&Toys::order>});
  LocalStoreExecutor local(PlanOptions{}.local_store_data_bytes);
  local.Run({&plan, &scene.memory()});
  ASSERT_FALSE(local.faults().empty());
  const std::string end = std::to_string(4 * kToyLanes);
  EXPECT_NE(local.faults()[0].what.find("scattered to place " + end + " of " + end),
            std::string::npos)
      << local.faults()[0].what;
  EXPECT_EQ(scene.DigestOf({StreamOf<&Toys::order>}), before) << "nothing may be put outside";
}

// ---- Lane counts and compilers ------------------------------------------------------------------

template <class Kernel>
uint64_t DigestOfKernel(const Kernel& kernel) {
  SerialExecutor serial;
  return RunFrames({{kernel, &kParams, Domain::kChunk, {}, {}}}, serial, true);
}
template <class K>
uint64_t DigestWith() {
  return DigestOfKernel(MakeKernelDesc<K>());
}

TEST(PlantedFaults, LaneCountDependentSumIsCaughtByInstructionSets) {
  const uint64_t truth = DigestWith<SumRow<ArrayVec<4>, false>>();
  EXPECT_EQ((DigestWith<SumRow<ArrayVec<8>, false>>()), truth);
  EXPECT_EQ((DigestWith<SumRow<Vec<IsaSse4>, false>>()), truth);
  const uint64_t four = DigestWith<SumRow<ArrayVec<4>, true>>();
  EXPECT_EQ((DigestWith<SumRow<Vec<IsaSse4>, true>>()), four) << "four lanes are four lanes";
  EXPECT_NE((DigestWith<SumRow<ArrayVec<8>, true>>()), four);
}

TEST(PlantedFaults, ContractionIsCaughtByInstructionSets) {
  struct AsWritten {};
  struct AsWrittenAgain {};
  const uint64_t truth = DigestWith<MultiplyAdd<AsWritten>>();
  EXPECT_EQ(DigestWith<MultiplyAdd<AsWrittenAgain>>(), truth);
#if defined(__x86_64__)
  if (!__builtin_cpu_supports("fma")) GTEST_SKIP() << "this processor has no fused multiply-add";
  EXPECT_NE(DigestOfKernel(ContractedMultiplyAdd()), truth);
#else
  GTEST_SKIP() << "the contracted kernel is built for x86-64 only";
#endif
}

// ---- Ties ---------------------------------------------------------------------------------------

// Sorts right but forgets about ties: the last of equal keys comes first.
struct SortUnstably {
  static constexpr std::string_view kName = "sort_unstably";
  struct Ports {
    All<&Streams::sort_keys> keys;
    AllOut<&Streams::order> order;
  };
  static void Run(const Ports& ports) {
    const uint32_t count = ports.keys.count * kStrandsPerChunk;
    const uint32_t* keys = ports.keys.blocks->key;
    uint32_t* order = ports.order.blocks->strand;
    for (uint32_t i = 0; i < count; ++i) order[i] = i;
    std::sort(order, order + count, [&](uint32_t a, uint32_t b) {
      return keys[a] != keys[b] ? keys[a] < keys[b] : a > b;
    });
  }
};

template <uint32_t kDigit>
void AddDigit(std::vector<Stage>& stages) {
  using V = ArrayVec<4>;
  stages.push_back(MakeStage<SortCount<V, kDigit>>(Domain::kChunk));
  stages.push_back(MakeStage<SortOffsets<V, kDigit>>(Domain::kLayer));
  stages.push_back(MakeStage<SortScatter<V, kDigit>>(Domain::kChunk));
}

std::vector<Stage> SortInPieces() {
  std::vector<Stage> stages;
  AddDigit<0>(stages);
  AddDigit<1>(stages);
  AddDigit<2>(stages);
  AddDigit<3>(stages);
  return stages;
}

// Sorts a scene with many ties and returns the order's digest; `first_unstable` is the first place
// of layer 0 that does not follow (key, strand), or the number of places.
uint64_t SortScene(const std::vector<Stage>& stages, uint32_t* first_unstable) {
  std::vector<LayerSpec> layers = kLayers;
  if (stages.size() > 1)  // each way has scratch of its own
    for (LayerSpec& layer : layers) layer.kind |= kLayerSortInPieces;
  SyntheticSceneOf<Streams> scene(layers);
  const SceneShape& shape = scene.shape();
  for (uint32_t c = 0; c < shape.chunk_count; ++c) {
    for (uint32_t& key : scene.Of<&Streams::sort_keys>(c).key) key &= 0x30005u;
    scene.Of<&Streams::chunk_state>(c).first_place =
        (c - shape.layer_first_chunk[shape.chunk_layer[c]]) * kStrandsPerChunk;
  }
  const Plan plan = CompilePlan(stages, scene.shape(), {}).OrThrow();
  PermutedExecutor executor(5);
  executor.Run({&plan, &scene.memory()});
  const uint32_t places = scene.shape().LayerChunks(0) * kStrandsPerChunk;
  const uint32_t* keys = scene.Of<&Streams::sort_keys>(0).key;
  const uint32_t* order = scene.Of<&Streams::order>(0).strand;
  uint32_t at = 1;
  while (at < places && (keys[order[at - 1]] < keys[order[at]] ||
                         (keys[order[at - 1]] == keys[order[at]] && order[at - 1] < order[at])))
    ++at;
  *first_unstable = at;
  return scene.DigestOf({StreamOf<&Streams::order>});
}

TEST(PlantedFaults, UnstableTieIsCaughtByTheOrderAndByTheSortInPieces) {
  const uint32_t places = kLayers[0].chunks * kStrandsPerChunk;
  uint32_t first_unstable = 0;
  const uint64_t whole =
      SortScene({MakeStage<SortLayer<ArrayVec<4>>>(Domain::kLayer)}, &first_unstable);
  EXPECT_EQ(first_unstable, places);
  const uint64_t pieces = SortScene(SortInPieces(), &first_unstable);
  EXPECT_EQ(first_unstable, places);
  EXPECT_EQ(whole, pieces);
  const uint64_t unstable = SortScene({MakeStage<SortUnstably>(Domain::kLayer)}, &first_unstable);
  EXPECT_LT(first_unstable, places);
  EXPECT_NE(unstable, pieces);
}

// A pass of the radix sort left out makes an order that is no order.
TEST(PlantedFaults, SkippedDigitIsCaughtByTheOrder) {
  std::vector<Stage> stages = SortInPieces();
  // Without the scatter of digit 2, digit 3 sorts what digit 1 left.
  stages.erase(stages.begin() + 8);
  uint32_t first_unstable = 0;
  SortScene(stages, &first_unstable);
  EXPECT_LT(first_unstable, kLayers[0].chunks * kStrandsPerChunk);
}

// ---- What does not compile ----------------------------------------------------------------------

template <class P>
concept CanWriteOwn = requires(P port) {
  port->key[0] = 1u;
};
template <class P>
concept CanWriteDereferenced = requires(P port) {
  (*port).key[0] = 1u;
};
template <class P>
concept CanWriteIndexed = requires(P port) {
  port[0].key[0] = 1u;
};

template <class P>
concept CanWriteRecord = requires(P port) {
  port[0].key = 1u;
};

static_assert(CanWriteOwn<Out<&Toys::keys>> && CanWriteOwn<InOut<&Toys::keys>>);
static_assert(!CanWriteOwn<In<&Toys::keys>> && !CanWriteOwn<Shared<&Toys::keys>>);
static_assert(CanWriteDereferenced<Out<&Toys::keys>>);
static_assert(!CanWriteDereferenced<In<&Toys::keys>> && !CanWriteDereferenced<Shared<&Toys::keys>>);
static_assert(CanWriteIndexed<AllOut<&Toys::keys>> && CanWriteIndexed<AllInOut<&Toys::keys>>);
static_assert(!CanWriteIndexed<All<&Toys::keys>> &&
              !CanWriteRecord<Gather<&Toys::pairs_a, &Toys::order>> &&
              !CanWriteIndexed<GatherBlocks<&Toys::keys, &Toys::order>>);

}  // namespace
}  // namespace pelt::testing
