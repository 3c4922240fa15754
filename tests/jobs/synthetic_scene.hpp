// A scene made by hand: layers of given kinds and sizes over the real streams, filled from a seed,
// without character, groom or fur kernels. What it is for: tests of plan and executors that run
// kernels of their own.
//
// Every stream's blocks stand in one piece of memory, with a spare block behind each stream, so
// that a kernel planted to run off its block hits memory of this scene and nothing else.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <vector>

#include "core/chunk.hpp"
#include "core/random.hpp"
#include "core/streams.hpp"
#include "jobs/frame.hpp"
#include "jobs/plan.hpp"
#include "traces/digest.hpp"

namespace pelt::testing {

struct LayerSpec {
  uint32_t character;
  uint32_t kind;  // kLayerKindFlags bits, kLayerSortInPieces
  uint32_t chunks;
};

inline SceneShape MakeShape(const std::vector<LayerSpec>& layers) {
  SceneShape shape;
  for (const LayerSpec& layer : layers) {
    shape.character_count = std::max(shape.character_count, layer.character + 1);
    shape.layer_character.push_back(layer.character);
    shape.layer_kind.push_back(layer.kind);
    shape.layer_first_chunk.push_back(shape.chunk_count);
    shape.chunk_layer.insert(shape.chunk_layer.end(), layer.chunks, shape.layer_count++);
    shape.chunk_count += layer.chunks;
  }
  shape.layer_first_chunk.push_back(shape.chunk_count);
  return shape;
}

class SyntheticScene {
 public:
  explicit SyntheticScene(const std::vector<LayerSpec>& layers, uint64_t seed = 1)
      : shape_(MakeShape(layers)), slots_(kStreamCount) {
    size_t bytes = kBlockAlignment;
    for (uint32_t s = 0; s < kStreamCount; ++s) bytes += PlaceStream(s, bytes);
    bytes_.resize(bytes + kBlockAlignment);
    auto* aligned = bytes_.data() + (kBlockAlignment - uintptr_t(bytes_.data()) % kBlockAlignment);
    memory_.shape = &shape_;
    for (uint32_t s = 0; s < kStreamCount; ++s) memory_.base[s] = aligned + offset_[s];
    Fill(seed);
  }
  SyntheticScene(const SyntheticScene&) = delete;

  const SceneShape& shape() const { return shape_; }
  const FrameMemory& memory() const { return memory_; }
  template <class T>
  T& Block(Stream stream, uint32_t item) {
    return *memory_.As<T>(stream, item);
  }

  // Floats in [-1, 1), integers of any bits; chunk places as a baked scene has them; every gate
  // open.
  void Fill(uint64_t seed) {
    Random random(seed);
    for (uint32_t s = 0; s < kStreamCount; ++s) {
      const StreamDesc& desc = DescribeStream(Stream(s));
      for (uint32_t b = 0; b <= memory_.block_count[s]; ++b)
        for (const RowDesc& row : desc.rows)
          FillRow(random, row, memory_.base[s] + size_t(b) * desc.block_bytes);
    }
    for (uint32_t c = 0; c < shape_.chunk_count; ++c) {
      auto& state = Block<ChunkStateBlock>(StreamOf<&Streams::chunk_state>, c);
      state.flags = ~0u;
      state.live_strands = state.live_vertices = kStrandsPerChunk;
      state.first_place = (c - shape_.layer_first_chunk[shape_.chunk_layer[c]]) * kStrandsPerChunk;
    }
    for (uint32_t l = 0; l < shape_.layer_count; ++l) {
      Block<LayerBlock>(StreamOf<&Streams::layers>, l).flags = ~0u;
      Block<LayerSortBlock>(StreamOf<&Streams::layer_sort>, l) = {
          shape_.LayerChunks(l) * kStrandsPerChunk, 1, 1, {}};
    }
  }

  // Of every row of every block of these streams.
  uint64_t DigestOf(std::initializer_list<Stream> streams) const {
    Digest digest;
    for (Stream s : streams) {
      const StreamDesc& desc = DescribeStream(s);
      for (uint32_t b = 0; b < memory_.block_count[size_t(s)]; ++b)
        AddBlock(digest, desc, memory_.base[size_t(s)] + size_t(b) * desc.block_bytes,
                 kStrandsPerChunk);
    }
    return digest.Value();
  }

 private:
  // Returns the bytes taken, the spare block included.
  size_t PlaceStream(uint32_t s, size_t at) {
    const StreamDesc& desc = DescribeStream(Stream(s));
    offset_[s] = at;
    uint32_t blocks = shape_.ItemCount(desc.domain);
    if (desc.domain == Domain::kChunk && (desc.kinds.required | desc.kinds.forbidden) != 0) {
      blocks = 0;
      slots_[s].assign(shape_.chunk_count, kNoBlock);
      for (uint32_t c = 0; c < shape_.chunk_count; ++c)
        if (desc.kinds.Admits(shape_.layer_kind[shape_.chunk_layer[c]])) slots_[s][c] = blocks++;
      memory_.slot[s] = slots_[s].data();
    }
    memory_.block_count[s] = blocks;
    return size_t(blocks + 1) * desc.block_bytes;
  }

  static void FillRow(Random& random, const RowDesc& row, std::byte* block) {
    std::byte* at = block + row.offset_bytes;
    for (uint32_t e = 0; e < row.element_count; ++e) {
      if (row.type == ElementType::kFloat) {
        const auto value = float(random.Uniform(-1.0, 1.0));
        std::memcpy(at + 4 * size_t(e), &value, 4);
      } else {
        const uint32_t value = random.U32();
        const size_t size = row.type == ElementType::kU8    ? 1
                            : row.type == ElementType::kU16 ? 2
                                                            : 4;
        for (size_t i = 0; i < size; ++i) at[size * e + i] = std::byte(value >> (8 * i));
      }
    }
  }

  SceneShape shape_;
  std::vector<std::vector<uint32_t>> slots_;
  size_t offset_[kStreamCount] = {};
  FrameMemory memory_{};
  std::vector<std::byte> bytes_;
};

// A stage of kernel K, with its parameters if it has some, which must outlive every plan made of
// it.
template <class K>
requires requires { typename K::Params; }
Stage MakeStage(Domain domain, const typename K::Params& params, Gate gate = {},
                KindMask kinds = {}) {
  return {MakeKernelDesc<K>(), &params, domain, gate, kinds};
}
template <class K>
Stage MakeStage(Domain domain, Gate gate = {}, KindMask kinds = {}) {
  return {MakeKernelDesc<K>(), nullptr, domain, gate, kinds};
}

}  // namespace pelt::testing
