// Where the strands stand: three skinned vertices blended with the strand's barycentrics.
//
// The one irregular access of the frame. Whole 16-byte records are blended, lanes k, k + 4, ... in
// one register with the strand's weight spread over its record, and transposed once at the end: a
// third of the shuffles that transposing each vertex would take.
//
// Invariant: normal and tangent come out unit and square to each other, also where the three
// normals cancel. Strands that share a place on a border get bits from vertices that agree bit for
// bit.
#pragma once

#include <string_view>

#include "core/chunk.hpp"
#include "core/kernel.hpp"
#include "core/kernels/fetch_ahead.hpp"
#include "core/streams.hpp"

namespace pelt {

template <class V>
struct Roots {
  static constexpr std::string_view kName = "roots";
  struct Ports {
    In<&Streams::chunk_state> state;
    In<&Streams::strands> strands;
    Gather<&Streams::skinned, &Streams::halo> skinned;
    Out<&Streams::roots> roots;
  };

  static void Run(const Ports& ports) {
    const uint32_t lanes = RoundUpToLaneGroups(ports.state->live_strands);
    for (uint32_t s = 0; s < lanes; s += V::kLanes) {
      FetchAhead(ports, s, lanes);
      BlendStrands(*ports.strands, ports.skinned, s, *ports.roots);
    }
    // A loop of its own: making a frame unit is a chain of some 200 cycles, and only short loop
    // bodies let the machine overlap the chains of several groups.
    for (uint32_t s = 0; s < lanes; s += V::kLanes) FinishFrames(s, *ports.roots);
  }

 private:
  using Vertices = Gather<&Streams::skinned, &Streams::halo>;

  static PELT_INLINE void FetchAhead(const Ports& ports, uint32_t s, uint32_t end) {
    constexpr uint32_t kRow = kStrandsPerChunk * sizeof(float);
    RowsAhead<StrandBlock, V::kLanes, 3, kRow, 2>(ports.strands->bary, s, end).Fetch();
    BlockAhead<RootBlock, V::kLanes, 2>(ports.roots->position, s, end).Fetch();
    // The rows of bytes, and what the block has behind them.
    constexpr uint32_t kBytes =
        (sizeof(StrandBlock) - offsetof(StrandBlock, vertex)) / kStrandsPerChunk;
    FetchRecordsAhead<StrandBlock, V::kLanes, kBytes, 0>(ports.strands->vertex, s, 0);
  }

  // The four records of a vertex, for the strands of lanes k, k + 4, ...
  struct VertexRecords {
    V position, normal, tangent, motion;
  };

  template <int k>
  static PELT_INLINE VertexRecords WeighVertex(const Vertices& vertices, const uint8_t* index,
                                               V weight) {
    const V w = SplatInFours<k>(weight);
    return {LoadParts<V, k>(vertices, index, &SkinnedVertex::position) * w,
            LoadParts<V, k>(vertices, index, &SkinnedVertex::normal) * w,
            LoadParts<V, k>(vertices, index, &SkinnedVertex::tangent) * w,
            LoadParts<V, k>(vertices, index, &SkinnedVertex::motion) * w};
  }

  static PELT_INLINE VertexRecords Add(VertexRecords a, VertexRecords b) {
    return {a.position + b.position, a.normal + b.normal, a.tangent + b.tangent,
            a.motion + b.motion};
  }

  template <int k>
  static PELT_INLINE VertexRecords BlendVertices(const StrandBlock& strands,
                                                 const Vertices& vertices, uint32_t s,
                                                 const Vec3<V>& bary) {
    // Named, so that no compiler computes them in another order (pricing/written_order.hpp).
    const VertexRecords a = WeighVertex<k>(vertices, strands.vertex[0] + s, bary.x);
    const VertexRecords b = WeighVertex<k>(vertices, strands.vertex[1] + s, bary.y);
    const VertexRecords c = WeighVertex<k>(vertices, strands.vertex[2] + s, bary.z);
    return Add(Add(a, b), c);
  }

  static PELT_INLINE Vec3<V> Columns(V a, V b, V c, V d) {
    TransposeFours(a, b, c, d);
    return {a, b, c};
  }

  static PELT_INLINE void BlendStrands(const StrandBlock& strands, const Vertices& vertices,
                                       uint32_t s, RootBlock& roots) {
    const Vec3<V> bary = Load3<V>(strands.bary, s);
    const VertexRecords a = BlendVertices<0>(strands, vertices, s, bary);
    const VertexRecords b = BlendVertices<1>(strands, vertices, s, bary);
    const VertexRecords c = BlendVertices<2>(strands, vertices, s, bary);
    const VertexRecords d = BlendVertices<3>(strands, vertices, s, bary);
    Store3<V>(roots.position, s, Columns(a.position, b.position, c.position, d.position));
    Store3<V>(roots.motion, s, Columns(a.motion, b.motion, c.motion, d.motion));
    Store3<V>(roots.normal, s, Columns(a.normal, b.normal, c.normal, d.normal));
    Store3<V>(roots.tangent, s, Columns(a.tangent, b.tangent, c.tangent, d.tangent));
  }

  static PELT_INLINE void FinishFrames(uint32_t s, RootBlock& roots) {
    const Vec3<V> up = {V(0.0f), V(1.0f), V(0.0f)};
    const Vec3<V> normal = NormalizeOr(Load3<V>(roots.normal, s), up);
    Store3<V>(roots.normal, s, normal);
    Store3<V>(roots.tangent, s, UnitAcross(normal, Load3<V>(roots.tangent, s)));
  }
};

}  // namespace pelt
