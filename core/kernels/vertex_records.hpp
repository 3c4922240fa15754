// Records of 16 bytes that every mesh vertex has for each point or node of its chain, and their
// blends for the strands: each vertex is used by several strands, and records gather well
// (core/simd/records.hpp).
#pragma once

#include "core/kernel.hpp"
#include "core/streams.hpp"

namespace pelt {

// Of the vertices of a chunk's halo.
using VertexLoads = Gather<&Streams::vertex_loads, &Streams::halo>;

// Blends of the three vertices' records of each point, for lanes kFirst, kFirst + 4, ... A vertex's
// records lie side by side: where they are is worked out once.
template <int kFirst, class V, uint32_t kFree>
PELT_INLINE void BlendFours(const VertexLoads& loads, const StrandBlock& strands,
                            const V (&bary)[3], uint32_t lane, V (&sum)[kFree]) {
  PELT_UNROLL
  for (int k = 0; k < 3; ++k) {
    const uint8_t* vertex = strands.vertex[k] + lane;
    const V share = SplatInFours<kFirst>(bary[k]);
    PELT_UNROLL
    for (uint32_t i = 0; i < kFree; ++i) {
      const V one = LoadRecords<V, kFirst>([&](int l) { return loads[vertex[l]].part[i]; });
      const V term = one * share;
      sum[i] = k == 0 ? term : sum[i] + term;
    }
  }
}

// The four columns of the blends, for the lanes from `lane` on.
template <class V, uint32_t kFree>
struct BlendedRecords {
  V x[kFree], y[kFree], z[kFree], w[kFree];

  PELT_INLINE BlendedRecords(const VertexLoads& loads, const StrandBlock& strands,
                             const V (&bary)[3], uint32_t lane) {
    BlendFours<0>(loads, strands, bary, lane, x);
    BlendFours<1>(loads, strands, bary, lane, y);
    BlendFours<2>(loads, strands, bary, lane, z);
    BlendFours<3>(loads, strands, bary, lane, w);
    PELT_UNROLL
    for (uint32_t i = 0; i < kFree; ++i) TransposeFours(x[i], y[i], z[i], w[i]);
  }
  PELT_INLINE Vec3<V> Row(uint32_t i) const { return {x[i], y[i], z[i]}; }
};

}  // namespace pelt
