// Compiled once, for any processor: frame_table.cpp, which is compiled for each instruction set,
// has only the addresses of these.
#include "core/kernels/frame_gates.hpp"

#include <algorithm>
#include <iterator>

namespace pelt::frame_gates {

namespace {

template <Domain kDomain>
uint32_t FlagsOf(const FrameMemory& memory, const ItemPlace& place) {
  constexpr auto kState = kDomain == kPatch ? &Streams::patch_state : &Streams::chunk_state;
  return memory.Of<kState>(place.first[size_t(kDomain)])->flags;
}

}  // namespace

template <Domain kDomain, uint32_t kFlags>
bool HasFlags(const FrameMemory& memory, const ItemPlace& place) {
  return (FlagsOf<kDomain>(memory, place) & kFlags) == kFlags;
}
template bool HasFlags<kPatch, kChunkSkin>(const FrameMemory&, const ItemPlace&);
template bool HasFlags<kPatch, kChunkSimulate>(const FrameMemory&, const ItemPlace&);
template bool HasFlags<kPatch, kChunkFit>(const FrameMemory&, const ItemPlace&);
template bool HasFlags<kChunk, kChunkSkin>(const FrameMemory&, const ItemPlace&);
template bool HasFlags<kChunk, kChunkSimulate>(const FrameMemory&, const ItemPlace&);
template bool HasFlags<kChunk, kChunkFit>(const FrameMemory&, const ItemPlace&);
template bool HasFlags<kChunk, kChunkKeys>(const FrameMemory&, const ItemPlace&);

template <Domain kDomain>
bool IsBlown(const FrameMemory& memory, const ItemPlace& place) {
  const uint32_t layer = place.first[size_t(Domain::kLayer)];
  return HasFlags<kDomain, kChunkSimulate>(memory, place) &&
         (memory.Of<&Streams::layers>(layer)->flags & kLayerWind) != 0;
}
template bool IsBlown<kPatch>(const FrameMemory&, const ItemPlace&);
template bool IsBlown<kChunk>(const FrameMemory&, const ItemPlace&);

bool IsBrushed(const FrameMemory& memory, const ItemPlace& place) {
  const uint32_t layer = place.first[size_t(Domain::kLayer)];
  return (memory.Of<&Streams::layers>(layer)->flags & kLayerBrushed) != 0 &&
         HasFlags<kChunk, kChunkVisible>(memory, place);
}

bool IsLookedAt(const FrameMemory& memory, const ItemPlace& place) {
  return HasFlags<kChunk, kChunkFit>(memory, place) ||
         HasFlags<kChunk, kChunkPainted>(memory, place);
}

bool HasPoseRates(const FrameMemory& memory, const ItemPlace& place) {
  return memory.Of<&Streams::pose_rates>(place.first[size_t(Domain::kCharacter)])->given != 0;
}

template <Domain kDomain, uint32_t kFlags>
bool HasRates(const FrameMemory& memory, const ItemPlace& place) {
  const uint32_t layer = place.first[size_t(Domain::kLayer)];
  return HasFlags<kDomain, kFlags>(memory, place) &&
         (memory.Of<&Streams::layers>(layer)->flags & kLayerRatesGiven) != 0;
}
template bool HasRates<kPatch, kChunkSimulate>(const FrameMemory&, const ItemPlace&);
template bool HasRates<kPatch, kChunkVisible>(const FrameMemory&, const ItemPlace&);
template bool HasRates<kChunk, kChunkSimulate>(const FrameMemory&, const ItemPlace&);

bool IsRelit(const FrameMemory& memory, const ItemPlace& place) {
  const auto& layer = *memory.Of<&Streams::layers>(place.first[size_t(Domain::kLayer)]);
  const auto& palette = *memory.Of<&Streams::palette>(place.first[size_t(Domain::kCharacter)]);
  return (layer.flags & kLayerRelight) != 0 ||
         std::any_of(std::begin(palette.moved), std::end(palette.moved),
                     [](uint32_t joints) { return joints != 0; });
}

template <Domain kDomain>
bool IsShifted(const FrameMemory& memory, const ItemPlace& place) {
  const uint32_t layer = place.first[size_t(Domain::kLayer)];
  const uint32_t flags = FlagsOf<kDomain>(memory, place);
  return (flags & kChunkVisible) && !(flags & kChunkRestart) &&
         memory.Of<&Streams::layer_origins>(layer)->shifted != 0;
}
template bool IsShifted<kPatch>(const FrameMemory&, const ItemPlace&);
template bool IsShifted<kChunk>(const FrameMemory&, const ItemPlace&);

bool IsResorted(const FrameMemory& memory, const ItemPlace& place) {
  return memory.Of<&Streams::layer_sort>(place.first[size_t(Domain::kLayer)])->keys_changed != 0;
}

bool IsRedrawn(const FrameMemory& memory, const ItemPlace& place) {
  const auto& sort = *memory.Of<&Streams::layer_sort>(place.first[size_t(Domain::kLayer)]);
  const uint32_t first =
      (place.first[size_t(kChunk)] - place.layer_first[size_t(kChunk)]) * kStrandsPerChunk;
  return first < sort.visible_count && (sort.keys_changed | sort.records_changed) != 0;
}

}  // namespace pelt::frame_gates
