// What a kernel's later groups of lanes will use, fetched into the cache while this group is worked
// on.
//
// A frame goes through tens of megabytes once, a line of each of a chunk's rows at a time, and no
// machine's own prefetching follows that: half of a frame was waiting. Lines asked for all at once
// wait for each other as the kernel's own loads do (a core has room for some 16 at a time), so each
// group asks for a few, spread over its work, and never in one place for more than that.
//
// Nothing is computed from what is fetched, and no address is refused: behind a chunk's last lines
// come the first ones of the next chunk, whose block follows in the scene's memory. Where none does
// (the last one, a local store) they are asked for in vain.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>

#include "core/chunk.hpp"
#include "core/simd.hpp"

namespace pelt {

namespace fetch_detail {

inline constexpr uint32_t kLineBytes = 64;

PELT_INLINE void FetchLine(const std::byte* line) { __builtin_prefetch(line); }

}  // namespace fetch_detail

// kRows rows of 4-byte lanes, kPitch bytes from one to the next, in a loop over groups of kLanes
// lanes of a `Block`: what they have kLines lines on. A line holds the lanes of several groups, each
// of which fetches its share of the rows.
template <class Block, int kLanes, uint32_t kRows, uint32_t kPitch, uint32_t kLines = 1>
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
  template <uint32_t kPiece = 0, uint32_t kPieces = 1>
  PELT_INLINE void Fetch() const {
    ForEachLine<kPiece, kPieces>([](const std::byte* line) __attribute__((always_inline)) {
      fetch_detail::FetchLine(line);
    });
  }

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

// All rows of a block that has nothing else, from its first one on.
template <class Block, int kLanes, uint32_t kLines = 1,
          uint32_t kPitch = kStrandsPerChunk * sizeof(float)>
using BlockAhead = RowsAhead<Block, kLanes, sizeof(Block) / kPitch, kPitch, kLines>;

// The records, kBytes of each lane, of the group of kLanes that is kGroups on; arguments as above.
// With `end` 0 they are the next chunk's.
template <class Block, int kLanes, uint32_t kBytes, uint32_t kGroups = 2>
PELT_INLINE void FetchRecordsAhead(const void* records, uint32_t lane, uint32_t end) {
  constexpr uint32_t kStep = kBytes * uint32_t(kLanes);
  const uint32_t next = lane + kGroups * uint32_t(kLanes);
  const std::byte* first =
      static_cast<const std::byte*>(records) +
      (next < end ? next * kBytes : uint32_t(sizeof(Block)) + (next - end) * kBytes);
  for (uint32_t at = 0; at < kStep; at += fetch_detail::kLineBytes)
    fetch_detail::FetchLine(first + at);
}

}  // namespace pelt
