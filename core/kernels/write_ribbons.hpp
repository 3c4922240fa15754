// Ribbons: strips of four quads along a hair's five points, turned about the hair to face the
// camera.
//
//      v = 1  left4 ---- right4         side = normalize(cross(tangent, to_eye))
//               |      /    |           left = point - side * half width, u = 0
//               |   /       |           right = point + side * half width, u = 1
//      v = 0  left0 ---- right0         half width runs straight from root to tip
//
// Tangents are central differences of the points; at the root, where hair bends most, the parabola's
// through the first three, at the tip, where it does not bend, one-sided. Colours run from base to tip
// in sRGB bytes, rounded to nearest. A point with no tangent takes the world's up; a hair that points
// at the eye takes any side across it: every vertex is finite and has width. The index buffer is made
// once: core/ribbon_indices.hpp.
//
// WriteRibbons gathers records in draw order. WriteRibbonsUnsorted writes its own chunk's hairs in
// strand order, for drawing through an index buffer sorted on the caller's side: a gather in strand
// order would be the chunk's own block, so it takes that as a plain port.
//
// Invariant: the whole piece is written; hairs that are not drawn are zero vertices (no area). Work
// is across hairs, one lane per hair; lanes behind the last drawn hair repeat it and are cleared.
#pragma once

#include "core/chunk.hpp"
#include "core/kernel.hpp"
#include "core/kernels/write_instances.hpp"
#include "core/layer.hpp"
#include "core/streams.hpp"

