// What a modal kernel reads and writes of a chunk, for chains of strands and of mesh vertices.
//
// Invariant: the wind and the control strands are read only where the layer has them.
#pragma once

#include "core/kernel.hpp"
#include "core/modal/modal_block.hpp"
#include "core/streams.hpp"

namespace pelt::modal {

template <uint32_t kPoints, bool kVertexChains>
struct Ports {
  Shared<LayerBlock> layer;
  Shared<ModalTableBlock> table;
  InOut<ChunkStateBlock> state;
  In<RestBlock<kPoints>> rest;
  In<RootBlock> roots;
  In<WindBlock> wind;       // read only where the layer has kLayerWind
  In<StrandBlock> strands;  // control strands; read only where the layer has kLayerClump
  InOut<ModalStateBlock<kPoints>> chain;
  InOut<PointBlock<kPoints>> position;
};

template <uint32_t kPoints, bool kVertexChains>
constexpr auto MakePorts() {
  using P = Ports<kPoints, kVertexChains>;
  constexpr bool kV = kVertexChains, kFour = kPoints == 4;
  static_assert(!kV || kFour);
  return PortList(
      Port<&P::layer>(Stream::kLayers, "layer"), Port<&P::table>(Stream::kModalTables, "table"),
      Port<&P::state>(Stream::kChunkState, "state"),
      Port<&P::rest>(kV      ? Stream::kVertexRest
                     : kFour ? Stream::kStrandRest4
                             : Stream::kStrandRest5,
                     "rest"),
      Port<&P::roots>(kV ? Stream::kAnchors : Stream::kRoots, "roots"),
      Port<&P::wind>(Stream::kWind, "wind"), Port<&P::strands>(Stream::kStrands, "strands"),
      Port<&P::chain>(kV      ? Stream::kVertexModal
                      : kFour ? Stream::kStrandModal4
                              : Stream::kStrandModal5,
                      "chain"),
      Port<&P::position>(kV      ? Stream::kVertexPoints
                         : kFour ? Stream::kStrandPoints4
                                 : Stream::kStrandPoints5,
                         "position"));
}

}  // namespace pelt::modal
