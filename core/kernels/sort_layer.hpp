// Exact stable sort of one layer's strands by key, far to near, ties by strand index: a radix sort,
// least significant digit first, over exactly the bits in which the keys differ.
//
//   1. scan      least and greatest visible key, and how many there are
//   2. count     histograms of all digits, in one read of the keys
//   3. scatter   one pass a digit; the first reads keys, the last writes strands into the order
//
// Subtracting the least key keeps every comparison and leaves only the bits the layer's depth range
// needs: a layer 0.4 m deep at 3 m has keys that differ in 21 bits, which is two passes of 11 where
// raw keys take three or four. Culled strands leave in the first scatter, straight behind the
// visible ones: without a branch where they are mixed (which strands face away is noise to a branch
// predictor), a group of lanes at a time where LOD has culled the rest of a chunk.
//
// Between passes a strand is one word: what is left of its key above, its index below.
//
//   [ key bits of the digits to come | strand ]
//
// The first digit is spent when the word is made, so with 21 bits of key and 20,000 strands a word
// is 11 + 15 bits: 32 do, and the scattered writes stay near the first-level cache. Where they do
// not (a layer that the eye is within), words are strands alone, and every pass looks up their keys.
//
// Words go from the scratch to the order and back, so that the last pass ends in the order.
//
// The number of passes is chosen from the bits and the number of keys: a wide digit costs bins to
// clear and to sum, a narrow one costs passes. Counts and bits only: the choice, like the result,
// is the same on every machine. A digit on which all keys agree is skipped.
//
// Invariant: the whole order is written: first the visible strands, then all others of the layer's
// lanes in index order. core/kernels/sort_pieces.hpp gives the same order for
// layers that do not fit a local store.
// What breaks if ignored: an order that is not stable flickers where strands are equally far.
#pragma once

#include "core/chunk.hpp"
#include "core/kernel.hpp"
#include "core/streams.hpp"

namespace pelt {

// Largest layer, in chunks, whose sort fits a local store of so many bytes of data.
constexpr uint32_t SortableChunks(uint32_t local_store_data_bytes) {
  constexpr uint32_t kPerChunk = sizeof(SortKeyBlock) + 2 * sizeof(OrderBlock);
  constexpr uint32_t kFixed = 33 * 1024;  // bins, alignment
  return local_store_data_bytes > kFixed ? (local_store_data_bytes - kFixed) / kPerChunk : 0;
}

namespace sort_layer_detail {

inline constexpr uint32_t kMaxDigitBits = 12;
inline constexpr uint32_t kMaxPasses = 4;

struct DigitPlan {
  uint32_t passes;
  uint32_t digit_bits;
};

// The cheapest way to sort `count` keys of `bits` bits: a pass costs a read and a scattered write
// of every key, five times what clearing and summing a bin costs.
PELT_INLINE DigitPlan PlanDigits(uint32_t bits, uint32_t count) {
  DigitPlan best{0, 0};
  uint32_t best_cost = ~0u;
  for (uint32_t passes = 1; passes <= kMaxPasses; ++passes) {
    const uint32_t digit_bits = (bits + passes - 1) / passes;
    if (digit_bits > kMaxDigitBits) continue;
    const uint32_t cost = passes * (5 * count + (1u << digit_bits));
    if (cost < best_cost) {
      best_cost = cost;
      best = {passes, digit_bits};
    }
  }
  return best;
}

// Bits that tell `count` things apart.
PELT_INLINE uint32_t BitsFor(uint32_t count) {
  return count < 2 ? 1u : 32u - uint32_t(__builtin_clz(count - 1));
}

// Counts to places: exclusive prefix sum.
template <class V>
PELT_INLINE void SumBins(uint32_t* bins, uint32_t bin_count) {
  WordOf<V> sum = 0;
  for (uint32_t b = 0; b < bin_count; ++b) {
    const WordOf<V> count = LoadWord<V>(bins, b);
    StoreWord<V>(bins, b, sum);
    sum += count;
  }
}

}  // namespace sort_layer_detail

template <class V>
struct SortLayer {
  static constexpr std::string_view kName = "sort_layer";
  struct Ports {
    All<&Streams::sort_keys> keys;
    AllOut<&Streams::sort_words> scratch;
    AllOut<&Streams::order> order;
  };
  // Blocks of a layer lie back to back, so a stream is one array over the layer's lanes.
  static_assert(sizeof(SortKeyBlock) == sizeof(uint32_t) * kStrandsPerChunk);
  static_assert(sizeof(OrderBlock) == sizeof(uint32_t) * kStrandsPerChunk);

