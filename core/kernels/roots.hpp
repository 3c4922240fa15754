// Where chains are fixed, and how fast that moves and turns: the roots of strands, and the anchors of
// chains at mesh vertices.
#pragma once

#include <string_view>

#include "core/chunk.hpp"
#include "core/kernel.hpp"
#include "core/kernels/prefetch.hpp"
#include "core/kernels/skin.hpp"
#include "core/streams.hpp"

namespace pelt {

namespace roots_detail {

// Records of strands k, k + 4, ... to rows.
template <class V>
PELT_INLINE Vec3<V> Columns(V a, V b, V c, V d) {
  TransposeFours(a, b, c, d);
  return {a, b, c};
}

}  // namespace roots_detail

// Where the strands stand: three skinned vertices blended with the strand's barycentrics.
//
// The one irregular access of the frame. Whole 16-byte records are blended, lanes k, k + 4, ... in
// one register with the strand's weight spread over its record, and transposed once at the end: a
// third of the shuffles that transposing each vertex would take.
//
// Invariant: normal and tangent come out unit and square to each other, also where the three
// normals cancel. Strands that share a place on a border get bits from vertices that agree bit for
// bit.
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
    const StrandBlock& strands = *ports.strands;
    // The rows of bytes, and what the block has behind them.
    constexpr uint32_t kBytes =
        (sizeof(StrandBlock) - offsetof(StrandBlock, vertex)) / kStrandsPerChunk;
    ForEachPrefetched<V::kLanes>(
        0, lanes,
        [&](uint32_t s) __attribute__((always_inline)) {
          BlendStrands(strands, ports.skinned, s, *ports.roots);
        },
        RowsFrom<3, 2>(strands, strands.bary), AllRows<2>(*ports.roots),
        NextChunkFrom<kBytes>(strands, strands.vertex));
    // A loop of its own: making a frame unit is a chain of some 200 cycles, and only short loop
    // bodies let the machine overlap the chains of several groups.
    for (uint32_t s = 0; s < lanes; s += V::kLanes) FinishFrames(s, *ports.roots);
  }

 private:
  using Vertices = Gather<&Streams::skinned, &Streams::halo>;

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
    // Named, so that no compiler computes them in another order (pricing/trace.hpp).
    const VertexRecords a = WeighVertex<k>(vertices, strands.vertex[0] + s, bary.x);
    const VertexRecords b = WeighVertex<k>(vertices, strands.vertex[1] + s, bary.y);
    const VertexRecords c = WeighVertex<k>(vertices, strands.vertex[2] + s, bary.z);
    return Add(Add(a, b), c);
  }

  static PELT_INLINE void BlendStrands(const StrandBlock& strands, const Vertices& vertices,
                                       uint32_t s, RootBlock& roots) {
    using roots_detail::Columns;
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

// Where the chains of a vertex-chain layer are fixed: the skinned vertices, as rows.
//
// Skinned vertices are records because strands fetch them in any order; simulation wants rows. This
// kernel only turns one into the other, so an anchor has the vertex's bits.
template <class V>
struct Anchors {
  static constexpr std::string_view kName = "anchors";
  struct Ports {
    In<&Streams::patch_state> state;
    In<&Streams::skinned> skinned;
    Out<&Streams::anchors> anchors;
  };

  static void Run(const Ports& ports) {
    const uint32_t lanes = RoundUpToLaneGroups(ports.state->live_chains);
    RootBlock& anchors = *ports.anchors;
    for (uint32_t v = 0; v < lanes; v += V::kLanes) {
      const SkinnedVertex* const in = ports.skinned->vertex + v;
      CopyColumns([in](int lane) { return in[lane].position; }, anchors.position, v);
      CopyColumns([in](int lane) { return in[lane].normal; }, anchors.normal, v);
      CopyColumns([in](int lane) { return in[lane].tangent; }, anchors.tangent, v);
      CopyColumns([in](int lane) { return in[lane].motion; }, anchors.motion, v);
    }
  }

 private:
  template <class AddressOfLane>
  static PELT_INLINE void CopyColumns(AddressOfLane address, float (&rows)[3][kStrandsPerChunk],
                                      uint32_t lane) {
    V x = LoadRecords<V, 0>(address), y = LoadRecords<V, 1>(address);
    V z = LoadRecords<V, 2>(address), w = LoadRecords<V, 3>(address);
    TransposeFours(x, y, z, w);
    Store3<V>(rows, lane, {x, y, z});
  }
};

// How fast the roots of chains move and turn: the derivative of skin, anchors and roots by time.
//
// Linear blend skinning is linear in the matrices, so a vertex has the velocity that the same blend
// of the palette's derivatives gives it. Normal and tangent are made unit and square after the
// blend; with n and t what they were before, N and T what they are after,
//
//     N' = (n' - N (N . n')) / |n|,   B = N x T,   B . T' = (B . t' - (B . N') (N . t)) / (T . t),
//     spin = N x N' + (B . T') N,
//
// of a vertex, and again of a strand, whose n and t are the blend of its three vertices' N and T.
//
// Invariant: finite in, finite out, also where blended normals cancel: a spin is let grow to 1e6
// rad/s and no further.

namespace root_rates_detail {

inline constexpr float kFastestSpin = 1.0e6f;

template <class V>
struct Frame {
  Vec3<V> normal, tangent;
};

// Of frame `unit`, made from `raw`, which changes at `rate`.
template <class V>
PELT_INLINE Vec3<V> SpinOf(const Frame<V>& unit, const Frame<V>& raw, const Frame<V>& rate) {
  const V most(kFastestSpin), least = V(0.0f) - most;
  const V inverse = Rsqrt(Max(Dot(raw.normal, raw.normal), V(1.0e-30f)));
  const V along = Dot(unit.normal, rate.normal);
  const Vec3<V> off = (rate.normal - unit.normal * along) * inverse;
  const Vec3<V> lean = {Clamp(off.x, least, most), Clamp(off.y, least, most),
                        Clamp(off.z, least, most)};
  const Vec3<V> across = Cross(unit.normal, unit.tangent);
  const V forward = Dot(across, rate.tangent);
  const V leans = Dot(across, lean), slant = Dot(unit.normal, raw.tangent);
  const V carried = leans * slant;
  const V size = Max(Dot(unit.tangent, raw.tangent), V(1.0e-15f));
  const V turn = Clamp((forward - carried) / size, least, most);
  const Vec3<V> tilt = Cross(unit.normal, lean);
  return tilt + unit.normal * turn;
}

template <class V>
struct Rates {
  Vec3<V> velocity, spin;
  Frame<V> frame;
};

// Of vertices [first, first + kLanes).
template <class V>
PELT_INLINE Rates<V> RatesOfVertices(const PaletteBlock& palette, const PaletteRateBlock& rates,
                                     const MeshBlock& mesh, uint32_t first) {
  using namespace skin_detail;
  const uint32_t group = first / kLaneGroup, lane = first % kLaneGroup;
  const BlendedMatrix<V> m = BlendMatrices<V>(palette.matrix, mesh, group, lane);
  const BlendedMatrix<V> d = BlendMatrices<V>(rates.matrix, mesh, group, lane);
  const Vec3<V> position = Load3<V>(mesh.position, first);
  const Vec3<V> normal = Load3<V>(mesh.normal, first), tangent = Load3<V>(mesh.tangent, first);
  const Frame<V> raw = {TransformDirection(m, normal), TransformDirection(m, tangent)};
  const Frame<V> rate = {TransformDirection(d, normal), TransformDirection(d, tangent)};
  const Vec3<V> up = {V(0.0f), V(1.0f), V(0.0f)};
  Rates<V> out;
  out.velocity = TransformDirection(d, position) + d.origin;
  out.frame.normal = NormalizeOr(raw.normal, up);
  out.frame.tangent = UnitAcross(out.frame.normal, raw.tangent);
  out.spin = SpinOf(out.frame, raw, rate);
  return out;
}

}  // namespace root_rates_detail

// Of chains at mesh vertices.
template <class V>
struct AnchorRates {
  static constexpr std::string_view kName = "anchor_rates";
  struct Ports {
    Shared<&Streams::palette> palette;
    Shared<&Streams::palette_rates> palette_rates;
    In<&Streams::mesh> mesh;
    In<&Streams::patch_state> state;
    In<&Streams::anchors> anchors;  // of layers that have them
    Out<&Streams::anchor_rates> rates;
  };

  static void Run(const Ports& ports) {
    const uint32_t lanes = RoundUpToLaneGroups(ports.state->live_chains);
    for (uint32_t v = 0; v < lanes; v += V::kLanes) {
      const auto rates = root_rates_detail::RatesOfVertices<V>(*ports.palette, *ports.palette_rates,
                                                               *ports.mesh, v);
      Store3<V>(ports.rates->velocity, v, rates.velocity);
      Store3<V>(ports.rates->spin, v, rates.spin);
    }
  }
};

// Of mesh vertices, for the strands that stand among them.
template <class V>
struct MeshRates {
  static constexpr std::string_view kName = "mesh_rates";
  struct Ports {
    Shared<&Streams::palette> palette;
    Shared<&Streams::palette_rates> palette_rates;
    In<&Streams::mesh> mesh;
    In<&Streams::patch_state> state;
    Out<&Streams::vertex_rates> rates;
  };

  static void Run(const Ports& ports) {
    const uint32_t lanes = RoundUpToLaneGroups(ports.state->live_vertices);
    for (uint32_t v = 0; v < lanes; v += V::kLanes) {
      const auto rates = root_rates_detail::RatesOfVertices<V>(*ports.palette, *ports.palette_rates,
                                                               *ports.mesh, v);
      VertexRates* const out = ports.rates->vertex + v;
      Put([out](int lane) { return out[lane].velocity; }, rates.velocity);
      Put([out](int lane) { return out[lane].normal; }, Cross(rates.spin, rates.frame.normal));
      Put([out](int lane) { return out[lane].tangent; }, Cross(rates.spin, rates.frame.tangent));
    }
  }

 private:
  template <class AddressOfLane>
  static PELT_INLINE void Put(AddressOfLane address, const Vec3<V>& a) {
    ScatterRecords(address, a.x, a.y, a.z, V(0.0f));
  }
};

// Of chains of strands.
template <class V>
struct RootRates {
  static constexpr std::string_view kName = "root_rates";
  struct Ports {
    In<&Streams::chunk_state> state;
    In<&Streams::strands> strands;
    Gather<&Streams::vertex_rates, &Streams::halo> vertex_rates;
    Gather<&Streams::skinned, &Streams::halo> skinned;
    In<&Streams::roots> roots;
    Out<&Streams::root_rates> rates;
  };

  static void Run(const Ports& ports) {
    const uint32_t lanes = RoundUpToLaneGroups(ports.state->live_strands);
    for (uint32_t s = 0; s < lanes; s += V::kLanes) BlendStrands(ports, s);
  }

 private:
  using Frame = root_rates_detail::Frame<V>;

  // What strands blend of a vertex, for those of lanes k, k + 4, ...
  struct Weighed {
    V velocity, normal, tangent, normal_rate, tangent_rate;
  };

  template <int k>
  static PELT_INLINE Weighed WeighVertex(const Ports& ports, const uint8_t* index, V weight) {
    const V w = SplatInFours<k>(weight);
    const auto& rates = ports.vertex_rates;
    const auto& skinned = ports.skinned;
    return {LoadParts<V, k>(rates, index, &VertexRates::velocity) * w,
            LoadParts<V, k>(skinned, index, &SkinnedVertex::normal) * w,
            LoadParts<V, k>(skinned, index, &SkinnedVertex::tangent) * w,
            LoadParts<V, k>(rates, index, &VertexRates::normal) * w,
            LoadParts<V, k>(rates, index, &VertexRates::tangent) * w};
  }

  static PELT_INLINE Weighed Add(const Weighed& a, const Weighed& b) {
    return {a.velocity + b.velocity, a.normal + b.normal, a.tangent + b.tangent,
            a.normal_rate + b.normal_rate, a.tangent_rate + b.tangent_rate};
  }

  template <int k>
  static PELT_INLINE Weighed BlendVertices(const Ports& ports, uint32_t s, const Vec3<V>& bary) {
    const StrandBlock& strands = *ports.strands;
    // Named, so that no compiler computes them in another order (pricing/trace.hpp).
    const Weighed a = WeighVertex<k>(ports, strands.vertex[0] + s, bary.x);
    const Weighed b = WeighVertex<k>(ports, strands.vertex[1] + s, bary.y);
    const Weighed c = WeighVertex<k>(ports, strands.vertex[2] + s, bary.z);
    return Add(Add(a, b), c);
  }

  static PELT_INLINE void BlendStrands(const Ports& ports, uint32_t s) {
    using roots_detail::Columns;
    const Vec3<V> bary = Load3<V>(ports.strands->bary, s);
    const Weighed a = BlendVertices<0>(ports, s, bary);
    const Weighed b = BlendVertices<1>(ports, s, bary);
    const Weighed c = BlendVertices<2>(ports, s, bary);
    const Weighed d = BlendVertices<3>(ports, s, bary);
    Store3<V>(ports.rates->velocity, s, Columns(a.velocity, b.velocity, c.velocity, d.velocity));
    const Vec3<V> normal = Columns(a.normal, b.normal, c.normal, d.normal);
    const Vec3<V> tangent = Columns(a.tangent, b.tangent, c.tangent, d.tangent);
    const Vec3<V> normal_rate = Columns(a.normal_rate, b.normal_rate, c.normal_rate, d.normal_rate);
    const Vec3<V> tangent_rate =
        Columns(a.tangent_rate, b.tangent_rate, c.tangent_rate, d.tangent_rate);
    const Frame unit = {Load3<V>(ports.roots->normal, s), Load3<V>(ports.roots->tangent, s)};
    const Vec3<V> spin = root_rates_detail::SpinOf<V>(unit, Frame{normal, tangent},
                                                      Frame{normal_rate, tangent_rate});
    Store3<V>(ports.rates->spin, s, spin);
  }
};

}  // namespace pelt
