// Where every block of a frame lies: the streams of a table, for the items of a scene.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/stream_table.hpp"

namespace pelt {

inline constexpr uint32_t kNoBlock = ~0u;

// What is in the scene and what belongs to what. Patches and chunks of a layer, and layers of a
// character, are contiguous.
struct SceneShape {
  uint32_t character_count = 0;
  uint32_t layer_count = 0;
  uint32_t patch_count = 0;
  uint32_t chunk_count = 0;
  std::vector<uint32_t> layer_character;
  std::vector<uint32_t> layer_first_patch = {0};  // layer_count + 1 entries
  std::vector<uint32_t> layer_first_chunk = {0};  // likewise
  std::vector<uint32_t> layer_kind;
  std::vector<uint32_t> patch_layer;
  std::vector<uint32_t> chunk_layer;

  // Behind all others; of the last character, or a new one.
  void AddLayer(uint32_t character, uint32_t kind, uint32_t chunks, uint32_t patches = 0) {
    character_count = std::max(character_count, character + 1);
    layer_character.push_back(character);
    layer_kind.push_back(kind);
    patch_layer.insert(patch_layer.end(), patches, layer_count);
    chunk_layer.insert(chunk_layer.end(), chunks, layer_count++);
    patch_count += patches;
    chunk_count += chunks;
    layer_first_patch.push_back(patch_count);
    layer_first_chunk.push_back(chunk_count);
  }
  uint32_t ItemCount(Domain domain) const {
    const uint32_t counts[] = {1, character_count, layer_count, patch_count, chunk_count};
    return counts[size_t(domain)];
  }
  // Of a layer, or of what is in one: the layer.
  uint32_t LayerOf(Domain domain, uint32_t item) const {
    return domain == Domain::kChunk   ? chunk_layer[item]
           : domain == Domain::kPatch ? patch_layer[item]
                                      : item;
  }
  // Of patches or chunks: the layer's first one, and how many it has.
  uint32_t LayerFirst(Domain domain, uint32_t layer) const {
    return (domain == Domain::kPatch ? layer_first_patch : layer_first_chunk)[layer];
  }
  uint32_t LayerItems(Domain domain, uint32_t layer) const {
    return LayerFirst(domain, layer + 1) - LayerFirst(domain, layer);
  }
  uint32_t LayerPatches(uint32_t layer) const { return LayerItems(Domain::kPatch, layer); }
  uint32_t LayerChunks(uint32_t layer) const { return LayerItems(Domain::kChunk, layer); }
  friend bool operator==(const SceneShape&, const SceneShape&) = default;
};

// Where an item stands: of each domain, the first item and how many. Of the item's own and coarser
// ones it is the one that it is or belongs to; of finer ones, those inside the scene or layer.
struct ItemPlace {
  uint32_t first[kDomainCount];
  uint32_t count[kDomainCount];
  uint32_t layer_first[kDomainCount];  // of patches and chunks: the first of the item's layer
};

struct StreamPlace {
  std::byte* base = nullptr;
  uint32_t block_count = 0;
  // Of each item its block's number, or kNoBlock where its layer has no such stream; empty: item i
  // has block i.
  std::vector<uint32_t> slot;
};

struct FrameMemory {
  const StreamTable* table = nullptr;
  const SceneShape* shape = nullptr;
  std::vector<StreamPlace> streams;  // as in the table
  // Decided before the frame. Of each item of a domain, not 0: it is held, and stages of
  // FrameGate::kNotHeld leave it out; null: none is.
  const uint8_t* held[kDomainCount] = {};
  bool paused = false;    // a frame of no time: only what depends on the view is done
  bool restored = false;  // state was put back before this frame: what follows from it is not there
  // From the parameters of one character's stages to those of the next one's, bytes: 0 where all have
  // the same. Those of a stage of the scene are the first's.
  uint64_t params_step = 0;
  uint32_t marks = 0;  // the scene's own, for its conditions and lane counts

  // First byte of the block that `item` of the stream's own domain has; null if it has none.
  std::byte* Block(Stream stream, uint32_t item) const {
    return Block(stream, (*table)[stream].block_bytes, item);
  }
  std::byte* Block(Stream stream, uint32_t block_bytes, uint32_t item) const {
    const StreamPlace& place = streams[size_t(stream)];
    const uint32_t at = place.slot.empty() ? item : place.slot[item];
    return at == kNoBlock ? nullptr : place.base + size_t(at) * block_bytes;
  }
  // The same, of a stream that is known here: its block.
  template <auto kRow>
  BlockOf<kRow>* Of(uint32_t item) const {
    return reinterpret_cast<BlockOf<kRow>*>(Block(StreamOf<kRow>, sizeof(BlockOf<kRow>), item));
  }
  template <class T>
  T* As(Stream stream, uint32_t item) const {
    return reinterpret_cast<T*>(Block(stream, item));
  }
  // Lanes of the block of `item` that hold values of the last frame run.
  uint32_t LiveLanes(Stream stream, uint32_t item) const {
    const Lanes& lanes = (*table)[stream].lanes;
    return lanes.AllHoldValues() ? table->chunk_lanes : lanes.count(*this, item);
  }
};

// Blocks of a stream: patches and chunks of layers that lack it have none. Layers, characters and the scene have
// all, or, where no layer is of its kind, none.
uint32_t CountBlocks(const StreamDesc& stream, const SceneShape& shape);
uint64_t CountBytes(const StreamTable& table, const SceneShape& shape);
// All streams back to back from `memory` on, which holds CountBytes of them, aligned to
// kBlockAlignment. Table and shape must outlive what is returned.
FrameMemory PlaceStreams(const StreamTable& table, const SceneShape& shape, std::byte* memory);

}  // namespace pelt
