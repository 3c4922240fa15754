// What a modal kernel reads and writes of a chunk, for chains of strands and of mesh vertices.
//
// Invariant: the wind and the control strands are read only where the layer has them.
#pragma once

#include "core/kernel.hpp"
#include "core/streams.hpp"

namespace pelt::modal {

template <uint32_t kPoints, bool kVertexChains>
struct Ports {
  using Of = ChainStreams<kPoints, kVertexChains>;
  Shared<&Streams::layers> layer;
  Shared<&Streams::modal_tables> table;
  InOut<&Streams::chunk_state> state;
  In<Of::kRest> rest;
  In<Of::kRoots> roots;
  In<&Streams::wind> wind;        // read only where the layer has kLayerWind
  In<&Streams::strands> strands;  // control strands; read only where the layer has kLayerClump
  InOut<Of::kModal> chain;
  InOut<Of::kPosition> position;
};

// The same and the roots' velocities, which are read only in frames that have them.
template <uint32_t kPoints, bool kVertexChains>
struct RatedPorts {
  using Of = ChainStreams<kPoints, kVertexChains>;
  Shared<&Streams::layers> layer;
  Shared<&Streams::modal_tables> table;
  InOut<&Streams::chunk_state> state;
  In<Of::kRest> rest;
  In<Of::kRoots> roots;
  In<&Streams::wind> wind;
  In<&Streams::strands> strands;
  InOut<Of::kModal> chain;
  InOut<Of::kPosition> position;
  In<&Streams::root_rates> rates;

  PELT_INLINE Ports<kPoints, kVertexChains> WithoutRates() const {
    return {layer, table, state, rest, roots, wind, strands, chain, position};
  }
};

}  // namespace pelt::modal
