// What a kernel's later groups of lanes will use, prefetched into the cache while this group is worked
// on.
//
// A frame goes through tens of megabytes once, a line of each of a chunk's rows at a time, and no
// machine's own prefetching follows that: half of a frame was waiting. Lines asked for all at once
// wait for each other as the kernel's own loads do (a core has room for some 16 at a time), so each
// group asks for a few, spread over its work, and never in one place for more than that.
//
// A kernel lists what it goes through (AllRows, RowsFrom, RecordsFrom, NextChunkFrom), for its loop
// over groups (ForEachPrefetched) or, where a group's work is long, in pieces between the steps of
// that (PrefetchInPieces).
//
// Nothing is computed from what is prefetched, and no address is refused: behind a chunk's last lines
// come the first ones of the next chunk, whose block follows in the scene's memory. Where none does
// (the last one, a local store) they are asked for in vain.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>

#include "core/chunk.hpp"
#include "core/simd.hpp"

namespace pelt {

// kRows rows of 4-byte lanes, kPitch bytes from one to the next, in a loop over groups of kLanes
// lanes of a `Block`: what they have kLines lines on. A line holds the lanes of several groups, each
// of which asks for its share of the rows.
template <class Block, int kLanes, uint32_t kRows, uint32_t kPitch, uint32_t kLines>
class RowsAhead {
 public:
  // `rows`: the first of them in this chunk's block. The loop is at `lane`, and ends before `end`.
  PELT_INLINE RowsAhead(const void* rows, uint32_t lane, uint32_t end) {
    const uint32_t group = lane % kLineLanes / uint32_t(kLanes);
    const uint32_t line = lane / kLineLanes + kLines, lines = (end + kLineLanes - 1) / kLineLanes;
    const uint32_t far =
        line < lines ? line * kStep : uint32_t(sizeof(Block)) + (line - lines) * kStep;
    share_ = static_cast<const std::byte*>(rows) + far + group * (kShare * kPitch);
    // A chunk's last group also takes what those would have that its line has room for.
    shares_ = lane + uint32_t(kLanes) < end ? 1 : kLineLanes / uint32_t(kLanes) - group;
  }

  // Piece kPiece of kPieces of the group's share.
  template <uint32_t kPiece, uint32_t kPieces, class Each>
  PELT_INLINE void ForEachLine(const Each& each) const {
    constexpr uint32_t kFirst = kShare * kPiece / kPieces;
    constexpr uint32_t kCount = kShare * (kPiece + 1) / kPieces - kFirst;
    for (uint32_t share = 0; share < shares_; ++share)
      EachRow(each, share_ + (kFirst + share * kShare) * kPitch,
              std::make_integer_sequence<uint32_t, kCount>());
  }

 private:
  static constexpr uint32_t kLineLanes = kLanes < 16 ? 16 : uint32_t(kLanes);
  static constexpr uint32_t kStep = kLineLanes * 4;
  static constexpr uint32_t kShare = (kRows * uint32_t(kLanes) + kLineLanes - 1) / kLineLanes;

  template <class Each, uint32_t... kRow>
  PELT_INLINE static void EachRow(const Each& each, const std::byte* first,
                                  std::integer_sequence<uint32_t, kRow...>) {
    (each(first + kRow * kPitch), ...);
  }

  const std::byte* share_;
  uint32_t shares_;
};

template <uint32_t kBytes>
struct BytesAhead {
  const std::byte* first;

  template <uint32_t kPiece, uint32_t kPieces, class Each>
  PELT_INLINE void ForEachLine(const Each& each) const {
    static_assert(kPieces == 1, "records are not taken in pieces");
    constexpr uint32_t kLineBytes = 64;
    for (uint32_t at = 0; at < kBytes; at += kLineBytes) each(first + at);
  }
};

// ---- Lists --------------------------------------------------------------------------------------

template <class Block, uint32_t kRows, uint32_t kPitch, uint32_t kLines>
struct RowList {
  const void* first;

