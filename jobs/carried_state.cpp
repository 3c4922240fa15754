#include "jobs/carried_state.hpp"

#include <algorithm>

namespace pelt {
namespace {

// Whether the first stage of the frame that uses the stream needs what was there.
bool IsReadFirst(const Plan& plan, Stream stream, uint32_t kind) {
  for (const Stage& stage : plan.stages) {
    if (IsInLayer(stage.domain) && !stage.kinds.Admits(kind)) continue;
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

std::vector<CarriedRun> FindRuns(const StreamDesc& stream) {
  const bool whole = stream.lanes.AllHoldValues() && !IsOfJoints(stream);
  std::vector<CarriedRun> runs;
  for (const RowDesc& row : stream.rows) {
    const uint32_t components = row.element_count / row.lane_count, from = row.offset_bytes;
    CarriedRun run{from, components, 4 * row.lane_count, row.lane_count, 1, whole};
    if (row.lane_major) run = {from, 1, 4 * row.element_count, row.lane_count, components, whole};
    if (whole) run = {from, 1, 4 * row.element_count, row.element_count, 1, true};
    CarriedRun* last = runs.empty() ? nullptr : &runs.back();
    const bool follows = last && last->offset + last->rows * last->step == from;
    if (follows && whole) {
      last->lanes += run.lanes;
      last->step += run.step;
    } else if (follows && last->lanes == run.lanes && last->width == 1 && run.width == 1) {
      last->rows += run.rows;
    } else {
      runs.push_back(run);
    }
  }
  return runs;
}

CarriedState FindCarried(const FrameMemory& memory, const Plan& plan,
                         const std::vector<uint32_t>& joints) {
  CarriedState carried;
  const SceneShape& shape = *memory.shape;
  for (uint32_t s = 0; s < memory.streams.size(); ++s) {
    const Stream stream{uint8_t(s)};
    const StreamDesc& desc = (*memory.table)[stream];
    const std::vector<CarriedRun>& runs = carried.runs.emplace_back(FindRuns(desc));
    for (uint32_t i = 0; i < shape.ItemCount(desc.domain); ++i) {
      if (memory.streams[s].block_count == 0 || !memory.Block(stream, i)) continue;
      const bool has_lanes = IsInLayer(desc.domain);
      const uint32_t kind = has_lanes ? shape.layer_kind[shape.LayerOf(desc.domain, i)] : 0;
      if (!IsCarried(*memory.table, plan, stream, kind)) continue;
      CarriedBlock block{stream, i, memory.table->chunk_lanes, 0};
      if (has_lanes) block.lanes = (memory.LiveLanes(stream, i) + 3) / 4 * 4;
      if (IsOfJoints(desc)) block.lanes = joints[i];
      for (const CarriedRun& run : runs) block.words += run.rows * run.Words(block.lanes);
      block.words = (block.words + 3) / 4 * 4;
      if (block.lanes != 0) carried.blocks.push_back(block);
    }
  }
  return carried;
}

uint64_t CarriedState::HeapBytes() const {
  uint64_t bytes =
      blocks.capacity() * sizeof(CarriedBlock) + runs.capacity() * sizeof(std::vector<CarriedRun>);
  for (const auto& of_stream : runs) bytes += of_stream.capacity() * sizeof(CarriedRun);
  return bytes;
}

}  // namespace pelt