  static_assert(kStrandsPerChunk % kLaneGroup == 0);

  struct Range {
    uint32_t least, greatest, count;  // of the visible keys
  };

  // Vectors compare signed: keys are read with their highest bit turned over.
  static PELT_INLINE Range ScanKeys(const uint32_t* keys, uint32_t lanes) {
    using I = typename V::Int;
    const I flip(INT32_MIN), culled(INT32_MAX);
    I least(INT32_MAX), greatest(INT32_MIN), count(0);
    for (uint32_t i = 0; i < lanes; i += V::kLanes) {
      const I key = I::Load(keys + i) ^ flip;
      const typename V::Mask is_culled = key == culled;
      const I shown = Select(is_culled, I(INT32_MIN), key);
      least = Select(key < least, key, least);
      greatest = Select(shown > greatest, shown, greatest);
      count = count + Select(is_culled, I(0), I(1));
    }
    Range r{kCulledKey, 0, 0};
    for (int l = 0; l < V::kLanes; ++l) {
      const uint32_t low = uint32_t(least[l]) ^ 0x80000000u;
      const uint32_t high = uint32_t(greatest[l]) ^ 0x80000000u;
      r.least = low < r.least ? low : r.least;
      r.greatest = high > r.greatest ? high : r.greatest;
      r.count += uint32_t(count[l]);
    }
    return r;
  }

  // Whether all of the kLaneGroup lanes from `keys` on are visible, or none is.
  static PELT_INLINE bool IsGroupVisible(const uint32_t* keys) {
    using I = typename V::Int;
    typename V::Mask culled = I::Load(keys) == I(int32_t(kCulledKey));
    for (uint32_t l = V::kLanes; l < kLaneGroup; l += V::kLanes)
      culled = culled | (I::Load(keys + l) == I(int32_t(kCulledKey)));
    return !Any(culled);
  }
  static PELT_INLINE bool IsGroupCulled(const uint32_t* keys) {
    using I = typename V::Int;
    static_assert(kCulledKey == 0xffffffffu);  // nothing else has every bit
    I bits = I::Load(keys);
    for (uint32_t l = V::kLanes; l < kLaneGroup; l += V::kLanes) bits = bits & I::Load(keys + l);
    return !Any(!(bits == I(-1)));
  }

  // One layer's sort, once its digits are chosen: kPasses digits of digit_bits each; kHoldsKeys: words hold what is
  // left of their keys. Loops work on copies of members: scattered words may alias them.
  template <uint32_t kPasses, bool kHoldsKeys>
  struct Sorter {
    using Scalar = WordOf<V>;
    using Word = uint32_t;

    const uint32_t* keys;
    uint32_t lanes;
    Range range;
    uint32_t digit_bits, index_bits;
    Word* order;
    // 32-bit keys: 4 passes of 8 bits, 3 of 11, 2 or 1 of 12.
    alignas(64) uint32_t bins[kPasses == 4 ? 4 << 8 : kPasses == 3 ? 3 << 11 : kPasses << 12];

    PELT_INLINE uint32_t BinCount() const { return 1u << digit_bits; }
    PELT_INLINE uint32_t* Bins(uint32_t pass) { return bins + (pass << digit_bits); }

