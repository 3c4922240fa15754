// The sort of a layer that does not fit one local store: the same radix sort, cut so that every
// step holds one chunk's share of the keys.
//
//   for each digit of 8 bits, least significant first:
//     sort_count    a chunk: how many of its keys have each digit
//     sort_offsets  a layer: counts to places, summed over digits and, within a digit, over chunks
//     sort_scatter  a chunk: every pair to its place; the last digit puts strands into the order
//
// Pairs run keys -> a -> b -> a -> order. Each place is written by one chunk only, because places
// are handed out by an exclusive prefix sum. Culled strands have the greatest key there is, so they
// end behind all others, in index order.
//
// Invariant: the order is bit for bit that of SortLayer (core/kernels/sort_layer.hpp), on any order
// of chunks within a step. sort_offsets holds 1 KiB a chunk, so a layer of 170 chunks fits a local
// store of 176 KiB; that bounds the layer.
// What breaks if ignored: SortScatter without SortOffsets between, or out of digit order, loses
// stability first, and strands next.
#pragma once

#include "core/chunk.hpp"
#include "core/kernel.hpp"
#include "core/kernels/sort_layer.hpp"
#include "core/streams.hpp"

namespace pelt {

inline constexpr uint32_t kSortDigits = 4;

namespace sort_pieces_detail {

inline constexpr std::string_view kCountNames[] = {"sort_count0", "sort_count1", "sort_count2",
                                                   "sort_count3"};
inline constexpr std::string_view kOffsetNames[] = {"sort_offsets0", "sort_offsets1",
                                                    "sort_offsets2", "sort_offsets3"};
inline constexpr std::string_view kScatterNames[] = {"sort_scatter0", "sort_scatter1",
                                                     "sort_scatter2", "sort_scatter3"};

// Where digit kDigit reads its pairs (digit 0 reads keys) and writes them (the last: strands).
template <uint32_t kDigit>
inline constexpr auto kSource = kDigit == 2 ? &Streams::sort_pairs_b : &Streams::sort_pairs_a;
template <>
inline constexpr auto kSource<0> = &Streams::sort_keys;
template <uint32_t kDigit>
inline constexpr auto kTarget = kDigit == 1 ? &Streams::sort_pairs_b : &Streams::sort_pairs_a;
template <>
inline constexpr auto kTarget<kSortDigits - 1> = &Streams::order;

template <uint32_t kDigit>
struct SourceBlock {
  using Type = SortPairBlock;
  template <class V>
  static PELT_INLINE WordOf<V> Key(const Type& b, uint32_t i) {
    return LoadWord<V>(&b.pair[i].key, 0);
  }
};
template <>
struct SourceBlock<0> {
  using Type = SortKeyBlock;
  template <class V>
  static PELT_INLINE WordOf<V> Key(const Type& b, uint32_t i) {
    return LoadWord<V>(b.key, i);
  }
};

template <uint32_t kDigit, class Word>
PELT_INLINE Word DigitOf(Word key) {
  return (key >> (8 * kDigit)) & (kDigitBins - 1);
}

// The next place of the digit, which moves on.
template <class V>
PELT_INLINE WordOf<V> TakePlace(DigitBlock& next, WordOf<V> digit) {
  const WordOf<V> place = LoadWord<V>(next.bin, digit);
  StoreWord<V>(next.bin, digit, place + 1u);
  return place;
}

// A scattered record is its words to a type that records them.
template <class V, auto kRow>
PELT_INLINE void PutPair(const Scatter<kRow>& sorted, uint32_t i, WordOf<V> to, WordOf<V> key,
                         WordOf<V> strand) {
  if constexpr (simd_detail::HasWords<V>) {
    if (sorted.index) StoreWord<V>(sorted.index, i, to);
    const WordOf<V> at = (sorted.index ? WordOf<V>(i) : to) << 1;
    StoreWord<V>(&sorted.records->key, at, key);
    StoreWord<V>(&sorted.records->strand, at, strand);
  } else {
    sorted.Put(i, to, {key, strand});
  }
}
template <class V>
PELT_INLINE void PutStrand(const Scatter<&Streams::order>& sorted, uint32_t i, WordOf<V> to,
                           WordOf<V> strand) {
  if constexpr (simd_detail::HasWords<V>) {
    if (sorted.index) StoreWord<V>(sorted.index, i, to);
    StoreWord<V>(sorted.records, sorted.index ? WordOf<V>(i) : to, strand);
  } else {
    sorted.Put(i, to, strand);
  }
}

}  // namespace sort_pieces_detail

template <class V, uint32_t kDigit>
struct SortCount {
  static_assert(kDigit < kSortDigits);
  static constexpr std::string_view kName = sort_pieces_detail::kCountNames[kDigit];
  using Source = sort_pieces_detail::SourceBlock<kDigit>;
  struct Ports {
    In<sort_pieces_detail::kSource<kDigit>> keys;
    Out<&Streams::digits> digits;
  };

