// What vertices a layer may have: one entry for each format. A new format is a kernel that writes it,
// its stream, and an entry here; setups, groom files, the plan, Draws() and the reports read the entry.
//
// Entries are in the order of Output, whose values are in groom files. A format's bytes, and the
// shaders that read them, are described in jobs/DRAWING.md.
#pragma once

#include <array>
#include <iterator>
#include <type_traits>

#include "core/streams.hpp"

namespace pelt {

enum class VertexOrder : uint8_t {
  kSorted,      // vertices lie in draw order
  kIndexBuffer  // vertices lie in strand order; the stream `order` is the sorted index buffer
};

// One strand for those who draw in another way: points on its curve at equal parameters, root
// first, in the world.
struct StrandCurve {
  float point[kRibbonPoints][4];  // x, y, z, full width; m
  uint32_t base_colour;           // 0xAABBGGRR; alpha carries the LOD fade
  uint32_t tip_colour;
  uint32_t strand;  // its number in its layer, the same in every frame
  uint32_t film_strip;
};

// What a vertex is, by the address.
template <class Vertex>
inline constexpr char kVertexType = 0;

struct OutputEntry {
  std::string_view name;  // in setups, and for those who draw
  uint32_t flag;          // the LayerFlag of its layers; of the first entry 0
  // Where the vertices are: with VertexOrder::kSorted, and with kIndexBuffer.
  Stream in_draw_order, in_strand_order;
  const void* vertex_type;  // address of kVertexType of it
  uint32_t vertex_bytes, vertices_per_strand;
  bool faces_eye;  // vertices depend on where the eye is
  // The strands' curves, in strand order, and how one record is read; kNone and null of vertices
  // that are the skin's.
  Stream curves;
  uint32_t curve_bytes;
  StrandCurve (*read_curve)(const std::byte* record, float tip_width);

  constexpr bool OfStrands() const { return read_curve != nullptr; }
  constexpr uint32_t StrandBytes() const { return vertex_bytes * vertices_per_strand; }
};

namespace outputs_detail {

StrandCurve ReadCurve(const CurveRecord& record, float tip_width);
StrandCurve ReadCurve(const RibbonRecord& record, float tip_width);

template <class Block>
StrandCurve ReadCurveAt(const std::byte* record, float tip_width) {
  using Record = std::remove_extent_t<decltype(Block::record)>;
  return ReadCurve(*reinterpret_cast<const Record*>(record), tip_width);
}

// Vertex is one of kVerticesPerStrand that a block of kInDrawOrder has for each strand.
template <auto kInDrawOrder, auto kInStrandOrder, auto kCurves, class Vertex>
constexpr OutputEntry Entry(std::string_view name, uint32_t flag, bool faces_eye) {
  constexpr uint32_t kBytes = sizeof(BlockOf<kInDrawOrder>) / kStrandsPerChunk;
  static_assert(sizeof(BlockOf<kInStrandOrder>) / kStrandsPerChunk == kBytes);
  static_assert(kBytes % sizeof(Vertex) == 0);
  return {name,
          flag,
          StreamOf<kInDrawOrder>,
          StreamOf<kInStrandOrder>,
          &kVertexType<Vertex>,
          sizeof(Vertex),
          kBytes / sizeof(Vertex),
          faces_eye,
          StreamOf<kCurves>,
          sizeof(BlockOf<kCurves>) / kStrandsPerChunk,
          &ReadCurveAt<BlockOf<kCurves>>};
}

// A vertex for each of the chunk's mesh vertices, which are in no drawing order.
template <auto kVertices, class Vertex>
constexpr OutputEntry SkinEntry(std::string_view name, uint32_t flag) {
  static_assert(sizeof(BlockOf<kVertices>) == kVerticesPerChunk * sizeof(Vertex));
  return {name,
          flag,
          StreamOf<kVertices>,
          StreamOf<kVertices>,
          &kVertexType<Vertex>,
          sizeof(Vertex),
          1,
          false,
          Stream::kNone,
          0,
          nullptr};
}

inline constexpr OutputEntry kEntries[] = {
    Entry<&Streams::instances, &Streams::curves, &Streams::curves, CurveRecord>("instances", 0,
                                                                                false),
    Entry<&Streams::ribbon_vertices, &Streams::ribbon_vertices, &Streams::ribbons, RibbonVertex>(
        "ribbons", kLayerRibbons, true),
    Entry<&Streams::line_vertices, &Streams::line_vertices, &Streams::curves, LineVertex>(
        "lines", kLayerLines, false),
    SkinEntry<&Streams::shell_vertices, ShellVertex>("shells", kLayerShells),
};

constexpr auto NamesOf() {
  std::array<std::string_view, std::size(kEntries)> names;
  for (size_t i = 0; i < names.size(); ++i) names[i] = kEntries[i].name;
  return names;
}

constexpr uint32_t FlagsOf(bool eye_facing_only) {
  uint32_t flags = 0;
  for (const OutputEntry& entry : kEntries)
    if (entry.faces_eye || !eye_facing_only) flags |= entry.flag;
  return flags;
}
static_assert(FlagsOf(false) == kLayerOutputFlags);

}  // namespace outputs_detail

inline constexpr auto& kOutputs = outputs_detail::kEntries;
inline constexpr uint32_t kOutputCount = std::size(kOutputs);
inline constexpr auto kOutputNames = outputs_detail::NamesOf();
// Of layers whose vertices depend on where the eye is.
inline constexpr uint32_t kEyeFacingFlags = outputs_detail::FlagsOf(true);

// The output whose vertices a stream has; null for other streams.
constexpr const OutputEntry* FindOutputIn(Stream stream) {
  for (const OutputEntry& entry : kOutputs)
    if (entry.in_draw_order == stream || entry.in_strand_order == stream) return &entry;
  return nullptr;
}
// The place in kOutputs (Output, core/groom/layer_params.hpp) of layers of this kind.
constexpr uint32_t OutputOf(uint32_t layer_kind) {
  for (uint32_t i = 1; i < kOutputCount; ++i)
    if (layer_kind & kOutputs[i].flag) return i;
  return 0;
}

}  // namespace pelt
