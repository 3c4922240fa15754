// The sorts against std::stable_sort, and the sort in pieces against the sort of a whole layer.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "core/kernels/collect_changes.hpp"
#include "core/kernels/sort_layer.hpp"
#include "core/kernels/sort_pieces.hpp"
#include "tests/kernels/run_kernel.hpp"

namespace pelt::test {
namespace {

struct World {
  uint32_t chunks;
  Blocks<SortKeyBlock> keys;
  Blocks<ChunkStateBlock> state;
  Blocks<SortPairBlock> a, b;
  Blocks<DigitBlock> digits;
  Blocks<OrderBlock> words, order;

  explicit World(uint32_t chunk_count)
      : chunks(chunk_count),
        keys(chunk_count),
        state(chunk_count, 0),
        a(chunk_count),
        b(chunk_count),
        digits(chunk_count),
        words(chunk_count),
        order(chunk_count) {
    for (uint32_t c = 0; c < chunks; ++c) state[c].first_place = c * kStrandsPerChunk;
  }
  uint32_t lanes() const { return chunks * kStrandsPerChunk; }
  uint32_t& Key(uint32_t i) { return keys[i / kStrandsPerChunk].key[i % kStrandsPerChunk]; }

  std::vector<uint32_t> Order() const {
    std::vector<uint32_t> out;
    for (uint32_t i = 0; i < lanes(); ++i)
      out.push_back(order[i / kStrandsPerChunk].strand[i % kStrandsPerChunk]);
    return out;
  }

  template <class V>
  std::vector<uint32_t> SortWhole() {
    RunKernel<SortLayer<V>>({keys.Bind(), words.Bind(), order.Bind()});
    return Order();
  }

  // One digit of the sort in pieces, chunks in the order of `sequence`.
  template <class V, uint32_t kDigit>
  void SortDigit(const std::vector<uint32_t>& sequence) {
    Blocks<SortPairBlock>& from = kDigit == 2 ? b : a;
    for (uint32_t c : sequence)
      RunKernel<SortCount<V, kDigit>>({kDigit == 0 ? keys.Bind(c) : from.Bind(c), digits.Bind(c)});
    RunKernel<SortOffsets<V, kDigit>>({digits.Bind()});
    for (uint32_t c : sequence) {
      if constexpr (kDigit == 0)
        RunKernel<SortScatter<V, 0>>({state.Bind(c), keys.Bind(c), digits.Bind(c), a.Bind()});
      else if constexpr (kDigit == 3)
        RunKernel<SortScatter<V, 3>>({a.Bind(c), digits.Bind(c), order.Bind()});
      else
        RunKernel<SortScatter<V, kDigit>>(
            {from.Bind(c), digits.Bind(c), kDigit == 1 ? b.Bind() : a.Bind()});
    }
  }

  template <class V>
  std::vector<uint32_t> SortInPieces() {
    std::vector<uint32_t> sequence(chunks);
    std::iota(sequence.begin(), sequence.end(), 0u);
    SortDigit<V, 0>(sequence);
    std::reverse(sequence.begin(), sequence.end());
    SortDigit<V, 1>(sequence);
    std::rotate(sequence.begin(), sequence.begin() + chunks / 2, sequence.end());
    SortDigit<V, 2>(sequence);
    SortDigit<V, 3>(sequence);
    return Order();
  }

