// Which blocks of a frame lie in a shared L2: whole blocks, least recently used goes first.
//
// Between the passes of a frame, and between items that share a block (the pose of a character, the
// records of a layer), a cache saves what a local store brings anew. At the size of blocks that is
// a matter of capacity; sets, ways and single lines belong to memory/xenon_memory.hpp.
//
// Invariant: every dirty block that leaves, or is still here, was written once; what came is what
// was not here.
#pragma once

#include <cstdint>
#include <vector>

#include "jobs/frame.hpp"

namespace pelt {

class BlockCache {
 public:
  // Of the blocks of this frame's memory.
  BlockCache(uint64_t bytes, const FrameMemory& memory);

  struct Evicted {
    Stream stream;
    uint32_t bytes;
  };
  // Block `block` (a number, not an item) of `stream` is used; `whole`: it is written without being
  // read. Returns the bytes that memory must bring; what must be written back is added to
  // `evicted`.
  uint32_t Touch(Stream stream, uint32_t block, bool written, bool whole,
                 std::vector<Evicted>& evicted);

 private:
  static constexpr uint32_t kNone = ~0u;
  struct Entry {
    uint32_t newer = kNone, older = kNone;
    Stream stream = Stream::kNone;
    bool here = false, dirty = false;
  };
  void Unlink(uint32_t e);
  void LinkNewest(uint32_t e);

  const uint64_t capacity_;
  uint64_t used_ = 0;
  const StreamTable& table_;
  std::vector<uint32_t> first_;  // entry of a stream's block 0
  std::vector<Entry> entries_;
  uint32_t newest_ = kNone, oldest_ = kNone;
};

}  // namespace pelt
