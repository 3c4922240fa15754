// What a frame takes over from the one before, of a scene's streams: what a snapshot holds.
//
// It follows from the table and the plan, so that a new stream or stage is not forgotten:
//
//   inputs that are filled before the frame               (Kept::kState; the others are baked)
//   state of the simulation                               (Kept::kState)
//   what a stage reads before one has written it over     (by the plan, for each kind of layer)
//   values of which all lanes count, whatever ran         (else a skipped block would keep its own)
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

// One block in a snapshot: of each row its first `lanes` lanes, one behind the other.
struct CarriedBlock {
  Stream stream;
  uint32_t item;
  uint32_t lanes;  // at most, a multiple of 4; fewer may live
  uint32_t words;  // likewise
};

// Of a scene in whose memory every strand lives, in stream order. `joints`: in use, of each
// character, which are the lanes of its poses.
std::vector<CarriedBlock> FindCarried(const FrameMemory& memory, const Plan& plan,
                                      const std::vector<uint32_t>& joints);

// Lanes of a row among the first `lanes` of its block.
uint32_t CarriedLanes(const StreamDesc& stream, const RowDesc& row, uint32_t lanes);

}  // namespace pelt
