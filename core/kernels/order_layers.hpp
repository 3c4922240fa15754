// The order layers are drawn in: ascending sort bias, then the layer whose box is farther first,
// then layer index. Far is the depth of the box's centre along the view direction.
//
// A stable merge sort over keys that hold bias and depth in 64 bits, in place in two small arrays:
// at most kLayersPerScene layers, and the same order on every machine. -0 and +0 are the same bias.
//
// Invariant: only layers in view with a strand to draw are listed; entries behind them are
// kNoLayer. What breaks if ignored: a layer that is not drawn would be drawn with last frame's
// vertices.
#pragma once

#include "core/kernel.hpp"
#include "core/kernels/sort_key.hpp"
#include "core/layer.hpp"
#include "core/streams.hpp"

namespace pelt {

struct OrderLayersParams {
  float eye[3];      // m
  float forward[3];  // unit
};

inline constexpr uint32_t kNoLayer = 0xffffffffu;

struct OrderedPorts {
  All<&Streams::layers> layers;
  All<&Streams::bounds> bounds;
  All<&Streams::lod> lod;
  All<&Streams::layer_sort> sort;
};

template <class V>
struct OrderLayers {
  static constexpr std::string_view kName = "order_layers";
  using Params = OrderLayersParams;
  struct Ports {
    OrderedPorts ordered;
    Out<&Streams::draw_list> list;
  };

  struct Entry {
    uint64_t key;
    uint32_t layer;
  };

  // Ascending key: ascending bias, then descending depth.
  static PELT_INLINE uint64_t MakeKey(const float (&eye)[3], const Params& p,
                                      const LayerBlock& layer, const BoundsBlock& box) {
    float depth = 0.0f;
    for (int axis = 0; axis < 3; ++axis) {
      const float centre = 0.5f * box.low[axis] + 0.5f * box.high[axis];
      depth = depth + (centre - eye[axis]) * p.forward[axis];
    }
    const uint32_t bias = ~uint32_t(FarToNearKey(V(layer.sort_bias))[0]);
    return uint64_t(bias) << 32 | uint32_t(FarToNearKey(V(depth))[0]);
  }

  // Merges the sorted runs [first, middle) and [middle, last); of equal keys the earlier comes
  // first.
  static PELT_INLINE void MergeRuns(const Entry* from, uint32_t first, uint32_t middle,
                                    uint32_t last, Entry* to) {
    uint32_t a = first, b = middle;
    for (uint32_t i = first; i < last; ++i) {
      const bool take_a = a < middle && (b >= last || from[a].key <= from[b].key);
      to[i] = take_a ? from[a++] : from[b++];
    }
  }

  static void Run(const Params& p, const Ports& ports) {
    RunFrom(p, ports.ordered, *ports.list, [&](uint32_t) -> const float(&)[3] { return p.eye; });
  }

  // eye_of(layer): where the eye is, relative to the same origin as the layer's bounds.
  template <class EyeOf>
  static PELT_INLINE void RunFrom(const Params& p, const OrderedPorts& ports, DrawListBlock& list,
                                  const EyeOf& eye_of) {
    Entry a[kLayersPerScene], b[kLayersPerScene];
    uint32_t count = 0;
    for (uint32_t l = 0; l < ports.layers.count && l < kLayersPerScene; ++l)
      if (ports.lod[l].visible != 0 && ports.sort[l].visible_count > 0)
        a[count++] = {MakeKey(eye_of(l), p, ports.layers[l], ports.bounds[l]), l};

    Entry* from = a;
    Entry* to = b;
    for (uint32_t run = 1; run < count; run *= 2) {
      for (uint32_t first = 0; first < count; first += 2 * run) {
        const uint32_t middle = first + run < count ? first + run : count;
        const uint32_t last = first + 2 * run < count ? first + 2 * run : count;
        MergeRuns(from, first, middle, last, to);
      }
      Entry* const swapped = from;
      from = to;
      to = swapped;
    }
    for (uint32_t i = 0; i < kLayersPerScene; ++i)
      list.layer[i] = i < count ? from[i].layer : kNoLayer;
    list.count = count;
  }
};

// The same for characters with origins of their own, from each of which the eye is elsewhere.
template <class V>
struct OrderLayersApart {
  static constexpr std::string_view kName = "order_layers_apart";
  using Params = OrderLayersParams;
  struct Ports {
    OrderedPorts ordered;
    All<&Streams::layer_origins> origins;
    Out<&Streams::draw_list> list;
  };

  static void Run(const Params& p, const Ports& ports) {
    OrderLayers<V>::RunFrom(p, ports.ordered, *ports.list,
                            [&](uint32_t l) -> const float(&)[3] { return ports.origins[l].eye; });
  }
};

}  // namespace pelt
