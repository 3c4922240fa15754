// Skins the chunk's own mesh vertices: linear blend skinning, dense in groups of 16 vertices.
//
// A group lists the joints that any of its vertices uses; each has one row of 16 weights. Lanes are
// vertices: every row adds weight * matrix to the lane's blended 3x4 matrix, with the matrix
// element broadcast and the weight loaded, so nothing is gathered and position, normal and tangent
// share the blend. Twelve sums, a weight and a product fit the sixteen registers of SSE4 and AVX2.
//
// Invariants
//  - A border vertex gets the same bits in every chunk it is stored in. Its joints come in
//  ascending
//    order everywhere; a row it does not use adds weight 0 times a finite matrix, which is +0 or
//    -0, to a sum that starts at +0 and so is never -0: nothing changes.
//  - Normal and tangent are unit and square to each other, also where blended normals cancel.
//  - motion is position minus last frame's, in the same bits that the position has; 0 where there
//    is no last frame.
// Normals go through the blended matrix itself, as in the originals: exact for rotation and uniform
// scale; under uneven scale they lean (the inverse transpose would cost half as much again).
#pragma once

#include <string_view>

#include "core/chunk.hpp"
#include "core/kernel.hpp"
#include "core/kernels/prefetch.hpp"
#include "core/streams.hpp"

