// Instances in draw order: one compact record per strand, gathered from wherever in the layer the
// order points. The renderer evaluates the curve (P(t) = c0 + t (c1 + t (c2 + t c3))) and widens
// it.
//
//   order   [ 7 | 3 | 130 | ... ]      piece i of the order holds places i * S .. i * S + S - 1
//   curves  record 7, record 3, ...    one 64-byte DMA element each
//
// Unsorted drawing needs no kernel: the `curves` stream is already a vertex buffer of instances in
// strand order, and the `order` stream its sorted 32-bit index buffer.
//
// Invariant: the whole piece is written; places behind the layer's visible_count are zero records.
#pragma once

#include "core/chunk.hpp"
#include "core/kernel.hpp"
#include "core/streams.hpp"

namespace pelt {

// Strands drawn from the piece that starts at `first_place`.
PELT_INLINE uint32_t CountDrawn(uint32_t visible_count, uint32_t first_place) {
  if (visible_count <= first_place) return 0;
  const uint32_t rest = visible_count - first_place;
  return rest < kStrandsPerChunk ? rest : kStrandsPerChunk;
}

template <class V>
struct WriteInstances {
  static constexpr std::string_view kName = "write_instances";
  struct Ports {
    In<&Streams::order> order;
    In<&Streams::chunk_state> state;
    Shared<&Streams::layer_sort> sort;
    Gather<&Streams::curves, &Streams::order> curves;
    Out<&Streams::instances> instances;
  };

  static void Run(const Ports& ports) {
    CurveRecord* out = ports.instances->instance;
    const uint32_t drawn = CountDrawn(ports.sort->visible_count, ports.state->first_place);
    for (uint32_t i = 0; i < drawn; ++i) CopyRecord<V>(&out[i], &ports.curves[i]);
    for (uint32_t i = drawn; i < kStrandsPerChunk; ++i) ClearRecord<V>(&out[i]);
  }
};

}  // namespace pelt
