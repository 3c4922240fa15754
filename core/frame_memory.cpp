#include "core/frame_memory.hpp"

namespace pelt {

uint32_t CountBlocks(const StreamDesc& stream, const SceneShape& shape) {
  if (stream.domain != Domain::kChunk) return shape.ItemCount(stream.domain);
  uint32_t count = 0;
  for (uint32_t l = 0; l < shape.layer_count; ++l)
    if (stream.kinds.Admits(shape.layer_kind[l])) count += shape.LayerChunks(l);
  return count;
}

uint64_t CountBytes(const StreamTable& table, const SceneShape& shape) {
  uint64_t bytes = 0;
  for (const StreamDesc& stream : table.streams)
    bytes += uint64_t(CountBlocks(stream, shape)) * stream.block_bytes;
  return bytes;
}

FrameMemory PlaceStreams(const StreamTable& table, const SceneShape& shape, std::byte* memory) {
  FrameMemory placed{&table, &shape, {}};
  for (const StreamDesc& stream : table.streams) {
    StreamPlace& place = placed.streams.emplace_back();
    place.base = memory;
    place.block_count = CountBlocks(stream, shape);
    if (memory) memory += size_t(place.block_count) * stream.block_bytes;
    if (stream.domain != Domain::kChunk || place.block_count == shape.chunk_count) continue;
    place.slot.assign(shape.chunk_count, kNoBlock);
    uint32_t next = 0;
    for (uint32_t c = 0; c < shape.chunk_count; ++c)
      if (stream.kinds.Admits(shape.layer_kind[shape.chunk_layer[c]])) place.slot[c] = next++;
  }
  return placed;
}

}  // namespace pelt
