// A 64-bit digest of values: floats by their bits, wider types by value, so byte order does not
// matter.
//
// One multiply and rotate a word (in the manner of FxHash, with a finishing mix); not for
// adversaries. The order of words counts. Sums of digests are never taken: a lost block must not
// cancel another.
#pragma once

#include <cstdint>

#include "core/frame_memory.hpp"
#include "core/random.hpp"

namespace pelt {

class Digest {
 public:
  void Add(uint32_t word) {
    const uint64_t turned = (state_ << 5) | (state_ >> 59);
    state_ = (turned ^ word) * 0x9e3779b97f4a7c15ull;
  }
  void Add64(uint64_t value) {
    Add(uint32_t(value));
    Add(uint32_t(value >> 32));
  }
  uint64_t Value() const { return MixBits(state_); }

 private:
  uint64_t state_ = 0x6c62272e07bb0142ull;
};

// The element at `index` of a row, widened to 32 bits.
uint32_t RowElement(const void* block, const RowDesc& row, uint32_t index);

// Adds every row of a block: whole for streams whose lanes all hold values, otherwise the
// first `live_lanes` lanes.
void AddBlock(Digest& digest, const StreamDesc& stream, const void* block, uint32_t live_lanes);

// Adds the live lanes of the block of `item`, and their number; nothing where it has none.
void AddItem(Digest& digest, const FrameMemory& memory, Stream stream, uint32_t item);

// Where two blocks first differ, in row order, among the lanes AddBlock looks at.
struct BlockDifference {
  bool differs = false;
  const RowDesc* row = nullptr;
  uint32_t component = 0, lane = 0;
  uint32_t left = 0, right = 0;
};
BlockDifference FindDifference(const StreamDesc& stream, const void* left, const void* right,
                               uint32_t live_lanes);

// Of all blocks of one stream that has the role kValue, of each the number of its live lanes first; 0
// for other streams.
uint64_t DigestStream(const FrameMemory& memory, Stream stream);
// Of all of them.
uint64_t DigestFrame(const FrameMemory& memory);

}  // namespace pelt
