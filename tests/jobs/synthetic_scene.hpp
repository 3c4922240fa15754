// A scene made by hand: layers of given kinds and sizes over the streams of a table, filled from a
// seed, without character, groom or fur kernels. What it is for: tests of plan and executors that
// run kernels of their own.
//
// Every stream's blocks stand in one piece of memory, with a spare block behind each stream, so
// that a kernel planted to run off its block hits memory of this scene and nothing else.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <string_view>
#include <vector>

#include "core/kernel.hpp"
#include "core/random.hpp"
#include "jobs/frame.hpp"
#include "jobs/plan.hpp"
#include "tests/jobs/toys.hpp"
#include "traces/digest.hpp"

namespace pelt::testing {

struct LayerSpec {
  uint32_t character;
  uint32_t kind;
  uint32_t chunks;
  uint32_t patches = 0;
};

inline SceneShape MakeShape(const std::vector<LayerSpec>& layers) {
  SceneShape shape;
  for (const LayerSpec& layer : layers)
    shape.AddLayer(layer.character, layer.kind, layer.chunks, layer.patches);
  return shape;
}

template <class Table>
class SyntheticSceneOf {
 public:
  explicit SyntheticSceneOf(const std::vector<LayerSpec>& layers, uint64_t seed = 1)
      : shape_(MakeShape(layers)), memory_(PlaceStreams(TableOf<Table>(), shape_, nullptr)) {
    std::vector<size_t> offsets;
    size_t bytes = 0;
    for (uint32_t s = 0; s < memory_.streams.size(); ++s) {
      offsets.push_back(bytes);
      bytes += size_t(memory_.streams[s].block_count + 1) * Describe(s).block_bytes;
    }
    bytes_.resize(bytes + 2 * kBlockAlignment);
    auto* aligned =
        bytes_.data() + (2 * kBlockAlignment - uintptr_t(bytes_.data()) % kBlockAlignment);
    for (uint32_t s = 0; s < memory_.streams.size(); ++s)
      memory_.streams[s].base = aligned + offsets[s];
    Fill(seed);
  }
  SyntheticSceneOf(const SyntheticSceneOf&) = delete;

  const SceneShape& shape() const { return shape_; }
  FrameMemory& memory() { return memory_; }
  template <auto kMember>
  auto& Of(uint32_t item) {
    return *memory_.template Of<kMember>(item);
  }

  // Floats in [-1, 1), integers of any bits. Toys: every gate open, every lane alive, places of a
  // layer one behind the other, every chunk names all patches of its layer.
  void Fill(uint64_t seed) {
    Random random(seed);
    for (uint32_t s = 0; s < memory_.streams.size(); ++s)
      for (uint32_t b = 0; b <= memory_.streams[s].block_count; ++b)
        for (const RowDesc& row : Describe(s).rows)
          FillRow(random, row, memory_.streams[s].base + size_t(b) * Describe(s).block_bytes);
    if constexpr (std::is_same_v<Table, Toys>)
      for (uint32_t c = 0; c < shape_.chunk_count; ++c) {
        const uint32_t layer = shape_.chunk_layer[c];
        *memory_.template Of<&Toys::state>(c) = {
            ~0u, (c - shape_.layer_first_chunk[layer]) * kToyLanes, kToyLanes};
        ListBlock& list = *memory_.template Of<&Toys::list>(c);
        for (uint32_t i = 0; i < kToyListed; ++i)
          list.patch[i] = i < shape_.LayerPatches(layer) ? i : ~0u;
      }
  }

  // Of every row of every block of these streams.
  uint64_t DigestOf(std::initializer_list<Stream> streams) const {
    Digest digest;
    for (const Stream s : streams) {
      const StreamPlace& place = memory_.streams[size_t(s)];
      const StreamDesc& desc = Describe(uint32_t(s));
      for (uint32_t b = 0; b < place.block_count; ++b)
        AddBlock(digest, desc, place.base + size_t(b) * desc.block_bytes, Table::kChunkLanes);
    }
    return digest.Value();
  }

 private:
  static const StreamDesc& Describe(uint32_t stream) { return TableOf<Table>().streams[stream]; }

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
  FrameMemory memory_;
  std::vector<std::byte> bytes_;
};
using SyntheticScene = SyntheticSceneOf<Toys>;

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
template <class K>
Stage Chunk(Gate gate = {}, KindMask kinds = {}) {
  return MakeStage<K>(Domain::kChunk, gate, kinds);
}

// A kernel of this name that does nothing: it has these ports.
template <size_t kLength>
struct KernelName {
  char text[kLength];
  constexpr KernelName(const char (&name)[kLength]) { std::copy_n(name, kLength, text); }
};
template <class... Port>
struct PortsOf;
template <class A>
struct PortsOf<A> {
  A a;
};
template <class A, class B>
struct PortsOf<A, B> {
  A a;
  B b;
};
template <class A, class B, class C>
struct PortsOf<A, B, C> {
  A a;
  B b;
  C c;
};
template <KernelName kText, class... Port>
struct Declares {
  static constexpr std::string_view kName{kText.text};
  using Ports = PortsOf<Port...>;
  static void Run(const Ports&) {}
};

// Put 7 first in what only long layers have.
struct UseVertexPoints {
  static constexpr std::string_view kName = "use_vertex_points";
  struct Ports {
    InOut<&Toys::of_long> points;
  };
  static void Run(const Ports& ports) { ports.points->a[0][0] = 7.0f; }
};
struct UseLongParts {
  static constexpr std::string_view kName = "use_long_parts";
  struct Ports {
    InOut<&Toys::long_parts> parts;
  };
  static void Run(const Ports& ports) { ports.parts->a[0][0] = 7.0f; }
};

}  // namespace pelt::testing