    // Calls lane(i, key, seen) for every lane of a group with a visible one, group(i) for every
    // other group. Where all are visible, as they mostly are in a patch that faces the eye, `seen`
    // is a constant. The key of a culled lane is its index: it picks some bin, to which nothing is
    // added, and no two such lanes wait for each other there.
    template <class OnLane, class OnGroup>
    PELT_INLINE void ForEachLane(OnLane on_lane, OnGroup on_group) const {
      const uint32_t* const in = keys;
      const uint32_t end = lanes, least = range.least;
      for (uint32_t first = 0; first < end; first += kLaneGroup) {
        if (IsGroupVisible(in + first)) {
          for (uint32_t i = first; i < first + kLaneGroup; ++i)
            on_lane(i, Scalar(LoadWord<V>(in, i) - least), Scalar(1u));
        } else if (IsGroupCulled(in + first)) {
          on_group(first);
        } else {
          for (uint32_t i = first; i < first + kLaneGroup; ++i) {
            const Scalar key = LoadWord<V>(in, i), seen = key != kCulledKey, mask = 0u - seen;
            on_lane(i, Scalar(((key - least) & mask) | (i & ~mask)), seen);
          }
        }
      }
    }

    PELT_INLINE void CountDigits() {
      const uint32_t bits = digit_bits, mask = BinCount() - 1;
      uint32_t* const count = bins;
      for (uint32_t b = 0; b < kPasses << bits; ++b) StoreWord<V>(count, b, 0u);
      ForEachLane(
          [&](uint32_t, Scalar key, Scalar seen) __attribute__((always_inline)) {
            PELT_UNROLL
            for (uint32_t pass = 0; pass < kPasses; ++pass) {
              const Scalar bin = (key >> (pass * bits)) & mask;
              uint32_t* const of_pass = count + (pass << bits);
              StoreWord<V>(of_pass, bin, LoadWord<V>(of_pass, bin) + seen);
            }
          },
          [](uint32_t) __attribute__((always_inline)){});
    }

    // The pass that reads keys: visible strands to their place by the first digit, culled ones
    // behind all visible. A word is made of the key without that digit, and of a culled one just the strand.
    PELT_INLINE void ScatterKeys(Word* to) {
      const uint32_t mask = BinCount() - 1, bits = digit_bits, shift = index_bits;
      uint32_t* const next = bins;
      Scalar culled = range.count;
      ForEachLane(
          [&](uint32_t i, Scalar key, Scalar seen) __attribute__((always_inline)) {
            const Scalar bin = key & mask, place = LoadWord<V>(next, bin), keep = 0u - seen;
            Scalar word = i;
            if constexpr (kHoldsKeys) word = (((key >> bits) << shift) & keep) | word;
            StoreWord<V>(to, (place & keep) | (culled & ~keep), word);
            StoreWord<V>(next, bin, place + seen);
            culled += 1u - seen;
          },
          [&](uint32_t first) __attribute__((always_inline)) {
            for (uint32_t l = 0; l < kLaneGroup; ++l)
              StoreWord<V>(to, culled + l, Scalar(first + l));
            culled += kLaneGroup;
          });
    }
    // The last pass leaves strands.
    template <bool kLast>
    PELT_INLINE void ScatterWords(uint32_t pass, const Word* from, Word* to) {
      const uint32_t count = range.count, mask = BinCount() - 1, least = range.least;
      const uint32_t shift = kHoldsKeys ? index_bits + (pass - 1) * digit_bits : pass * digit_bits;
      const uint32_t strand = kHoldsKeys ? (1u << index_bits) - 1 : ~0u;
      const uint32_t* const key_of = keys;
      uint32_t* const next = Bins(pass);
      for (uint32_t i = 0; i < count; ++i) {
        const Scalar word = LoadWord<V>(from, i);
        Scalar key = word;
        if constexpr (!kHoldsKeys) key = LoadWord<V>(key_of, word) - least;
        const Scalar bin = (key >> shift) & mask, place = LoadWord<V>(next, bin);
        StoreWord<V>(next, bin, place + 1u);
        StoreWord<V>(to, place, kLast ? Scalar(word & strand) : word);
      }
    }

