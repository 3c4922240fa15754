// The recording vector: the reference's bits, every operation seen once, places instead of
// addresses.
#include <bit>
#include <cstring>
#include <memory>

#include "bench/scenarios/scenarios.hpp"
#include "core/kernels/unrolled.hpp"
#include "platform_sim/pricing/record_stage.hpp"
#include "tests/platform_sim/recording.hpp"

namespace pelt::testing {
namespace {

TEST(RecordingVec, SeesEveryOperationAndItsOperands) {
  const Trace trace = Record([](Rows& rows) {
    const V a = V::Load(rows.row[0]), b = V::Load(rows.row[1]);
    (a * b + a).Store(rows.row[2]);
  });
  ASSERT_EQ(trace.operations.size(), 5u);
  const RecordedOperation& product = trace.operations[2];
  const RecordedOperation& sum = trace.operations[3];
  const RecordedOperation& store = trace.operations[4];
  EXPECT_EQ(product.kind, Kind::kMultiply);
  EXPECT_EQ(product.operand[0], trace.operations[0].result);
  EXPECT_EQ(product.operand[1], trace.operations[1].result);
  EXPECT_EQ(sum.kind, Kind::kAdd);
  EXPECT_EQ(sum.operand[0], product.result);
  EXPECT_EQ(store.operand[0], sum.result);
  EXPECT_EQ(trace.operations[1].address - trace.operations[0].address,
            int32_t(sizeof Rows{}.row[0]));
}

// Four vectors side by side: one operation of the source is four, one behind the other.
TEST(RecordingVec, KnowsWhatIsOneOperationOfTheSource) {
  using W = Unrolled<Unrolled<V>>;
  const Trace trace = Record([](Rows& rows) {
    const W a = W::Load(rows.row[0]), b = W::Load(rows.row[1]);
    const W product = a * b, sum = a + b;
    Select(product < sum, a, b).Store(rows.row[2]);
  });
  uint32_t node = 0;
  for (size_t o = 0; o < trace.operations.size(); ++o) {
    const RecordedOperation& operation = trace.operations[o];
    if (IsStore(operation.kind)) continue;  // each has its place in the order
    EXPECT_EQ(operation.is_side, node++ % 4 != 0) << o;
  }
  EXPECT_EQ(node, 6u * 4);
}

TEST(RecordingVec, GreaterIsLessTurnedRound) {
  const Trace trace = Record([](Rows& rows) {
    const V a = V::Load(rows.row[0]), b = V::Load(rows.row[1]);
    Select(a > b, a, b).Store(rows.row[2]);
  });
  const RecordedOperation& compare = trace.operations[2];
  EXPECT_EQ(compare.kind, Kind::kLess);
  EXPECT_EQ(compare.operand[0], trace.operations[1].result);
}

TEST(RecordingVec, ASplatIsMadeOncePerBits) {
  const Trace trace = Record([](Rows& rows) {
    (V(2.0f) * V(2.0f) + V(3.0f)).Store(rows.row[0]);
    (V::Int(int32_t(std::bit_cast<uint32_t>(2.0f)))).Store(rows.word);
  });
  EXPECT_EQ(CountKinds(trace.operations)[Kind::kSplat], 2u);
}

TEST(RecordingVec, SeesRecordsTranspositionAndRootsAsOne) {
  const Trace trace = Record([](Rows& rows) {
    V x, y, z, w;
    GatherColumns<V>([&](int lane) { return rows.row[lane]; }, x, y, z, w);
    x = Rsqrt(x) * SplatInFours<2>(y);
    ScatterRecords<V>([&](int lane) { return rows.row[4 + lane]; }, x, y, z, w);
  });
  auto kinds = CountKinds(trace.operations);
  EXPECT_EQ(kinds[Kind::kLoadRecord], 4u);
  EXPECT_EQ(kinds[Kind::kTranspose], 2u);
  EXPECT_EQ(kinds[Kind::kReciprocalRoot], 1u);
  EXPECT_EQ(kinds[Kind::kSplatInFours], 1u);
  EXPECT_EQ(kinds[Kind::kStore], 4u);
  EXPECT_EQ(trace.operations.size(), 13u);
}

// A lane's load and the choice of it; a quad that is read, changed and written.
TEST(RecordingVec, PickedLanesCostALoadAndAStoreEach) {
  const Trace trace = Record([](Rows& rows) {
    PickedLanes<V> at;
    for (int l = 0; l < V::kLanes; ++l) at.lane[l] = V::kLanes - 1 - l;
    for (int l = 0; l < V::kLanes; ++l) rows.row[0][l] = float(l);
    StoreLanes(LoadLanes<V>(rows.row[0], at), rows.row[1], at);
    EXPECT_EQ(0, std::memcmp(rows.row[0], rows.row[1], sizeof rows.row[0]));
  });
  auto kinds = CountKinds(trace.operations);
  EXPECT_EQ(kinds[Kind::kLoadSplat], 4u);
  EXPECT_EQ(kinds[Kind::kLoad], 4u);
  EXPECT_EQ(kinds[Kind::kSelect], 7u);
  EXPECT_EQ(kinds[Kind::kStore], 4u);
}

TEST(RecordingVec, ComputesWhatTheReferenceDoes) {
  alignas(64) float in[4] = {0.5f, 3.0f, 1e-3f, 7e5f}, ours[4], reference[4];
  const auto work = [&]<class T>(T) {
    const T a = T::Load(in);
    T x = Rsqrt(a), y = a * T(0.3f), z = Min(a, T(2.0f)), w = Floor(a);
    TransposeFours(x, y, z, w);
    return Select(x < y, SplatInFours<3>(z), w / x);
  };
  work(V()).Store(ours);
  work(ArrayVec<4>()).Store(reference);
  for (int l = 0; l < 4; ++l)
    EXPECT_EQ(std::bit_cast<uint32_t>(ours[l]), std::bit_cast<uint32_t>(reference[l]));
}

// The places of two runs are equal though the rows lie elsewhere and the stack is another.
TEST(Recorder, PlacesDoNotDependOnWhereThingsLie) {
  const auto run = [](Rows& rows, size_t depth) {
    Recorder recorder(Recorder::Keep::kOperations);
    EXPECT_TRUE(recorder.AddBlock(&rows, sizeof rows));
    const RecorderScope recording(recorder);
    std::unique_ptr<float[]> shift(new float[depth]);
    alignas(64) float temporary[2][4];
    V::Load(rows.row[3]).Store(temporary[1]);
    V::Load(temporary[1]).Store(rows.row[0]);
    return recorder.trace();
  };
  const auto a = std::make_unique<Rows>(), gap = std::make_unique<Rows>(),
             b = std::make_unique<Rows>();
  const Trace first = run(*a, 1), second = run(*b, 1000);
  ASSERT_EQ(first.operations.size(), second.operations.size());
  for (size_t o = 0; o < first.operations.size(); ++o)
    EXPECT_EQ(first.operations[o].address, second.operations[o].address);
  EXPECT_EQ(first.operations[1].address, first.operations[2].address);  // the temporary
}

TEST(Recorder, RefusesMoreThanItsSpace) {
  Recorder recorder(Recorder::Keep::kCounts);
  const auto at = [](uintptr_t address) { return reinterpret_cast<const void*>(address); };
  EXPECT_TRUE(recorder.AddBlock(at(4096), uint64_t{1} << 30));
  EXPECT_FALSE(recorder.AddBlock(at(uintptr_t{3} << 30), uint64_t{1} << 30));
}

TEST(RecordingWord, ConstantsFoldAsInCompiledCode) {
  const Trace trace = Record([](Rows& rows) {
    using Word = WordOf<V>;
    const Word key = LoadWord<V>(rows.word, 3u);
    const Word mask = Word(0u) - Word(1u);
    StoreWord<V>(rows.word, (key & mask) | Word(0u), key >> 4);  // indexed by the key itself
  });
  ASSERT_EQ(trace.operations.size(), 3u);
  EXPECT_EQ(trace.operations[1].kind, Kind::kWordShiftRight);
  EXPECT_EQ(trace.operations[2].operand[1], trace.operations[0].result);
}

// A whole frame, as the executors run it.
class RecordedFrame : public ::testing::Test {
 protected:
  static uint64_t Digest(bool recorded, uint64_t& operations) {
    Scenario scenario = LoadScenario("tiny");
    RunningScenario running(scenario, {.isa = Isa::kReference});
    operations = 0;
    for (uint32_t f = 0; f < 3; ++f) {
      running.Begin(f);
      const Frame frame = running.scene().CurrentFrame();
      if (!recorded) {
        SerialExecutor().Run(frame);
        continue;
      }
      EXPECT_TRUE(RecordFrame(frame, [&](uint32_t, uint32_t stage, uint32_t item) {
        Recorder recorder(Recorder::Keep::kCounts);
        RecordStage(frame, stage, item, RecordingKernels(), recorder).OrThrow();
        operations += recorder.operation_count();
        return true;
      }));
    }
    return running.scene().DigestFrame();
  }
};

TEST_F(RecordedFrame, HasTheReferencesDigest) {
  uint64_t none = 0, some = 0;
  EXPECT_EQ(Digest(false, none), Digest(true, some));
  EXPECT_EQ(none, 0u);
  EXPECT_GT(some, 10000u);
}

}  // namespace
}  // namespace pelt::testing
