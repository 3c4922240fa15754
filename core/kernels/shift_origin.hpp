// A character's origin moved: what the last frame left is made relative to the new one.
//
// Places of a character that has an origin are relative to it. Of last frame's, only those that this
// frame takes up again are moved, by the same step each: skinned vertices, whose difference to this
// frame's is the roots' motion, and the points of chains. A strand then sees the sum of what its
// character did and what the origin did, which is what happened in the world.
//
// Invariant: runs before skin, and only in frames whose origin moved. What breaks if ignored: a
// moving origin shakes the fur of a character that stands still.
#pragma once

#include <string_view>

#include "core/chunk.hpp"
#include "core/kernel.hpp"
#include "core/layer.hpp"
#include "core/streams.hpp"

namespace pelt {

template <class V>
struct ShiftSkin {
  static constexpr std::string_view kName = "shift_skin";
  struct Ports {
    Shared<&Streams::layer_origins> origin;
    In<&Streams::patch_state> state;
    InOut<&Streams::skinned> skinned;
  };

  static void Run(const Ports& ports) {
    const float* const shift = ports.origin->shift;
    SkinnedVertex* const vertices = ports.skinned->vertex;
    for (uint32_t v = 0; v < ports.state->live_vertices; ++v)
      for (int k = 0; k < 3; ++k) vertices[v].position[k] = vertices[v].position[k] - shift[k];
  }
};

namespace shift_detail {

template <class V, uint32_t kPoints>
PELT_INLINE void ShiftPoints(const LayerOriginBlock& origin, uint32_t lanes,
                             PointBlock<kPoints>& points) {
  for (auto& point : points.position)
    for (int k = 0; k < 3; ++k) {
      const V shift(origin.shift[k]);
      for (uint32_t lane = 0; lane < lanes; lane += V::kLanes) {
        const V place = V::Load(point[k] + lane);
        (place - shift).Store(point[k] + lane);
      }
    }
}

template <bool kVertexChains>
PELT_INLINE uint32_t LanesOf(const ChunkStateBlock& state) {
  return RoundUpToLaneGroups(kVertexChains ? state.live_chains : state.live_strands);
}

}  // namespace shift_detail

// Of chains whose solver keeps last frame's points besides the present ones.
template <class V, uint32_t kPoints, bool kVertexChains>
struct ShiftChains {
  static constexpr std::string_view kName = kVertexChains  ? "shift_chains_vertex"
                                            : kPoints == 4 ? "shift_chains_4"
                                                           : "shift_chains_5";
  using Of = ChainStreams<kPoints, kVertexChains>;
  struct Ports {
    Shared<&Streams::layer_origins> origin;
    In<Of::kState> state;
    InOut<Of::kPosition> position;
    InOut<Of::kPrevious> previous;
  };

  static void Run(const Ports& ports) {
    const uint32_t lanes = shift_detail::LanesOf<kVertexChains>(*ports.state);
    shift_detail::ShiftPoints<V>(*ports.origin, lanes, *ports.position);
    shift_detail::ShiftPoints<V>(*ports.origin, lanes, *ports.previous);
  }
};

// Of modal ones, whose state has no places.
template <class V, uint32_t kPoints>
struct ShiftModal {
  static constexpr std::string_view kName =
      ByPoints<kPoints>("shift_modal_4", "shift_modal_5", "shift_modal_9");
  using Of = ChainStreams<kPoints, false>;
  struct Ports {
    Shared<&Streams::layer_origins> origin;
    In<Of::kState> state;
    InOut<Of::kPosition> position;
  };

  static void Run(const Ports& ports) {
    const uint32_t lanes = shift_detail::LanesOf<false>(*ports.state);
    shift_detail::ShiftPoints<V>(*ports.origin, lanes, *ports.position);
  }
};

}  // namespace pelt
