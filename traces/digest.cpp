#include "traces/digest.hpp"

#include <algorithm>
#include <cstring>

namespace pelt {
namespace {

// Calls visit(element index) for every element in a live lane; stops when it returns false.
template <class Visit>
bool ForEachLive(const StreamDesc& stream, const RowDesc& row, uint32_t live_lanes, Visit visit) {
  const uint32_t lanes =
      stream.lanes.AllHoldValues() ? row.lane_count : std::min(row.lane_count, live_lanes);
  const uint32_t components = row.element_count / row.lane_count;
  if (row.lane_major) {
    for (uint32_t e = 0; e < lanes * components; ++e)
      if (!visit(e)) return false;
    return true;
  }
  for (uint32_t c = 0; c < components; ++c)
    for (uint32_t l = 0; l < lanes; ++l)
      if (!visit(c * row.lane_count + l)) return false;
  return true;
}

}  // namespace

uint32_t RowElement(const void* block, const RowDesc& row, uint32_t index) {
  const auto* bytes = static_cast<const uint8_t*>(block) + row.offset_bytes;
  switch (row.type) {
    case ElementType::kU8:
      return bytes[index];
    case ElementType::kU16: {
      uint16_t v;
      std::memcpy(&v, bytes + 2 * size_t(index), 2);
      return v;
    }
    default: {
      uint32_t v;
      std::memcpy(&v, bytes + 4 * size_t(index), 4);
      return v;
    }
  }
}

void AddBlock(Digest& digest, const StreamDesc& stream, const void* block, uint32_t live_lanes) {
  for (const RowDesc& row : stream.rows)
    ForEachLive(stream, row, live_lanes, [&](uint32_t e) {
      digest.Add(RowElement(block, row, e));
      return true;
    });
}

BlockDifference FindDifference(const StreamDesc& stream, const void* left, const void* right,
                               uint32_t live_lanes) {
  BlockDifference found;
  for (const RowDesc& row : stream.rows) {
    ForEachLive(stream, row, live_lanes, [&](uint32_t e) {
      const uint32_t a = RowElement(left, row, e), b = RowElement(right, row, e);
      if (a == b) return true;
      const uint32_t components = row.element_count / row.lane_count;
      const uint32_t lane = row.lane_major ? e / components : e % row.lane_count;
      const uint32_t component = row.lane_major ? e % components : e / row.lane_count;
      found = {true, &row, component, lane, a, b};
      return false;
    });
    if (found.differs) break;
  }
  return found;
}

void AddItem(Digest& digest, const FrameMemory& memory, Stream stream, uint32_t item) {
  const std::byte* block = memory.Block(stream, item);
  if (!block) return;
  const uint32_t lanes = memory.LiveLanes(stream, item);
  digest.Add(lanes);
  AddBlock(digest, (*memory.table)[stream], block, lanes);
}

uint64_t DigestStream(const FrameMemory& memory, Stream stream) {
  const StreamDesc& desc = (*memory.table)[stream];
  if (desc.role != Role::kValue) return 0;
  Digest digest;
  for (uint32_t i = 0; i < memory.shape->ItemCount(desc.domain); ++i)
    AddItem(digest, memory, stream, i);
  return digest.Value();
}

uint64_t DigestFrame(const FrameMemory& memory) {
  Digest digest;
  // A stream that the scene does not have counts for nothing, so that a new kind of stream leaves
  // the digests of other scenes alone.
  for (uint32_t s = 0; s < memory.streams.size(); ++s)
    if (memory.table->streams[s].role == Role::kValue && memory.streams[s].block_count != 0)
      digest.Add64(DigestStream(memory, Stream(s)));
  return digest.Value();
}

}  // namespace pelt
