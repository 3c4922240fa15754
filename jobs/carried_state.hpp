// What a frame takes over from the one before, of a scene's streams: what a snapshot holds.
//
// It follows from the table and the plan, so that a new stream or stage is not forgotten:
//
//   inputs that are filled before the frame               (Kept::kState; the others are baked)
//   state of the simulation                               (Kept::kState)
//   what a stage reads before one has written it over     (by the plan, for each kind of layer)
//   values of which all lanes count, run or skipped       (else a skipped block would keep its own)
//
// Everything else follows from these in the next frame, if that leaves out nothing.
#pragma once

#include <cstdint>
#include <vector>

#include "core/frame_memory.hpp"
#include "jobs/plan.hpp"

namespace pelt {

// Whether blocks of the stream are carried; of chunks, those of layers of this kind.
bool IsCarried(const StreamTable& table, const Plan& plan, Stream stream, uint32_t kind);

// Rows of a block that a snapshot has: `rows` of them, `step` bytes from each to the next.
struct CarriedRun {
  uint32_t offset;  // in the block, bytes
  uint32_t rows, step;
  uint32_t lanes, width;  // of a row; words of a lane
  bool whole;             // all lanes, however many live
  uint32_t Words(uint32_t of) const { return width * (whole || of > lanes ? lanes : of); }
};
// Of a stream's blocks: what lies together is one run.
std::vector<CarriedRun> FindRuns(const StreamDesc& stream);

// One block in a snapshot: its runs, one behind the other.
struct CarriedBlock {
  Stream stream;
  uint32_t item;
  uint32_t lanes;  // at most, a multiple of 4; fewer may live
  uint32_t words;  // likewise
};

struct CarriedState {
  std::vector<CarriedBlock> blocks;           // in stream order
  std::vector<std::vector<CarriedRun>> runs;  // of each stream
  uint64_t HeapBytes() const;
};
// Of a scene in whose memory every strand lives. `joints`: in use, of each character, which are the
// lanes of its poses.
CarriedState FindCarried(const FrameMemory& memory, const Plan& plan,
                         const std::vector<uint32_t>& joints);

}  // namespace pelt
