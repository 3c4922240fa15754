// Lines: five points along a strand's curve, each with its width, which the GPU widens into a strip
// that faces the camera, or draws as lines.
//
//      t = 0     1/4     1/2     3/4      1      P(t) = c0 + t (c1 + t (c2 + t c3))
//        o-------o-------o-------o-------o       one vertex each: half the bytes of ribbons, and
//      width                         tip_width   nothing in them depends on the camera
//
// Widths run straight from root to tip; tangents are the curve's derivative, unit, or the world's up
// where it has none; colours run from base to tip as those of ribbons.
//
// WriteLines gathers curves in draw order. WriteLinesUnsorted writes its own chunk's strands in
// strand order, for drawing through the order as an index buffer.
//
// Invariant: the whole piece is written; strands that are not drawn are zero vertices (no width).
// Work is across strands, one lane per strand; lanes behind the last repeat it and are cleared.
#pragma once

#include "core/chunk.hpp"
#include "core/kernel.hpp"
#include "core/kernels/write_instances.hpp"
#include "core/kernels/write_ribbons.hpp"
#include "core/layer.hpp"
#include "core/streams.hpp"

namespace pelt {

namespace write_lines_detail {

// One strand per lane.
template <class V>
struct Strands {
  Vec3<V> c[4];
  typename V::Int base_colour, tip_colour, tag;
  V width;  // at the root, m
};

// A record as four quads of four floats; `quad_of(lane, q)` is the address of one.
template <class V, class QuadOfLane>
PELT_INLINE Strands<V> LoadStrands(QuadOfLane quad_of) {
  static_assert(sizeof(CurveRecord) == 64);
  V word[16];
  for (int q = 0; q < 4; ++q)
    GatherColumns<V>(
        [&](int l) __attribute__((always_inline)) { return quad_of(l, q); }, word[4 * q],
        word[4 * q + 1], word[4 * q + 2], word[4 * q + 3]);
  Strands<V> s;
  for (int k = 0; k < 4; ++k) s.c[k] = {word[3 * k], word[3 * k + 1], word[3 * k + 2]};
  s.base_colour = Bits(word[12]);
  s.tip_colour = Bits(word[13]);
  s.width = word[14];
  s.tag = Bits(word[15]);
  return s;
}

template <class V>
PELT_INLINE Vec3<V> PointAt(const Strands<V>& s, float t) {
  const Vec3<V> quadratic = s.c[2] + s.c[3] * V(t);
  const Vec3<V> linear = s.c[1] + quadratic * V(t);
  return s.c[0] + linear * V(t);
}

template <class V>
PELT_INLINE Vec3<V> TangentAt(const Strands<V>& s, float t) {
  const Vec3<V> cubic = s.c[3] * V(3.0f * t * t);
  const Vec3<V> quadratic = s.c[2] * V(2.0f * t);
  const Vec3<V> along = s.c[1] + quadratic;
  const Vec3<V> d = along + cubic;
  const V squared = Dot(d, d);
  const Vec3<V> tangent = d * Rsqrt(squared);
  const Vec3<V> up{V(0.0f), V(1.0f), V(0.0f)};
  return Select<V>(squared > V(1e-20f), tangent, up);
}

// A number from -1 to 1 as 16-bit signed normalised, rounded to nearest.
template <class V>
PELT_INLINE typename V::Int PackSigned(V a) {
  using I = typename V::Int;
  const V scale(32767.0f), middle(32768.5f);
  const I sign(0x8000), low(0xffff), from_least = Truncate(a * scale + middle);
  return (from_least ^ sign) & low;
}

template <class V>
PELT_INLINE void StorePoint(LineVertexBlock& out, uint32_t strand, uint32_t i, Vec3<V> position,
                            V width, Vec3<V> tangent, typename V::Int colour, typename V::Int tag) {
  using I = typename V::Int;
  const int32_t v = int32_t((i * 32767 + (kRibbonPoints - 1) / 2) / (kRibbonPoints - 1));
  const I x = PackSigned(tangent.x), y = PackSigned(tangent.y), z = PackSigned(tangent.z);
  const I xy = x | (y << 16), zv = z | I(v << 16);
  const auto vertex = [&](int l) __attribute__((always_inline)) {
    return reinterpret_cast<float*>(&out.vertex[strand + uint32_t(l)][i]);
  };
  ScatterRecords<V>(vertex, position.x, position.y, position.z, width);
  ScatterRecords<V>(
      [&](int l) __attribute__((always_inline)) { return vertex(l) + 4; }, FromBits(xy),
      FromBits(zv), FromBits(colour), FromBits(tag));
}

template <class V>
PELT_INLINE void WriteStrands(const Strands<V>& s, V tip_width, LineVertexBlock& out,
                              uint32_t strand) {
  for (uint32_t i = 0; i < kRibbonPoints; ++i) {
    const float t = float(i) / float(kRibbonPoints - 1);
    const Vec3<V> point = PointAt(s, t), tangent = TangentAt(s, t);
    const V one(1.0f), along(t), narrowed = (tip_width - one) * along;
    const V width = s.width * (one + narrowed);
    const typename V::Int colour =
        write_ribbons_detail::MixColours<V>(s.base_colour, s.tip_colour, i);
    StorePoint<V>(out, strand, i, point, width, tangent, colour, s.tag);
  }
}

// record_of(strand) -> const CurveRecord*, for strands below `drawn`.
template <class V, class RecordOfStrand>
PELT_INLINE void WritePiece(const LayerBlock& layer, uint32_t drawn, RecordOfStrand record_of,
                            LineVertexBlock& out) {
  for (uint32_t strand = 0; strand < drawn; strand += V::kLanes) {
    const auto quad_of = [&](int l, int q) __attribute__((always_inline)) {
      const uint32_t i = strand + uint32_t(l) < drawn ? strand + uint32_t(l) : drawn - 1;
      return reinterpret_cast<const float*>(record_of(i)) + 4 * q;
    };
    WriteStrands<V>(LoadStrands<V>(quad_of), V(layer.tip_width), out, strand);
  }
  for (uint32_t strand = drawn; strand < kStrandsPerChunk; ++strand)
    for (LineVertex& vertex : out.vertex[strand]) ClearRecord<V>(&vertex);
}

}  // namespace write_lines_detail

template <class V>
struct WriteLines {
  static constexpr std::string_view kName = "write_lines";
  struct Ports {
    In<&Streams::order> order;
    In<&Streams::chunk_state> state;
    Shared<&Streams::layer_sort> sort;
    Shared<&Streams::layers> layer;
    Gather<&Streams::curves, &Streams::order> curves;
    Out<&Streams::line_vertices> vertices;
  };

  static void Run(const Ports& ports) {
    const uint32_t drawn = CountDrawn(ports.sort->visible_count, ports.state->first_place);
    write_lines_detail::WritePiece<V>(
        *ports.layer,
        drawn, [&](uint32_t i) __attribute__((always_inline)) { return &ports.curves[i]; },
        *ports.vertices);
  }
};

template <class V>
struct WriteLinesUnsorted {
  static constexpr std::string_view kName = "write_lines_unsorted";
  struct Ports {
    In<&Streams::chunk_state> state;
    Shared<&Streams::layers> layer;
    In<&Streams::curves> curves;
    Out<&Streams::line_vertices> vertices;
  };

  static void Run(const Ports& ports) {
    write_lines_detail::WritePiece<V>(
        *ports.layer, ports.state->live_strands,
        [&](uint32_t i) __attribute__((always_inline)) { return &ports.curves->record[i]; },
        *ports.vertices);
  }
};

}  // namespace pelt
