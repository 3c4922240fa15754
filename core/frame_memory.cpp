#include "core/frame_memory.hpp"

#include <algorithm>

namespace pelt {

uint32_t CountBlocks(const StreamDesc& stream, const SceneShape& shape) {
  const auto admits = [&](uint32_t kind) { return stream.kinds.Admits(kind); };
  if (!IsInLayer(stream.domain)) {
    const bool every = (stream.kinds.required | stream.kinds.forbidden) == 0;
    const bool any = every || std::any_of(shape.layer_kind.begin(), shape.layer_kind.end(), admits);
    return any ? shape.ItemCount(stream.domain) : 0;
  }
  uint32_t count = 0;
  for (uint32_t l = 0; l < shape.layer_count; ++l)
    if (admits(shape.layer_kind[l])) count += shape.LayerItems(stream.domain, l);
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
    const uint32_t items = shape.ItemCount(stream.domain);
    if (place.block_count == items) continue;
    place.slot.assign(items, kNoBlock);
    if (place.block_count == 0) continue;
    uint32_t next = 0;
    for (uint32_t i = 0; i < items; ++i)
      if (stream.kinds.Admits(shape.layer_kind[shape.LayerOf(stream.domain, i)]))
        place.slot[i] = next++;
  }
  return placed;
}

}  // namespace pelt
