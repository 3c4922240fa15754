// Compiled once, for any processor: frame_table.cpp, which is compiled for each instruction set,
// has only the addresses of these.
#include "core/kernels/frame_gates.hpp"

#include <algorithm>
#include <iterator>

namespace pelt::frame_gates {

template <uint32_t kChunkFlags>
bool HasFlags(const FrameMemory& memory, const ItemPlace& place) {
  const uint32_t flags =
      memory.Of<&Streams::chunk_state>(place.first[size_t(Domain::kChunk)])->flags;
  return (flags & kChunkFlags) == kChunkFlags;
}
template bool HasFlags<kChunkSkin>(const FrameMemory&, const ItemPlace&);
template bool HasFlags<kChunkSimulate>(const FrameMemory&, const ItemPlace&);
template bool HasFlags<kChunkFit>(const FrameMemory&, const ItemPlace&);
template bool HasFlags<kChunkKeys>(const FrameMemory&, const ItemPlace&);

bool IsBlown(const FrameMemory& memory, const ItemPlace& place) {
  const uint32_t layer = place.first[size_t(Domain::kLayer)];
  return HasFlags<kChunkSimulate>(memory, place) &&
         (memory.Of<&Streams::layers>(layer)->flags & kLayerWind) != 0;
}

bool IsBrushed(const FrameMemory& memory, const ItemPlace& place) {
  const uint32_t layer = place.first[size_t(Domain::kLayer)];
  return (memory.Of<&Streams::layers>(layer)->flags & kLayerBrushed) != 0 &&
         HasFlags<kChunkVisible>(memory, place);
}

bool IsLookedAt(const FrameMemory& memory, const ItemPlace& place) {
  return HasFlags<kChunkFit>(memory, place) || HasFlags<kChunkPainted>(memory, place);
}

bool HasPoseRates(const FrameMemory& memory, const ItemPlace& place) {
  return memory.Of<&Streams::pose_rates>(place.first[size_t(Domain::kCharacter)])->given != 0;
}

bool HasRootRates(const FrameMemory& memory, const ItemPlace& place) {
  const uint32_t layer = place.first[size_t(Domain::kLayer)];
  return HasFlags<kChunkSimulate>(memory, place) &&
         (memory.Of<&Streams::layers>(layer)->flags & kLayerRatesGiven) != 0;
}

bool IsRelit(const FrameMemory& memory, const ItemPlace& place) {
  const auto& layer = *memory.Of<&Streams::layers>(place.first[size_t(Domain::kLayer)]);
  const auto& palette = *memory.Of<&Streams::palette>(place.first[size_t(Domain::kCharacter)]);
  return (layer.flags & kLayerRelight) != 0 ||
         std::any_of(std::begin(palette.moved), std::end(palette.moved),
                     [](uint32_t joints) { return joints != 0; });
}

bool IsShifted(const FrameMemory& memory, const ItemPlace& place) {
  const uint32_t layer = place.first[size_t(Domain::kLayer)];
  const uint32_t flags =
      memory.Of<&Streams::chunk_state>(place.first[size_t(Domain::kChunk)])->flags;
  return (flags & kChunkVisible) && !(flags & kChunkRestart) &&
         memory.Of<&Streams::layer_origins>(layer)->shifted != 0;
}

bool IsResorted(const FrameMemory& memory, const ItemPlace& place) {
  return memory.Of<&Streams::layer_sort>(place.first[size_t(Domain::kLayer)])->keys_changed != 0;
}

bool IsRedrawn(const FrameMemory& memory, const ItemPlace& place) {
  const auto& sort = *memory.Of<&Streams::layer_sort>(place.first[size_t(Domain::kLayer)]);
  const uint32_t first =
      (place.first[size_t(Domain::kChunk)] - place.layer_first[size_t(Domain::kChunk)]) * kStrandsPerChunk;
  return first < sort.visible_count && (sort.keys_changed | sort.records_changed) != 0;
}

}  // namespace pelt::frame_gates
