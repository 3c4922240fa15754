#include "core/streams.hpp"

#include <algorithm>

#include "core/block_rows.hpp"
#include "core/float_rules.hpp"
#include "core/frame_memory.hpp"

namespace pelt {

namespace streams_detail {

uint32_t CountStrands(const FrameMemory& memory, uint32_t chunk) {
  return memory.Of<&Streams::chunk_state>(chunk)->live_strands;
}
uint32_t CountVertices(const FrameMemory& memory, uint32_t patch) {
  return memory.Of<&Streams::patch_state>(patch)->live_vertices;
}
uint32_t CountLiveChains(const FrameMemory& memory, uint32_t patch) {
  return memory.Of<&Streams::patch_state>(patch)->live_chains;
}
uint32_t CountFollowing(const FrameMemory& memory, uint32_t patch) {
  const ChunkStateBlock& state = *memory.Of<&Streams::patch_state>(patch);
  return state.whole_chains < state.live_vertices ? state.live_vertices : 0;
}
uint32_t CountPlaces(const FrameMemory& memory, uint32_t chunk) {
  const SceneShape& shape = *memory.shape;
  const uint32_t layer = shape.chunk_layer[chunk];
  const uint32_t visible = memory.Of<&Streams::layer_sort>(layer)->visible_count;
  const uint32_t first = (chunk - shape.layer_first_chunk[layer]) * kStrandsPerChunk;
  return visible > first ? std::min(visible - first, kStrandsPerChunk) : 0;
}
// In strand order no stage writes them.
uint32_t CountInDrawOrder(const FrameMemory& memory, uint32_t chunk) {
  return memory.marks & kInStrandOrder ? 0 : CountPlaces(memory, chunk);
}
uint32_t CountInEitherOrder(const FrameMemory& memory, uint32_t chunk) {
  return memory.marks & kInStrandOrder ? CountStrands(memory, chunk) : CountPlaces(memory, chunk);
}

}  // namespace streams_detail

VertexPlace FindVertex(const FrameMemory& memory, uint32_t chunk, uint32_t corner) {
  const SceneShape& shape = *memory.shape;
  const uint32_t place = memory.Of<&Streams::halo>(chunk)->vertex[corner];
  return {shape.layer_first_patch[shape.chunk_layer[chunk]] + place / kVerticesPerChunk,
          place % kVerticesPerChunk};
}

// The one of this build: see core/chunk.hpp.
const char PELT_CAPACITY_SYMBOL(PELT_CHUNK_STRANDS) = 0;

template <>
const StreamTable& TableOf<Streams>() {
  return MakeTable<Streams>();
}

}  // namespace pelt
