// What a modal kernel reads and writes of a chunk, or of a patch: chains of mesh vertices have no control
// strands, and what the strands take of them is their state (chain_loads.hpp) and no points.
//
// Invariant: the wind and the control strands are read only where the layer has them.
#pragma once

#include <type_traits>

#include "core/kernel.hpp"
#include "core/kernels/prefetch.hpp"
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
  Ports<kPoints, kVertexChains> plain;
  In<ChainStreams<kPoints, kVertexChains>::kRates> rates;
};

// Of sag-free layers: and which way was down at their roots when they were groomed.
template <uint32_t kPoints, bool kVertexChains>
struct HeldPorts {
  Ports<kPoints, kVertexChains> plain;
  In<ChainStreams<kPoints, kVertexChains>::kDown> down;
};

template <uint32_t kPoints, bool kVertexChains>
struct RatedHeldPorts {
  Ports<kPoints, kVertexChains> plain;
  In<ChainStreams<kPoints, kVertexChains>::kDown> down;
  In<ChainStreams<kPoints, kVertexChains>::kRates> rates;
};

// Chains of strands: their points are what is drawn.
template <class Ports>
inline constexpr bool kHasPoints = requires(const Ports& ports) {
  ports.position;
};

// The rows of the groups to come, in eighths: the state, the groom, the points. What lanes need that
// were picked is in the cache already.
template <int kLanes, class Ports, class At>
PELT_INLINE auto PrefetchPorts(const Ports& ports, const At& at, uint32_t live) {
  if constexpr (!std::is_same_v<At, uint32_t>) {
    return PrefetchInPieces<kLanes, 8>(0, live);
  } else {
    const auto state = AllRows<1, kModalRow * sizeof(float)>(*ports.chain);
    const auto rest = AllRows(*ports.rest);
    if constexpr (kHasPoints<Ports>)
      return PrefetchInPieces<kLanes, 8>(at, live, state, rest, AllRows(*ports.position));
    else
      return PrefetchInPieces<kLanes, 8>(at, live, state, rest);
  }
}

// What some layers have besides; null where a layer has it not.
struct Extras {
  const RootRateBlock* rates;  // what is known of the roots between frames
  const DownBlock* down;
  const TraitBlock* traits;  // clump, weight and bounce of each lane
};

}  // namespace pelt::modal