  static void Run(const Ports& ports) {
    uint32_t* bin = ports.digits->bin;
    for (uint32_t b = 0; b < kDigitBins; ++b) StoreWord<V>(bin, b, 0u);
    for (uint32_t i = 0; i < kStrandsPerChunk; ++i) {
      const WordOf<V> digit =
          sort_pieces_detail::DigitOf<kDigit>(Source::template Key<V>(*ports.keys, i));
      StoreWord<V>(bin, digit, LoadWord<V>(bin, digit) + 1u);
    }
  }
};

template <class V, uint32_t kDigit>
struct SortOffsets {
  static_assert(kDigit < kSortDigits);
  static constexpr std::string_view kName = sort_pieces_detail::kOffsetNames[kDigit];
  struct Ports {
    AllInOut<&Streams::digits> digits;
  };

  static void Run(const Ports& ports) {
    // Dense rows: whole vectors, but for the running sum.
    using I = typename V::Int;
    alignas(64) uint32_t next[kDigitBins];
    for (uint32_t b = 0; b < kDigitBins; b += V::kLanes) I(0).Store(next + b);
    for (uint32_t c = 0; c < ports.digits.count; ++c)
      for (uint32_t b = 0; b < kDigitBins; b += V::kLanes)
        (I::Load(next + b) + I::Load(ports.digits[c].bin + b)).Store(next + b);
    sort_layer_detail::SumBins<V>(next, kDigitBins);
    for (uint32_t c = 0; c < ports.digits.count; ++c)
      for (uint32_t b = 0; b < kDigitBins; b += V::kLanes) {
        const I count = I::Load(ports.digits[c].bin + b), place = I::Load(next + b);
        place.Store(ports.digits[c].bin + b);
        (place + count).Store(next + b);
      }
  }
};

template <class V, uint32_t kDigit>
struct SortScatter {
  static_assert(kDigit > 0 && kDigit + 1 < kSortDigits);
  static constexpr std::string_view kName = sort_pieces_detail::kScatterNames[kDigit];
  struct Ports {
    In<sort_pieces_detail::kSource<kDigit>> pairs;
    In<&Streams::digits> places;
    Scatter<sort_pieces_detail::kTarget<kDigit>> sorted;
  };

  static void Run(const Ports& ports) {
    using namespace sort_pieces_detail;
    DigitBlock next = *ports.places;
    for (uint32_t i = 0; i < kStrandsPerChunk; ++i) {
      const SortPair& pair = ports.pairs->pair[i];
      const WordOf<V> key = LoadWord<V>(&pair.key, 0), strand = LoadWord<V>(&pair.strand, 0);
      PutPair<V>(ports.sorted, i, TakePlace<V>(next, DigitOf<kDigit>(key)), key, strand);
    }
  }
};

// The first digit makes the pairs: a strand is its chunk's place in the layer and its lane.
template <class V>
struct SortScatter<V, 0> {
  static constexpr std::string_view kName = sort_pieces_detail::kScatterNames[0];
  struct Ports {
    In<&Streams::chunk_state> state;
    In<&Streams::sort_keys> keys;
    In<&Streams::digits> places;
    Scatter<sort_pieces_detail::kTarget<0>> sorted;
  };

  static void Run(const Ports& ports) {
    using namespace sort_pieces_detail;
    DigitBlock next = *ports.places;
    const uint32_t first = ports.state->first_place;
    for (uint32_t i = 0; i < kStrandsPerChunk; ++i) {
      const WordOf<V> key = LoadWord<V>(ports.keys->key, i);
      PutPair<V>(ports.sorted, i, TakePlace<V>(next, DigitOf<0>(key)), key, first + i);
    }
  }
};

// The last digit drops the keys.
template <class V>
struct SortScatter<V, kSortDigits - 1> {
  static constexpr uint32_t kDigit = kSortDigits - 1;
  static constexpr std::string_view kName = sort_pieces_detail::kScatterNames[kDigit];
  struct Ports {
    In<sort_pieces_detail::kSource<kDigit>> pairs;
    In<&Streams::digits> places;
    Scatter<&Streams::order> sorted;
  };

  static void Run(const Ports& ports) {
    using namespace sort_pieces_detail;
    DigitBlock next = *ports.places;
    for (uint32_t i = 0; i < kStrandsPerChunk; ++i) {
      const SortPair& pair = ports.pairs->pair[i];
      const WordOf<V> digit = DigitOf<kDigit>(LoadWord<V>(&pair.key, 0));
      PutStrand<V>(ports.sorted, i, TakePlace<V>(next, digit), LoadWord<V>(&pair.strand, 0));
    }
  }
};

}  // namespace pelt