    // Whether the keys differ in digit `pass`, whose bins are still counts: the least key is 0
    // here.
    PELT_INLINE bool Differs(uint32_t pass) { return Bins(pass)[0] != range.count; }

    PELT_INLINE void Run(Word* scratch) {
      CountDigits();
      bool needed[kPasses];
      uint32_t last = 0, scatters = 1;
      for (uint32_t pass = 0; pass < kPasses; ++pass) {
        needed[pass] = Differs(pass);
        if (needed[pass]) last = pass;
        if (pass > 0) scatters += needed[pass] ? 1 : 0;
        sort_layer_detail::SumBins<V>(Bins(pass), BinCount());
      }
      // The first pass makes the words, so it runs even where all keys agree on its digit.
      Word *to = scatters % 2 != 0 ? order : scratch, *from = to == scratch ? order : scratch;
      ScatterKeys(to);
      if (to == scratch)
        for (uint32_t i = range.count; i < lanes; ++i)
          StoreWord<V>(order, i, Scalar(LoadWord<V>(to, i)));
      for (uint32_t pass = 1; pass <= last; ++pass) {
        if (!needed[pass]) continue;
        Word* const made = to;
        to = from;
        from = made;
        if (pass == last)
          ScatterWords<true>(pass, from, to);
        else
          ScatterWords<false>(pass, from, to);
      }
    }
  };

  template <uint32_t kPasses, bool kHoldsKeys>
  static PELT_INLINE void SortWords(const Ports& ports, const Range& range, uint32_t digit_bits,
                                    uint32_t index_bits) {
    Sorter<kPasses, kHoldsKeys> sorter;
    sorter.keys = ports.keys.blocks->key;
    sorter.lanes = ports.keys.count * kStrandsPerChunk;
    sorter.range = range;
    sorter.digit_bits = digit_bits;
    sorter.index_bits = index_bits;
    sorter.order = ports.order.blocks->strand;
    sorter.Run(ports.scratch.blocks->strand);
  }

  template <uint32_t kPasses>
  static void SortDigits(const Ports& ports, const Range& range, uint32_t key_bits,
                         uint32_t digit_bits) {
    const uint32_t index_bits = sort_layer_detail::BitsFor(ports.keys.count * kStrandsPerChunk);
    const uint32_t kept_bits = key_bits > digit_bits ? key_bits - digit_bits : 0;
    if (kept_bits + index_bits <= 32)
      SortWords<kPasses, true>(ports, range, digit_bits, index_bits);
    else
      SortWords<kPasses, false>(ports, range, digit_bits, index_bits);
  }

  static void Run(const Ports& ports) {
    using namespace sort_layer_detail;
    const uint32_t lanes = ports.keys.count * kStrandsPerChunk;
    const Range range = ScanKeys(ports.keys.blocks->key, lanes);
    if (range.count == 0) {
      uint32_t* const order = ports.order.blocks->strand;
      for (uint32_t i = 0; i < lanes; ++i) StoreWord<V>(order, i, i);
      return;
    }
    const uint32_t span = range.greatest - range.least;
    const uint32_t key_bits = span == 0 ? 1u : 32u - uint32_t(__builtin_clz(span));
    const DigitPlan plan = PlanDigits(key_bits, range.count);
    if (plan.passes == 1) return SortDigits<1>(ports, range, key_bits, plan.digit_bits);
    if (plan.passes == 2) return SortDigits<2>(ports, range, key_bits, plan.digit_bits);
    if (plan.passes == 3) return SortDigits<3>(ports, range, key_bits, plan.digit_bits);
    SortDigits<4>(ports, range, key_bits, plan.digit_bits);
  }
};

}  // namespace pelt