  template <int kLanes>
  PELT_INLINE auto Ahead(uint32_t lane, uint32_t end) const {
    return RowsAhead<Block, kLanes, kRows, kPitch, kLines>(first, lane, end);
  }
};

// Of the group that is kGroups on; with 0, of the next chunk's group at the same lane.
template <class Block, uint32_t kBytes, uint32_t kGroups>
struct RecordList {
  const void* first;

  template <int kLanes>
  PELT_INLINE auto Ahead(uint32_t lane, uint32_t end) const {
    const uint32_t next = lane + kGroups * uint32_t(kLanes), stop = kGroups == 0 ? 0 : end;
    const uint32_t far =
        next < stop ? next * kBytes : uint32_t(sizeof(Block)) + (next - stop) * kBytes;
    return BytesAhead<kBytes * uint32_t(kLanes)>{static_cast<const std::byte*>(first) + far};
  }
};

inline constexpr uint32_t kChunkRow = kStrandsPerChunk * sizeof(float);

// kRows rows of a block from `first` on, and kLines lines on in them.
template <uint32_t kRows, uint32_t kLines = 1, uint32_t kPitch = kChunkRow, class Block>
PELT_INLINE RowList<Block, kRows, kPitch, kLines> RowsFrom(const Block&, const void* first) {
  return {first};
}

// All rows of a block that has nothing else.
template <uint32_t kLines = 1, uint32_t kPitch = kChunkRow, class Block>
PELT_INLINE auto AllRows(const Block& block) {
  return RowsFrom<sizeof(Block) / kPitch, kLines, kPitch>(block, &block);
}

// Records of a block, kBytes of each lane.
template <uint32_t kBytes, class Block>
PELT_INLINE RecordList<Block, kBytes, 2> RecordsFrom(const Block&, const void* first) {
  return {first};
}

// The same of the next chunk.
template <uint32_t kBytes, class Block>
PELT_INLINE RecordList<Block, kBytes, 0> NextChunkFrom(const Block&, const void* first) {
  return {first};
}

// ---- Loops --------------------------------------------------------------------------------------

template <uint32_t kPiece>
struct Piece {};

// What a group has of lists ahead of it, in kPieces pieces: called with Piece<i>(), it asks for piece i.
template <int kLanes, uint32_t kPieces, class... Lists>
struct PiecesAhead {
  PELT_INLINE PiecesAhead(uint32_t, uint32_t) {}
  template <uint32_t kPiece>
  PELT_INLINE void operator()(Piece<kPiece>) const {}
};
template <int kLanes, uint32_t kPieces, class List, class... Others>
struct PiecesAhead<kLanes, kPieces, List, Others...> {
  decltype(List{}.template Ahead<kLanes>(0, 0)) ahead;
  PiecesAhead<kLanes, kPieces, Others...> others;

  PELT_INLINE PiecesAhead(uint32_t lane, uint32_t end, const List& list, const Others&... lists)
      : ahead(list.template Ahead<kLanes>(lane, end)), others(lane, end, lists...) {}
  template <uint32_t kPiece>
  PELT_INLINE void operator()(Piece<kPiece> piece) const {
    ahead.template ForEachLine<kPiece, kPieces>(
        [](const std::byte* line) __attribute__((always_inline)) { __builtin_prefetch(line); });
    others(piece);
  }
};

// For a group's work.
template <int kLanes, uint32_t kPieces, class... Lists>
PELT_INLINE PiecesAhead<kLanes, kPieces, Lists...> PrefetchInPieces(uint32_t lane, uint32_t end,
                                                                    const Lists&... lists) {
  return {lane, end, lists...};
}

// Calls work(lane) for all groups of lanes [begin, end), and before each asks for what it has of
// lists ahead of it.
template <int kLanes, class Work, class... Lists>
PELT_INLINE void ForEachPrefetched(uint32_t begin, uint32_t end, const Work& work,
                                   const Lists&... lists) {
  for (uint32_t lane = begin; lane < end; lane += uint32_t(kLanes)) {
    PrefetchInPieces<kLanes, 1>(lane, end, lists...)(Piece<0>());
    work(lane);
  }
}

}  // namespace pelt
