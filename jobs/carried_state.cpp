#include "jobs/carried_state.hpp"

#include <algorithm>

namespace pelt {
namespace {

// Whether the first stage of the frame that uses the stream needs what was there.
bool IsReadFirst(const Plan& plan, Stream stream, uint32_t kind) {
  for (const Stage& stage : plan.stages) {
    if (stage.domain == Domain::kChunk && !stage.kinds.Admits(kind)) continue;
    for (const PortDesc& port : stage.kernel.ports)
      if (port.stream == stream) return IsRead(port.access);
  }
  return false;
}

bool IsOfJoints(const StreamDesc& stream) {
  return stream.domain == Domain::kCharacter && stream.role == Role::kInput;
}

}  // namespace

bool IsCarried(const StreamTable& table, const Plan& plan, Stream stream, uint32_t kind) {
  const StreamDesc& desc = table[stream];
  if (desc.kept == Kept::kState) return true;
  if (desc.role == Role::kInput || desc.role == Role::kScratch) return false;
  return desc.lanes.AllHoldValues() || IsReadFirst(plan, stream, kind);
}

uint32_t CarriedLanes(const StreamDesc& stream, const RowDesc& row, uint32_t lanes) {
  const bool some = IsOfJoints(stream) || !stream.lanes.AllHoldValues();
  return some ? std::min(row.lane_count, lanes) : row.lane_count;
}

std::vector<CarriedBlock> FindCarried(const FrameMemory& memory, const Plan& plan,
                                      const std::vector<uint32_t>& joints) {
  std::vector<CarriedBlock> carried;
  const SceneShape& shape = *memory.shape;
  for (uint32_t s = 0; s < memory.streams.size(); ++s) {
    const Stream stream{uint8_t(s)};
    const StreamDesc& desc = (*memory.table)[stream];
    for (uint32_t i = 0; i < shape.ItemCount(desc.domain); ++i) {
      if (memory.streams[s].block_count == 0 || !memory.Block(stream, i)) continue;
      const bool chunk = desc.domain == Domain::kChunk;
      if (!IsCarried(*memory.table, plan, stream,
                     chunk ? shape.layer_kind[shape.chunk_layer[i]] : 0))
        continue;
      CarriedBlock block{stream, i, memory.table->chunk_lanes, 0};
      if (chunk) block.lanes = (memory.LiveLanes(stream, i) + 3) / 4 * 4;
      if (IsOfJoints(desc)) block.lanes = joints[i];
      for (const RowDesc& row : desc.rows)
        block.words += row.element_count / row.lane_count * CarriedLanes(desc, row, block.lanes);
      block.words = (block.words + 3) / 4 * 4;
      if (block.lanes != 0) carried.push_back(block);
    }
  }
  return carried;
}

}  // namespace pelt