namespace pelt {

struct WriteRibbonsParams {
  float eye[3];  // m
};

namespace write_ribbons_detail {

// One hair per lane.
template <class V>
struct Hairs {
  Vec3<V> point[kRibbonPoints];
  typename V::Int base_colour, tip_colour, film_strip;
  V width;  // m
};

// A record as five quads of four floats; `quad_of(lane, q)` is the address of one.
template <class V, class QuadOfLane>
PELT_INLINE Hairs<V> LoadHairs(QuadOfLane quad_of) {
  static_assert(kRibbonPoints == 5 && sizeof(RibbonRecord) == 80);
  V c[5][4];
  for (int q = 0; q < 5; ++q)
    GatherColumns<V>(
        [&](int l) __attribute__((always_inline)) { return quad_of(l, q); }, c[q][0], c[q][1],
        c[q][2], c[q][3]);
  Hairs<V> h;
  for (uint32_t i = 0; i < kRibbonPoints; ++i) {
    const uint32_t f = 3 * i;
    h.point[i] = {c[f / 4][f % 4], c[(f + 1) / 4][(f + 1) % 4], c[(f + 2) / 4][(f + 2) % 4]};
  }
  h.base_colour = Bits(c[3][3]);
  h.tip_colour = Bits(c[4][0]);
  h.width = c[4][1];
  h.film_strip = Bits(c[4][2]) >> 24;
  return h;
}

template <class V>
PELT_INLINE Vec3<V> TangentAt(const Hairs<V>& h, uint32_t i) {
  const uint32_t last = kRibbonPoints - 1;
  Vec3<V> d = h.point[i < last ? i + 1 : last] - h.point[i > 0 ? i - 1 : 0];
  if (i == 0) {
    const Vec3<V> over_two = h.point[2] - h.point[0];
    d = d * V(4.0f) - over_two;
  }
  const Vec3<V> up{V(0.0f), V(1.0f), V(0.0f)};
  const V squared = Dot(d, d);
  const Vec3<V> tangent = d * Rsqrt(squared);
  return Select<V>(squared > V(1e-20f), tangent, up);
}

// Unit, across the hair and across the line of sight.
template <class V>
PELT_INLINE Vec3<V> SideAt(Vec3<V> tangent, Vec3<V> to_eye) {
  const Vec3<V> side = Cross(tangent, to_eye);
  const typename V::Mask usable = Dot(side, side) > V(1e-10f) * Dot(to_eye, to_eye);
  const Vec3<V> across_x{V(0.0f), tangent.z, -tangent.y};
  const Vec3<V> across_y{-tangent.z, V(0.0f), tangent.x};
  const Vec3<V> any = Select<V>(Abs(tangent.x) < V(0.7f), across_x, across_y);
  return Normalize(Select<V>(usable, side, any));
}

// (base * (4 - i) + tip * i) / 4 for each of four bytes, rounded to nearest; two bytes at a time in
// 16-bit fields, which hold at most 255 * 4 + 2.
template <class V>
PELT_INLINE typename V::Int MixColours(typename V::Int base, typename V::Int tip, uint32_t i) {
  using I = typename V::Int;
  static_assert(kRibbonPoints == 5);
  const I low{0x00ff00ff}, half{0x00020002}, to_tip{int32_t(i)}, to_base{4 - int32_t(i)};
  const I even = ((base & low) * to_base + (tip & low) * to_tip + half) >> 2;
  const I odd = (((base >> 8) & low) * to_base + ((tip >> 8) & low) * to_tip + half) >> 2;
  return (even & low) | ((odd & low) << 8);
}

// RibbonVertex::texture.
template <class V>
PELT_INLINE typename V::Int PackTexture(typename V::Int film_strip, uint32_t u, uint32_t v) {
  return (film_strip << 8) | typename V::Int(int32_t(v << 16 | u));
}
PELT_INLINE constexpr uint32_t VOfPoint(uint32_t i) {
  return (i * 65535 + (kRibbonPoints - 1) / 2) / (kRibbonPoints - 1);
}

template <class V>
PELT_INLINE void StoreSide(RibbonVertexBlock& out, uint32_t hair, uint32_t i, int side,
                           Vec3<V> position, Vec3<V> tangent, typename V::Int colour,
                           typename V::Int film_strip) {
  const typename V::Int texture = PackTexture<V>(film_strip, side ? 255u : 0u, VOfPoint(i));
  const auto vertex = [&](int l) __attribute__((always_inline)) {
    return reinterpret_cast<float*>(&out.vertex[hair + uint32_t(l)][i][side]);
  };
  ScatterRecords<V>(vertex, position.x, position.y, position.z, tangent.x);
  ScatterRecords<V>(
      [&](int l) __attribute__((always_inline)) { return vertex(l) + 4; }, tangent.y, tangent.z,
      FromBits(colour), FromBits(texture));
}

template <class V>
PELT_INLINE void WriteHairs(const Hairs<V>& h, Vec3<V> eye, V tip_width, RibbonVertexBlock& out,
                            uint32_t hair) {
  const V half_width = h.width * V(0.5f);
  for (uint32_t i = 0; i < kRibbonPoints; ++i) {
    const V v(float(i) / float(kRibbonPoints - 1));
    const Vec3<V> tangent = TangentAt(h, i);
    const V reach = half_width * (V(1.0f) + (tip_width - V(1.0f)) * v);
    const Vec3<V> side = SideAt(tangent, eye - h.point[i]) * reach;
    const typename V::Int colour = MixColours<V>(h.base_colour, h.tip_colour, i);
    StoreSide<V>(out, hair, i, 0, h.point[i] - side, tangent, colour, h.film_strip);
    StoreSide<V>(out, hair, i, 1, h.point[i] + side, tangent, colour, h.film_strip);
  }
}

// record_of(hair) -> const RibbonRecord*, for hairs below `drawn`.
template <class V, class RecordOfHair>
PELT_INLINE void WritePiece(const WriteRibbonsParams& p, const LayerBlock& layer, uint32_t drawn,
                            RecordOfHair record_of, RibbonVertexBlock& out) {
  const Vec3<V> eye{V(p.eye[0]), V(p.eye[1]), V(p.eye[2])};
  for (uint32_t hair = 0; hair < drawn; hair += V::kLanes) {
    const auto quad_of = [&](int l, int q) __attribute__((always_inline)) {
      const uint32_t i = hair + uint32_t(l) < drawn ? hair + uint32_t(l) : drawn - 1;
      return reinterpret_cast<const float*>(record_of(i)) + 4 * q;
    };
    WriteHairs<V>(LoadHairs<V>(quad_of), eye, V(layer.tip_width), out, hair);
  }
  for (uint32_t hair = drawn; hair < kStrandsPerChunk; ++hair)
    for (uint32_t i = 0; i < kRibbonPoints; ++i)
      for (RibbonVertex& vertex : out.vertex[hair][i]) ClearRecord<V>(&vertex);
}

}  // namespace write_ribbons_detail

template <class V>
struct WriteRibbons {
  static constexpr std::string_view kName = "write_ribbons";
  using Params = WriteRibbonsParams;
  struct Ports {
    In<&Streams::order> order;
    In<&Streams::chunk_state> state;
    Shared<&Streams::layer_sort> sort;
    Shared<&Streams::layers> layer;
    Gather<&Streams::ribbons, &Streams::order> ribbons;
    Out<&Streams::ribbon_vertices> vertices;
  };

  static void Run(const Params& p, const Ports& ports) {
    const uint32_t drawn = CountDrawn(ports.sort->visible_count, ports.state->first_place);
    write_ribbons_detail::WritePiece<V>(
        p, *ports.layer,
        drawn, [&](uint32_t i) __attribute__((always_inline)) { return &ports.ribbons[i]; },
        *ports.vertices);
  }
};

template <class V>
struct WriteRibbonsUnsorted {
  static constexpr std::string_view kName = "write_ribbons_unsorted";
  using Params = WriteRibbonsParams;
  struct Ports {
    In<&Streams::chunk_state> state;
    Shared<&Streams::layers> layer;
    In<&Streams::ribbons> ribbons;
    Out<&Streams::ribbon_vertices> vertices;
  };

  static void Run(const Params& p, const Ports& ports) {
    write_ribbons_detail::WritePiece<V>(
        p, *ports.layer, ports.state->live_strands,
        [&](uint32_t i) __attribute__((always_inline)) { return &ports.ribbons->record[i]; },
        *ports.vertices);
  }
};

}  // namespace pelt
