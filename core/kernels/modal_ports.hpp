// What a modal kernel reads and writes of a chunk, or of a patch: chains of mesh vertices have no control
// strands, and what the strands take of them is their state (chain_loads.hpp) and no points.
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
  InOut<Of::kState> state;
  In<Of::kRest> rest;
  In<Of::kRoots> roots;
  In<Of::kWind> wind;             // read only where the layer has kLayerWind
  In<&Streams::strands> strands;  // control strands; read only where the layer has kLayerClump
  InOut<Of::kModal> chain;
  InOut<Of::kPosition> position;
};

template <>
struct Ports<4, true> {
  using Of = ChainStreams<4, true>;
  Shared<&Streams::layers> layer;
  Shared<Of::kTable> table;
  InOut<Of::kState> state;
  In<Of::kRest> rest;
  In<Of::kRoots> roots;
  In<Of::kWind> wind;
  InOut<Of::kModal> chain;
};

// The same and the roots' velocities, which are read only in frames that have them.
template <uint32_t kPoints, bool kVertexChains>
struct RatedPorts {
  using Of = ChainStreams<kPoints, kVertexChains>;
  Shared<&Streams::layers> layer;
  Shared<Of::kTable> table;
  InOut<Of::kState> state;
  In<Of::kRest> rest;
  In<Of::kRoots> roots;
  In<Of::kWind> wind;
  In<&Streams::strands> strands;
  InOut<Of::kModal> chain;
  InOut<Of::kPosition> position;
  In<Of::kRates> rates;

  PELT_INLINE Ports<kPoints, kVertexChains> WithoutExtras() const {
    return {layer, table, state, rest, roots, wind, strands, chain, position};
  }
};

template <>
struct RatedPorts<4, true> {
  using Of = ChainStreams<4, true>;
  Shared<&Streams::layers> layer;
  Shared<Of::kTable> table;
  InOut<Of::kState> state;
  In<Of::kRest> rest;
  In<Of::kRoots> roots;
  In<Of::kWind> wind;
  InOut<Of::kModal> chain;
  In<Of::kRates> rates;

  PELT_INLINE Ports<4, true> WithoutExtras() const {
    return {layer, table, state, rest, roots, wind, chain};
  }
};

// Of sag-free layers: and which way was down at their roots when they were groomed.
template <uint32_t kPoints, bool kVertexChains>
struct HeldPorts {
  using Of = ChainStreams<kPoints, kVertexChains>;
  Shared<&Streams::layers> layer;
  Shared<Of::kTable> table;
  InOut<Of::kState> state;
  In<Of::kRest> rest;
  In<Of::kRoots> roots;
  In<Of::kWind> wind;
  In<&Streams::strands> strands;
  InOut<Of::kModal> chain;
  InOut<Of::kPosition> position;
  In<Of::kDown> down;

  PELT_INLINE Ports<kPoints, kVertexChains> WithoutExtras() const {
    return {layer, table, state, rest, roots, wind, strands, chain, position};
  }
};

template <>
struct HeldPorts<4, true> {
  using Of = ChainStreams<4, true>;
  Shared<&Streams::layers> layer;
  Shared<Of::kTable> table;
  InOut<Of::kState> state;
  In<Of::kRest> rest;
  In<Of::kRoots> roots;
  In<Of::kWind> wind;
  InOut<Of::kModal> chain;
  In<Of::kDown> down;

  PELT_INLINE Ports<4, true> WithoutExtras() const {
    return {layer, table, state, rest, roots, wind, chain};
  }
};

template <uint32_t kPoints, bool kVertexChains>
struct RatedHeldPorts {
  using Of = ChainStreams<kPoints, kVertexChains>;
  Shared<&Streams::layers> layer;
  Shared<Of::kTable> table;
  InOut<Of::kState> state;
  In<Of::kRest> rest;
  In<Of::kRoots> roots;
  In<Of::kWind> wind;
  In<&Streams::strands> strands;
  InOut<Of::kModal> chain;
  InOut<Of::kPosition> position;
  In<Of::kDown> down;
  In<Of::kRates> rates;

  PELT_INLINE Ports<kPoints, kVertexChains> WithoutExtras() const {
    return {layer, table, state, rest, roots, wind, strands, chain, position};
  }
};

template <>
struct RatedHeldPorts<4, true> {
  using Of = ChainStreams<4, true>;
  Shared<&Streams::layers> layer;
  Shared<Of::kTable> table;
  InOut<Of::kState> state;
  In<Of::kRest> rest;
  In<Of::kRoots> roots;
  In<Of::kWind> wind;
  InOut<Of::kModal> chain;
  In<Of::kDown> down;
  In<Of::kRates> rates;

  PELT_INLINE Ports<4, true> WithoutExtras() const {
    return {layer, table, state, rest, roots, wind, chain};
  }
};

// Chains of strands: their points are what is drawn.
template <class Ports>
inline constexpr bool kHasPoints = requires(const Ports& ports) {
  ports.position;
};

// What some layers have besides; null where a layer has it not.
struct Extras {
  const RootRateBlock* rates;  // what is known of the roots between frames
  const DownBlock* down;
};

}  // namespace pelt::modal
