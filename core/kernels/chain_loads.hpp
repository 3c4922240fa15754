// Chain loads: what bends the modal chains at a patch's mesh vertices, for the strands that follow
// them (modal_load.hpp says what, interpolate_modal.hpp how); and how far chains of the other solvers
// are from their groom, for interpolate.hpp.
//
// Loads are written times a part's length, so that they do not depend on it: what moves and pulls a coat
// does so by the same m/s^2 for any length of the strand. So chains that a level leaves out (CountChains)
// take those of three that are kept, blended.
#pragma once

#include <string_view>

#include "core/kernel.hpp"
#include "core/kernels/modal_load.hpp"
#include "core/streams.hpp"

namespace pelt {

// Loads of the chains that follow others, and of those that come or go, which keep a share of their own.
// What they follow lies in lanes before their group.
template <class V>
struct FollowChains {
  const ChunkStateBlock& state;
  const ChainParentBlock& parents;
  LoadBlock& loads;

  PELT_INLINE void Run() const {
    const uint32_t end = RoundUpToLaneGroups(state.live_vertices);
    for (uint32_t lane = RoundUpToLaneGroups(state.whole_chains); lane < end; lane += V::kLanes) {
      WriteLanes<0>(lane);
      WriteLanes<1>(lane);
      WriteLanes<2>(lane);
      WriteLanes<3>(lane);
    }
  }

 private:
  // Lanes kFirst, kFirst + 4, ...
  template <int kFirst>
  PELT_INLINE void WriteLanes(uint32_t lane) const {
    const bool keeps = lane < state.live_chains;
    const V from_parents(state.parent_share), own(1.0f - state.parent_share);
    PELT_UNROLL
    for (uint32_t i = 0; i < 3; ++i) {
      V sum(0.0f);
      PELT_UNROLL
      for (uint32_t k = 0; k < 3; ++k) {
        const V share = SplatInFours<kFirst>(V::Load(parents.share[k] + lane));
        sum = sum + share * LoadRecords<V, kFirst>([&](int l) {
                      const uint32_t from = parents.lanes[lane + uint32_t(l)] >> 8 * k & 0xffu;
                      return loads.vertex[from].part[i];
                    });
      }
      const auto to = [&](int l) { return loads.vertex[lane + uint32_t(l)].part[i]; };
      if (keeps) sum = own * LoadRecords<V, kFirst>(to) + from_parents * sum;
      StoreRecords<kFirst>(sum, to);
    }
  }
};

template <class V>
struct ChainLoads {
  static constexpr std::string_view kName = "chain_loads";
  static constexpr uint32_t N = modal::kVertexNodes;
  struct Ports {
    Shared<&Streams::layers> layer;
    Shared<&Streams::modal_tables> table;
    In<&Streams::patch_state> state;
    In<&Streams::vertex_rest> rest;
    In<&Streams::anchors> anchors;
    In<&Streams::vertex_modal> chain;
    In<&Streams::chain_parents> parents;
    Out<&Streams::vertex_loads> loads;
  };

  static void Run(const Ports& ports) {
    const uint32_t end = RoundUpToLaneGroups(ports.state->live_chains);
    for (uint32_t lane = 0; lane < end; lane += V::kLanes) WriteGroup(ports, lane);
    FollowChains<V>{*ports.state, *ports.parents, *ports.loads}.Run();
  }

 private:
  PELT_INLINE static void WriteGroup(const Ports& ports, uint32_t lane) {
    const LayerBlock& layer = *ports.layer;
    const ModalStateBlock<N>& chain = *ports.chain;
    chain::Group<V, N> g;
    chain::LoadGroom<V, N + 1>(*ports.rest, *ports.anchors, 0.0f, layer.scale, lane, g);
    const V per_length = V(1.0f) / g.length;
    Vec3<V> rest[N], d[N], load[N];
    V lambda[N], stretch[N], l[N];
    modal::RestTangents(*ports.table, g, per_length, rest);
    modal::StretchOfWeight(layer, *ports.table, per_length, rest, stretch);
    PELT_UNROLL
    for (uint32_t i = 0; i < N; ++i) {
      d[i] = Load3<V>(chain.direction[i], lane);
      lambda[i] = V::Load(chain.multiplier[i] + lane);
    }
    modal::LoadOf(*ports.table, rest, d, lambda, stretch, load, l);
    PELT_UNROLL
    for (uint32_t i = 0; i < N; ++i) {
      const Vec3<V> out = load[i] * g.length;
      ScatterRecords<V>([&](int at) { return ports.loads->vertex[lane + uint32_t(at)].part[i]; },
                        out.x, out.y, out.z, l[i] * g.length);
    }
  }
};

template <class V>
struct ChainDisplacements {
  static constexpr std::string_view kName = "chain_displacements";
  static constexpr uint32_t kFree = 3;
  struct Ports {
    Shared<&Streams::layers> layer;
    In<&Streams::patch_state> state;
    In<&Streams::vertex_rest> rest;
    In<&Streams::anchors> anchors;
    In<&Streams::vertex_points> chains;
    In<&Streams::chain_parents> parents;
    Out<&Streams::vertex_loads> loads;
  };

  static void Run(const Ports& ports) {
    const uint32_t end = RoundUpToLaneGroups(ports.state->live_chains);
    for (uint32_t lane = 0; lane < end; lane += V::kLanes) {
      chain::Group<V, kFree> g;
      chain::LoadGroom<V, 4>(*ports.rest, *ports.anchors, 0.0f, ports.layer->scale, lane, g);
      const V scale = V(1.0f) / g.length;
      for (uint32_t i = 0; i < kFree; ++i) {
        const Vec3<V> at = Load3<V>(ports.chains->position[i], lane) - g.root;
        const Vec3<V> d = (at - g.rest[i]) * scale;
        ScatterRecords<V>([&](int l) { return ports.loads->vertex[lane + uint32_t(l)].part[i]; },
                          d.x, d.y, d.z, V(0.0f));
      }
    }
    FollowChains<V>{*ports.state, *ports.parents, *ports.loads}.Run();
  }
};

}  // namespace pelt