  std::vector<uint32_t> SortPlainly() {
    std::vector<uint32_t> out(lanes());
    std::iota(out.begin(), out.end(), 0u);
    std::stable_sort(out.begin(), out.end(),
                     [&](uint32_t x, uint32_t y) { return Key(x) < Key(y); });
    return out;
  }
};

struct Case {
  const char* name;
  uint32_t (*key)(std::mt19937& random, uint32_t place, uint32_t lanes);
};

uint32_t DepthKey(float depth) {
  uint32_t bits;
  std::memcpy(&bits, &depth, sizeof bits);
  return bits ^ 0x7fffffffu;
}

const Case kCases[] = {
    {"any bits", [](std::mt19937& r, uint32_t, uint32_t) { return uint32_t(r()); }},
    {"a layer's depths, every third facing away",
     [](std::mt19937& r, uint32_t, uint32_t) {
       return r() % 3 ? DepthKey(Uniform(r, 2.9f, 3.2f)) : kCulledKey;
     }},
    {"both sides of the eye",
     [](std::mt19937& r, uint32_t, uint32_t) {
       const float d = Uniform(r, -1.0f, 1.0f);
       uint32_t bits;
       std::memcpy(&bits, &d, sizeof bits);
       return d < 0.0f ? bits : bits ^ 0x7fffffffu;
     }},
    {"few values", [](std::mt19937& r, uint32_t, uint32_t) { return uint32_t(r() % 5) * 1000003; }},
    {"one value", [](std::mt19937&, uint32_t, uint32_t) { return 0x40000000u; }},
    {"all culled", [](std::mt19937&, uint32_t, uint32_t) { return kCulledKey; }},
    {"one drawn",
     [](std::mt19937&, uint32_t i, uint32_t n) { return i == n / 2 ? 77u : kCulledKey; }},
    {"two drawn, equal", [](std::mt19937&, uint32_t i,
                            uint32_t n) { return i == n / 2 || i + 1 == n ? 77u : kCulledKey; }},
    {"first and last value there are",
     [](std::mt19937& r, uint32_t, uint32_t) { return r() % 2 ? 0u : 0xfffffffeu; }},
    {"middle bits agree",
     [](std::mt19937& r, uint32_t, uint32_t) { return uint32_t(r()) & 0xff0000ffu; }},
    {"lowest bits agree",
     [](std::mt19937& r, uint32_t, uint32_t) { return uint32_t(r() % 16) << 20 | 5u; }},
    {"sorted", [](std::mt19937&, uint32_t i, uint32_t) { return 1000 + i; }},
    {"reversed", [](std::mt19937&, uint32_t i, uint32_t n) { return n - i; }},
    {"only the last is culled",
     [](std::mt19937&, uint32_t i, uint32_t n) { return i + 1 == n ? kCulledKey : n - i; }},
    {"only the first is culled", [](std::mt19937& r, uint32_t i,
                                    uint32_t) { return i == 0 ? kCulledKey : uint32_t(r() >> 9); }},
};

TEST(Sort, WholeAndPiecesGiveTheStableOrder) {
  ForEveryVector([]<class V>(const char* vector_name) {
    for (const Case& c : kCases)
      for (uint32_t chunks : {1u, 2u, 5u, 37u}) {
        std::mt19937 random(chunks);
        World world(chunks);
        for (uint32_t i = 0; i < world.lanes(); ++i) world.Key(i) = c.key(random, i, world.lanes());
        const auto plain = world.SortPlainly();
        EXPECT_EQ(world.SortWhole<V>(), plain) << c.name << ' ' << chunks << ' ' << vector_name;
        EXPECT_EQ(world.SortInPieces<V>(), plain) << c.name << ' ' << chunks << ' ' << vector_name;
      }
  });
}

TEST(Sort, TwentyThousandKeys) {
  for (const Case& c : kCases) {
    std::mt19937 random(9);
    World world(20480 / kStrandsPerChunk);
    for (uint32_t i = 0; i < world.lanes(); ++i) world.Key(i) = c.key(random, i, world.lanes());
    const auto plain = world.SortPlainly();
    EXPECT_EQ(world.SortWhole<Vec<IsaSse4>>(), plain) << c.name;
    EXPECT_EQ(world.SortInPieces<Vec<IsaSse4>>(), plain) << c.name;
  }
}

// A local store hands Scatter a list to fill instead of places to write; the result must not
// differ.
// A digit counts as one that all keys share only when they all do.
TEST(Sort, OneKeyThatDiffersInOneBitFindsItsPlace) {
  for (uint32_t bit = 0; bit < 31; ++bit) {
    World w(2);
    for (uint32_t i = 0; i < w.lanes(); ++i) w.Key(i) = 0x1000u;
    w.Key(10) = 0x1000u + (1u << bit);
    const std::vector<uint32_t> wanted = w.SortPlainly();
    EXPECT_EQ(wanted.back(), 10u);
    EXPECT_EQ(w.SortWhole<ArrayVec<4>>(), wanted) << "bit " << bit;
    EXPECT_EQ(w.SortInPieces<ArrayVec<4>>(), wanted) << "bit " << bit;
  }
}

TEST(Sort, ScatterByListPutsTheSameStrands) {
  World world(3);
  std::mt19937 random(1);
  for (uint32_t i = 0; i < world.lanes(); ++i) world.Key(i) = uint32_t(random());
  using V = ArrayVec<4>;
  std::vector<SortPair> placed(world.lanes());
  for (uint32_t c = 0; c < 3; ++c)
    RunKernel<SortCount<V, 0>>({world.keys.Bind(c), world.digits.Bind(c)});
  RunKernel<SortOffsets<V, 0>>({world.digits.Bind()});
  std::vector<int> writes(world.lanes(), 0);
  for (uint32_t c = 0; c < 3; ++c) {
    Blocks<SortPairBlock> list(1);
    uint32_t index[kStrandsPerChunk];
    RunKernel<SortScatter<V, 0>>(
        {world.state.Bind(c), world.keys.Bind(c), world.digits.Bind(c), list.BindList(index)});
    for (uint32_t i = 0; i < kStrandsPerChunk; ++i) {
      placed[index[i]] = list[0].pair[i];
      ++writes[index[i]];
    }
  }
  for (int n : writes) EXPECT_EQ(n, 1);
  std::vector<uint32_t> plain(world.lanes());
  std::iota(plain.begin(), plain.end(), 0u);
  std::stable_sort(plain.begin(), plain.end(), [&](uint32_t x, uint32_t y) {
    return (world.Key(x) & 255) < (world.Key(y) & 255);
  });
  for (uint32_t i = 0; i < world.lanes(); ++i) EXPECT_EQ(placed[i].strand, plain[i]);
}

TEST(Sort, DigitPlansCoverTheKeyAndFitTheBins) {
  using namespace sort_layer_detail;
  for (uint32_t bits = 1; bits <= 32; ++bits)
    for (uint32_t count = 2; count < 3000000; count = count * 3 / 2 + 1) {
      const DigitPlan plan = PlanDigits(bits, count);
      ASSERT_GE(plan.passes, 1u);
      ASSERT_LE(plan.passes, 4u);
      EXPECT_GE(plan.passes * plan.digit_bits, bits);
      const uint32_t widest = plan.passes == 4 ? 8 : plan.passes == 3 ? 11 : 12;
      EXPECT_LE(plan.digit_bits, widest);
    }
}

// What a small store leaves for blocks is nothing, not a number that wrapped round.
TEST(Sort, AStoreSmallerThanItsFixedPartSortsNoChunk) {
  EXPECT_EQ(SortableChunks(0), 0u);
  EXPECT_EQ(SortableChunks(33 * 1024), 0u);
  EXPECT_EQ(SortableChunks(33 * 1024 + 10 * kStrandsPerChunk * 12), 10u);
  const uint32_t strands = SortableChunks(176 * 1024) * kStrandsPerChunk;
  EXPECT_GT(strands, 32u * 128u);
  EXPECT_LT(strands, 176u * 128u);
}

struct ChangesWorld {
  Blocks<LayerBlock> layer{1, 0};
  Blocks<ChunkStateBlock> chunks{5, 0};
  Blocks<LayerSortBlock> sort{1};
  const LayerSortBlock& Run(uint32_t switches, uint32_t view_changed) {
    RunKernel<CollectChanges<ArrayVec<4>>>({switches, view_changed},
                                           {layer.Bind(), chunks.Bind(), sort.Bind()});
    return sort[0];
  }
};

TEST(CollectChanges, CountsAndReportsWhatAnyChunkReports) {
  ChangesWorld w;
  for (uint32_t c = 0; c < 5; ++c) {
    w.chunks[c].live_strands = 20 + c;
    w.chunks[c].visible_strands = 10 + c;
  }
  EXPECT_EQ(w.Run(kSwitchSkipSort, 0).visible_count, 60u);
  EXPECT_EQ(w.sort[0].keys_changed, 0u);
  EXPECT_EQ(w.sort[0].records_changed, 0u);
  w.chunks[4].keys_changed = 1;
  EXPECT_EQ(w.Run(kSwitchSkipSort, 0).keys_changed, 1u);
  EXPECT_EQ(w.sort[0].records_changed, 0u);
  w.chunks[4].keys_changed = 0;
  w.chunks[0].records_changed = 1;
  EXPECT_EQ(w.Run(kSwitchSkipSort, 0).keys_changed, 0u);
  EXPECT_EQ(w.sort[0].records_changed, 1u);
}

TEST(CollectChanges, AMovedEyeRewritesRibbonsOnly) {
  ChangesWorld w;
  w.chunks[2].live_strands = 1;
  EXPECT_EQ(w.Run(kSwitchSkipSort, 1).records_changed, 0u);
  w.layer[0].flags = kLayerRibbons;
  EXPECT_EQ(w.Run(kSwitchSkipSort, 1).records_changed, 1u);
  EXPECT_EQ(w.sort[0].keys_changed, 0u);
}

TEST(CollectChanges, WithoutTheSwitchVisibleLayersAlwaysChangeAndHiddenOnesNever) {
  ChangesWorld w;
  w.layer[0].flags = kLayerRibbons;
  EXPECT_EQ(w.Run(0, 1).keys_changed, 0u);
  EXPECT_EQ(w.sort[0].records_changed, 0u);
  EXPECT_EQ(w.sort[0].visible_count, 0u);
  w.chunks[0].live_strands = 1;
  EXPECT_EQ(w.Run(0, 0).keys_changed, 1u);
  EXPECT_EQ(w.sort[0].records_changed, 1u);
}

}  // namespace
}  // namespace pelt::test