namespace pelt {

namespace skin_detail {

// The columns of a 3x4 matrix in every lane.
template <class V>
struct BlendedMatrix {
  Vec3<V> x, y, z, origin;
};

template <class V>
PELT_INLINE BlendedMatrix<V> BlendMatrices(const float (&matrix)[kJointsPerCharacter][12],
                                           const MeshBlock& mesh, uint32_t group, uint32_t lane) {
  const V zero(0.0f);
  BlendedMatrix<V> sum = {
      {zero, zero, zero}, {zero, zero, zero}, {zero, zero, zero}, {zero, zero, zero}};
  const uint32_t end = mesh.group_first_row[group + 1];
  for (uint32_t row = mesh.group_first_row[group]; row < end; ++row) {
    const float* m = matrix[mesh.row_joint[row]];
    const V weight = V::Load(mesh.weight[row] + lane);
    sum.x = sum.x + Vec3<V>{V(m[0]), V(m[4]), V(m[8])} * weight;
    sum.y = sum.y + Vec3<V>{V(m[1]), V(m[5]), V(m[9])} * weight;
    sum.z = sum.z + Vec3<V>{V(m[2]), V(m[6]), V(m[10])} * weight;
    sum.origin = sum.origin + Vec3<V>{V(m[3]), V(m[7]), V(m[11])} * weight;
  }
  return sum;
}

template <class V>
PELT_INLINE Vec3<V> TransformDirection(const BlendedMatrix<V>& m, Vec3<V> a) {
  return Combine(m.x, a.x, m.y, a.y, m.z, a.z);
}

// Blended normals and tangents, before they are made unit.
struct RawFrames {
  alignas(64) float normal[3][kVerticesPerChunk];
  alignas(64) float tangent[3][kVerticesPerChunk];
};

// Vertices [first, first + kLanes): position and motion to their records, the rest to `raw`.
template <class V, bool kFrames>
PELT_INLINE void BlendVertices(const PaletteBlock& palette, const MeshBlock& mesh, uint32_t first,
                               uint32_t first_new, SkinnedVertex* skinned, RawFrames& raw) {
  const V zero(0.0f);
  const BlendedMatrix<V> m =
      BlendMatrices<V>(palette.matrix, mesh, first / kLaneGroup, first % kLaneGroup);
  Store3<V>(raw.normal, first, TransformDirection(m, Load3<V>(mesh.normal, first)));
  if constexpr (kFrames)
    Store3<V>(raw.tangent, first, TransformDirection(m, Load3<V>(mesh.tangent, first)));
  const Vec3<V> position = TransformDirection(m, Load3<V>(mesh.position, first)) + m.origin;

  SkinnedVertex* const out = skinned + first;
  const auto position_of = [out](int lane) { return out[lane].position; };
  const auto motion_of = [out](int lane) { return out[lane].motion; };
  V a = position.x, b = position.y, c = position.z, d = zero;
  TransposeFours(a, b, c, d);
  if constexpr (kFrames) {
    // As records, so that last frame's positions need no transposition.
    const auto has_last = V::Int::Iota(int32_t(first)) < typename V::Int(int32_t(first_new));
    const V keep = Select(has_last, FromBits(typename V::Int(-1)), zero);
    const auto masked = [](V value, V mask) { return FromBits(Bits(value) & Bits(mask)); };
    StoreRecords<0>(masked(a - LoadRecords<V, 0>(position_of), SplatInFours<0>(keep)), motion_of);
    StoreRecords<1>(masked(b - LoadRecords<V, 1>(position_of), SplatInFours<1>(keep)), motion_of);
    StoreRecords<2>(masked(c - LoadRecords<V, 2>(position_of), SplatInFours<2>(keep)), motion_of);
    StoreRecords<3>(masked(d - LoadRecords<V, 3>(position_of), SplatInFours<3>(keep)), motion_of);
  }
  StoreRecords<0>(a, position_of);
  StoreRecords<1>(b, position_of);
  StoreRecords<2>(c, position_of);
  StoreRecords<3>(d, position_of);
}

template <class V, bool kFrames>
PELT_INLINE void FinishFrames(const RawFrames& raw, uint32_t first, SkinnedVertex* skinned) {
  const V zero(0.0f);
  SkinnedVertex* const out = skinned + first;
  const Vec3<V> up = {zero, V(1.0f), zero};
  const Vec3<V> normal = NormalizeOr(Load3<V>(raw.normal, first), up);
  ScatterRecords([out](int lane) { return out[lane].normal; }, normal.x, normal.y, normal.z, zero);
  if constexpr (kFrames) {
    const Vec3<V> tangent = UnitAcross(normal, Load3<V>(raw.tangent, first));
    ScatterRecords([out](int lane) { return out[lane].tangent; }, tangent.x, tangent.y, tangent.z,
                   zero);
  }
}

// Two loops over the chunk: making a frame unit is a chain of some 200 cycles, and only short loop
// bodies let the machine overlap the chains of several groups (measured: a third faster than one
// loop). With kFrames false only position and normal are written: what other skinning libraries are
// compared with.
template <class V, bool kFrames>
PELT_INLINE void SkinChunk(const PaletteBlock& palette, const MeshBlock& mesh, uint32_t lanes,
                           uint32_t first_new, SkinnedBlock& skinned) {
  RawFrames raw;
  ForEachPrefetched<V::kLanes>(
      0, lanes,
      [&](uint32_t v) __attribute__((always_inline)) {
        BlendVertices<V, kFrames>(palette, mesh, v, first_new, skinned.vertex, raw);
      },
      RowsFrom<9, 1, sizeof mesh.position[0]>(mesh, mesh.position));
  // Chunks have few vertices, and skin is the first to touch them: what the next one starts with. Of
  // weights as many rows as most groups have.
  constexpr uint32_t kWeightBytes = 5 * sizeof mesh.weight[0] / kLaneGroup;
  ForEachPrefetched<V::kLanes>(
      0, lanes,
      [&](uint32_t v)
          __attribute__((always_inline)) { FinishFrames<V, kFrames>(raw, v, skinned.vertex); },
      NextChunkFrom<sizeof(SkinnedVertex)>(skinned, skinned.vertex),
      NextChunkFrom<kWeightBytes>(mesh, mesh.weight),
      NextChunkFrom<8>(mesh, mesh.row_joint));  // and first rows
}

}  // namespace skin_detail

template <class V>
struct Skin {
  static constexpr std::string_view kName = "skin";
  struct Ports {
    Shared<&Streams::palette> palette;
    In<&Streams::mesh> mesh;
    In<&Streams::patch_state> state;
    InOut<&Streams::skinned> skinned;
  };

  static void Run(const Ports& ports) {
    const ChunkStateBlock& state = *ports.state;
    const bool restart = (state.flags & kChunkRestart) != 0 || ports.palette->teleported != 0;
    const uint32_t first_new = restart ? 0 : state.first_new_vertex;
    const uint32_t lanes = RoundUpToLaneGroups(state.live_vertices);
    skin_detail::SkinChunk<V, true>(*ports.palette, *ports.mesh, lanes, first_new, *ports.skinned);
  }
};

}  // namespace pelt
