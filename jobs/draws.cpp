#include "jobs/draws.hpp"

#include <algorithm>

#include "core/float_rules.hpp"

namespace pelt {
namespace {

// The chunks of a layer lie one behind the other in every stream: its vertices are one span.
LayerDraw MakeDraw(const FrameMemory& memory, VertexOrder vertex_order, uint32_t layer) {
  const SceneShape& shape = *memory.shape;
  const uint32_t first = shape.layer_first_chunk[layer], chunks = shape.LayerChunks(layer);
  const BoundsBlock& box = *memory.Of<&Streams::bounds>(layer);
  LayerDraw draw{};
  draw.layer = layer;
  draw.output = Output(OutputOf(shape.layer_kind[layer]));
  draw.strand_count = memory.Of<&Streams::layer_sort>(layer)->visible_count;
  draw.order = {memory.Of<&Streams::order>(first)->strand, draw.strand_count};
  for (uint32_t c = first; c < first + chunks; ++c)
    draw.live_strands += memory.Of<&Streams::chunk_state>(c)->live_strands;
  std::copy_n(box.low, 3, draw.low);
  std::copy_n(box.high, 3, draw.high);
  draw.tip_width = memory.Of<&Streams::layers>(layer)->tip_width;
  if (shape.layer_kind[layer] & kLayerLit) {
    draw.looks = {memory.Of<&Streams::looks>(first)->record, size_t(chunks) * kStrandsPerChunk};
    draw.light = memory.Of<&Streams::layer_light>(layer);
  }
  const OutputRow& row = draw.format();
  const bool sorted = vertex_order == VertexOrder::kSorted;
  const size_t strands = sorted ? draw.strand_count : size_t(chunks) * kStrandsPerChunk;
  draw.vertices = {memory.Block(sorted ? row.in_draw_order : row.in_strand_order, first),
                   strands * row.StrandBytes()};
  return draw;
}

}  // namespace

void FindDraws(const FrameMemory& memory, VertexOrder vertex_order, std::vector<LayerDraw>& draws) {
  const DrawListBlock& list = *memory.Of<&Streams::draw_list>(0);
  for (uint32_t i = 0; i < list.count; ++i)
    draws.push_back(MakeDraw(memory, vertex_order, list.layer[i]));
}

uint32_t CopyCurves(const FrameMemory& memory, uint32_t layer, std::span<StrandCurve> out) {
  const SceneShape& shape = *memory.shape;
  if (layer >= shape.layer_count) return 0;
  const OutputRow& row = kOutputs[OutputOf(shape.layer_kind[layer])];
  const float tip_width = memory.Of<&Streams::layers>(layer)->tip_width;
  size_t written = 0;
  for (uint32_t c = shape.layer_first_chunk[layer]; c < shape.layer_first_chunk[layer + 1]; ++c) {
    const std::byte* records = memory.Block(row.curves, c);
    const size_t live = memory.Of<&Streams::chunk_state>(c)->live_strands;
    const size_t end = std::min(out.size(), written + live);
    for (size_t i = 0; written < end; ++i, ++written)
      out[written] = row.read_curve(records + i * row.curve_bytes, tip_width);
  }
  return uint32_t(written);
}

}  // namespace pelt
