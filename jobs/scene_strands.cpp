// What the engine sets of single strands: which of them are cut off, and values in place of the groom's.
//
// Both follow from the frame's input alone, and what a frame does not name is as the groom has it: so nothing of
// them has to be taken along by a snapshot. What changes wakes the chunk that it is in, and no other.
#include <cstring>

#include "core/format.hpp"
#include "jobs/scene.hpp"

namespace pelt {
namespace {

static_assert(sizeof(StrandWrite) == 24, "without padding: lists are compared by their bytes");

// What the strand has, which gets what is written.
StrandWrite Exchange(StrandBlock& strands, const StrandWrite& write) {
  const uint32_t lane = write.strand % kStrandsPerChunk;
  const StrandWrite before{write.layer,
                           write.strand,
                           strands.base_colour[lane],
                           strands.tip_colour[lane],
                           strands.width[lane],
                           strands.film_strip[lane]};
  strands.base_colour[lane] = write.base_colour;
  strands.tip_colour[lane] = write.tip_colour;
  strands.width[lane] = write.width;
  strands.film_strip[lane] = uint8_t(write.film_strip);
  return before;
}

}  // namespace

// Null where there is no such strand.
const StrandBlock* FurScene::BlockOf(const StrandWrite& write) const {
  if (write.layer >= shape().layer_count || (shape().layer_kind[write.layer] & kLayerShells) ||
      write.strand >= StrandPlaces(write.layer))
    return nullptr;
  const StrandBlock* const strands = memory_.Of<&Streams::strands>(ChunkOf(write));
  return write.strand % kStrandsPerChunk < strands->strand_count ? strands : nullptr;
}

const char* FurScene::FindStrandFault(const FrameInput& in) {
  fault_.clear();
  const size_t places = size_t(kStrandsPerChunk) * shape().chunk_count;
  if (!in.cut.empty() && in.cut.size() != places)
    FormatTo(fault_, "cut of {} places of strands, the scene has {}", in.cut.size(), places);
  else if (in.strands.size() > options_.strand_writes)
    FormatTo(fault_, "{} strands are written, the scene was made for {} (strand_writes)",
             in.strands.size(), options_.strand_writes);
  for (size_t i = 0; i < in.strands.size() && fault_.empty(); ++i) {
    const StrandWrite& write = in.strands[i];
    if (!BlockOf(write))
      FormatTo(fault_, "strand write {}: layer {} has no strand {}", i, write.layer, write.strand);
    else if (!(write.width >= 0.0f && write.width <= kWidestWrite))
      FormatTo(fault_, "strand write {}: its width is {}, not in [0, {}] m", i, write.width,
               kWidestWrite);
    else if (write.film_strip > 255)
      FormatTo(fault_, "strand write {}: its film strip is {}, not below 256", i, write.film_strip);
  }
  return fault_.empty() ? nullptr : fault_.c_str();
}

void FurScene::CutStrands(std::span<const uint8_t> cut) {
  if (cut.empty() && !is_cut_) return;
  is_cut_ = !cut.empty();
  for (uint32_t c = 0; c < shape().chunk_count; ++c) {
    ChunkStateBlock& state = *memory_.Of<&Streams::chunk_state>(c);
    decltype(state.cut) bits = {};
    for (uint32_t lane = 0; lane < kStrandsPerChunk && is_cut_; ++lane)
      bits[lane / 32] |= uint32_t(cut[size_t(c) * kStrandsPerChunk + lane] != 0) << lane % 32;
    if (std::memcmp(bits, state.cut, sizeof bits) == 0) continue;
    std::memcpy(state.cut, bits, sizeof bits);
    state.state_changed = 1;
  }
}

void FurScene::WriteStrands(std::span<const StrandWrite> writes) {
  if (writes.size() == written_.size() &&
      (writes.empty() || std::memcmp(writes.data(), written_.data(), writes.size_bytes()) == 0))
    return;
  const auto put = [this](const StrandWrite& write) {
    memory_.Of<&Streams::chunk_state>(ChunkOf(write))->state_changed = 1;
    return Exchange(*memory_.Of<&Streams::strands>(ChunkOf(write)), write);
  };
  for (size_t i = replaced_.size(); i-- > 0;) put(replaced_[i]);
  written_.assign(writes.begin(), writes.end());
  replaced_.clear();
  for (const StrandWrite& write : writes) replaced_.push_back(put(write));
}

}  // namespace pelt
