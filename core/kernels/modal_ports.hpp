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
  Shared<Of::kTable> table;
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
  Shared<Of::kTable> table;
  InOut<&Streams::chunk_state> state;
  In<Of::kRest> rest;
  In<Of::kRoots> roots;
  In<&Streams::wind> wind;
  In<&Streams::strands> strands;
  InOut<Of::kModal> chain;
  InOut<Of::kPosition> position;
  In<&Streams::root_rates> rates;

  PELT_INLINE Ports<kPoints, kVertexChains> WithoutExtras() const {
    return {layer, table, state, rest, roots, wind, strands, chain, position};
  }
};

// Of sag-free layers: and which way was down at their roots when they were groomed.
template <uint32_t kPoints, bool kVertexChains>
struct HeldPorts {
  using Of = ChainStreams<kPoints, kVertexChains>;
  Shared<&Streams::layers> layer;
  Shared<Of::kTable> table;
  InOut<&Streams::chunk_state> state;
  In<Of::kRest> rest;
  In<Of::kRoots> roots;
  In<&Streams::wind> wind;
  In<&Streams::strands> strands;
  InOut<Of::kModal> chain;
  InOut<Of::kPosition> position;
  In<&Streams::rest_down> down;

  PELT_INLINE Ports<kPoints, kVertexChains> WithoutExtras() const {
    return {layer, table, state, rest, roots, wind, strands, chain, position};
  }
};

template <uint32_t kPoints, bool kVertexChains>
struct RatedHeldPorts {
  using Of = ChainStreams<kPoints, kVertexChains>;
  Shared<&Streams::layers> layer;
  Shared<Of::kTable> table;
  InOut<&Streams::chunk_state> state;
  In<Of::kRest> rest;
  In<Of::kRoots> roots;
  In<&Streams::wind> wind;
  In<&Streams::strands> strands;
  InOut<Of::kModal> chain;
  InOut<Of::kPosition> position;
  In<&Streams::rest_down> down;
  In<&Streams::root_rates> rates;

  PELT_INLINE Ports<kPoints, kVertexChains> WithoutExtras() const {
    return {layer, table, state, rest, roots, wind, strands, chain, position};
  }
};

// What some layers have besides; null where a layer has it not.
struct Extras {
  const RootRateBlock* rates;  // what is known of the roots between frames
  const DownBlock* down;
};

}  // namespace pelt::modal
