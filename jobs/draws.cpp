#include "jobs/draws.hpp"

#include <algorithm>
#include <bit>

#include "core/float_environment.hpp"
#include "core/float_rules.hpp"
#include "core/kernels/modal_contact.hpp"
#include "core/kernels/modal_curve.hpp"

namespace pelt {
namespace {

uint32_t CountUncut(const ChunkStateBlock& chunk) {
  uint32_t cut = 0;
  for (uint32_t first = 0; first < chunk.live_strands; first += 32) {
    const uint32_t lanes = std::min(chunk.live_strands - first, 32u);
    cut += uint32_t(std::popcount(chunk.cut[first / 32] & ~0u >> (32 - lanes)));
  }
  return chunk.live_strands - cut;
}

void AddStrands(const FrameMemory& memory, VertexOrder vertex_order, uint32_t first,
                uint32_t chunks, LayerDraw& draw) {
  draw.strand_count = memory.Of<&Streams::layer_sort>(draw.layer)->visible_count;
  draw.order = {memory.Of<&Streams::order>(first)->strand, draw.strand_count};
  for (uint32_t c = first; c < first + chunks; ++c)
    draw.live_strands += CountUncut(*memory.Of<&Streams::chunk_state>(c));
  if (memory.shape->layer_kind[draw.layer] & kLayerLit)
    draw.looks = {memory.Of<&Streams::looks>(first)->record, size_t(chunks) * kStrandsPerChunk};
  const OutputEntry& entry = draw.format();
  const bool sorted = vertex_order == VertexOrder::kSorted;
  const size_t strands = sorted ? draw.strand_count : size_t(chunks) * kStrandsPerChunk;
  draw.vertices = {memory.Block(sorted ? entry.in_draw_order : entry.in_strand_order, first),
                   strands * entry.StrandBytes()};
}

void AddShells(const FrameMemory& memory, LayerDraw& draw) {
  draw.shells = FindShells(memory, draw.layer);
  draw.vertices = {
      memory.Block(draw.format().in_draw_order, memory.shape->layer_first_patch[draw.layer]),
      draw.shells.skin.size() * sizeof(ShellVertexBlock)};
}

// The patches and chunks of a layer lie one behind the other in every stream: its vertices are one span.
LayerDraw MakeDraw(const FrameMemory& memory, VertexOrder vertex_order, uint32_t layer) {
  const SceneShape& shape = *memory.shape;
  const uint32_t first = shape.layer_first_chunk[layer], chunks = shape.LayerChunks(layer);
  const BoundsBlock& box = *memory.Of<&Streams::bounds>(layer);
  LayerDraw draw{};
  draw.layer = layer;
  draw.output = Output(OutputOf(shape.layer_kind[layer]));
  std::copy_n(box.low, 3, draw.low);
  std::copy_n(box.high, 3, draw.high);
  const LayerBlock& params = *memory.Of<&Streams::layers>(layer);
  draw.tip_width = params.tip_width;
  draw.wet_darken = 1.0f;
  if (shape.layer_kind[layer] & kLayerPainted) {
    draw.wet_darken = params.darken;
    std::copy_n(params.dirt_colour, 3, draw.mud_colour);
  }
  if (shape.layer_kind[layer] & kLayerLit) draw.light = memory.Of<&Streams::layer_light>(layer);
  if (draw.format().OfStrands())
    AddStrands(memory, vertex_order, first, chunks, draw);
  else
    AddShells(memory, draw);
  return draw;
}

}  // namespace

void FindDraws(const FrameMemory& memory, VertexOrder vertex_order, std::vector<LayerDraw>& draws) {
  const DrawListBlock& list = *memory.Of<&Streams::draw_list>(0);
  for (uint32_t i = 0; i < list.count; ++i)
    draws.push_back(MakeDraw(memory, vertex_order, list.layer[i]));
}

uint32_t CopyCurves(const FrameMemory& memory, uint32_t layer, std::span<StrandCurve> out) {
  const FloatEnvironment guard;
  const SceneShape& shape = *memory.shape;
  if (layer >= shape.layer_count) return 0;
  const OutputEntry& entry = kOutputs[OutputOf(shape.layer_kind[layer])];
  if (!entry.OfStrands()) return 0;
  const float tip_width = memory.Of<&Streams::layers>(layer)->tip_width;
  size_t written = 0;
  for (uint32_t c = shape.layer_first_chunk[layer]; c < shape.layer_first_chunk[layer + 1]; ++c) {
    const std::byte* records = memory.Block(entry.curves, c);
    const ChunkStateBlock& chunk = *memory.Of<&Streams::chunk_state>(c);
    for (uint32_t i = 0; i < chunk.live_strands && written < out.size(); ++i)
      if (!IsCut(chunk, i))
        out[written++] = entry.read_curve(records + i * entry.curve_bytes, tip_width);
  }
  return uint32_t(written);
}

uint32_t FindShadowPlaces(const FrameMemory& memory, VertexOrder vertex_order, uint32_t layer,
                          float share, std::span<uint32_t> places) {
  const SceneShape& shape = *memory.shape;
  if (layer >= shape.layer_count || (shape.layer_kind[layer] & kLayerShells)) return 0;
  const uint32_t first = shape.layer_first_chunk[layer];
  const uint32_t* const order = memory.Of<&Streams::order>(first)->strand;
  const uint32_t drawn = memory.Of<&Streams::layer_sort>(layer)->visible_count;
  uint32_t count = 0;
  for (uint32_t i = 0; i < drawn; ++i) {
    const uint32_t chunk = first + order[i] / kStrandsPerChunk;
    if (!IsAmongFirst(*memory.Of<&Streams::chunk_state>(chunk), order[i], share)) continue;
    if (count < places.size()) places[count] = vertex_order == VertexOrder::kSorted ? i : order[i];
    ++count;
  }
  return count;
}

PointBlock<4> CopyChainPoints(const FrameMemory& memory, uint32_t patch) {
  const uint32_t number = memory.shape->patch_layer[patch];
  if (!(memory.shape->layer_kind[number] & kLayerModal))
    return *memory.Of<&Streams::vertex_points>(patch);
  const FloatEnvironment guard;
  using V = ArrayVec<4>;
  constexpr uint32_t N = NodesOf(4);
  const ModalTableBlock& table = *memory.Of<&Streams::modal_tables>(number);
  const RestBlock<4>& rest_block = *memory.Of<&Streams::vertex_rest>(patch);
  const ModalStateBlock<N>& state = *memory.Of<&Streams::vertex_modal>(patch);
  PointBlock<4> points;
  for (uint32_t lane = 0; lane < kVerticesPerChunk; lane += V::kLanes) {
    chain::Group<V, N> g;
    chain::LoadGroom<V, 4>(rest_block, *memory.Of<&Streams::anchors>(patch), 0.0f,
                           memory.Of<&Streams::layers>(number)->scale, lane, g);
    Vec3<V> rest[N], d[N];
    modal::RestTangents(table, g, V(1.0f) / g.length, rest);
    for (uint32_t i = 0; i < N; ++i) d[i] = Load3<V>(state.direction[i], lane);
    modal::DrawCurve(table, d, rest, g);
    const V strength = V::Load(rest_block.strength + lane);
    modal::Weaken(strength >= V(1.0f), strength, g);
    for (uint32_t i = 0; i < N; ++i) Store3(points.position[i], lane, g.root + g.point[i]);
  }
  return points;
}

namespace {
std::span<const FinBlock> FindFins(const FrameMemory& memory, uint32_t layer, uint32_t first,
                                   uint32_t chunks) {
  if (!(memory.shape->layer_kind[layer] & kLayerFins)) return {};
  return {memory.Of<&Streams::fins>(first), chunks};
}
}  // namespace

ShellDraw FindShells(const FrameMemory& memory, uint32_t layer) {
  const SceneShape& shape = *memory.shape;
  if (layer >= shape.layer_count || !(shape.layer_kind[layer] & kLayerShells)) return {};
  const uint32_t first = shape.layer_first_chunk[layer], chunks = shape.LayerChunks(layer);
  const ShellLodBlock& lod = *memory.Of<&Streams::shell_lod>(layer);
  return {
      {lod.shell, lod.count},
      lod.texture_repeat,
      memory.Of<&Streams::shell_layers>(layer)->shadow,
      {memory.Of<&Streams::shell_skin>(shape.layer_first_patch[layer]), shape.LayerPatches(layer)},
      {memory.Of<&Streams::strands>(first), chunks},
      {memory.Of<&Streams::halo>(first), chunks},
      FindFins(memory, layer, first, chunks)};
}

uint32_t WriteShellIndices(const ShellDraw& shells, std::span<uint32_t> indices) {
  uint32_t count = 0;
  for (uint32_t c = 0; c < shells.triangles.size(); ++c) {
    const StrandBlock& block = shells.triangles[c];
    for (uint32_t t = 0; t < block.strand_count; ++t)
      for (const auto& corner : block.vertex) {
        if (count < indices.size()) indices[count] = shells.halo[c].vertex[corner[t]];
        ++count;
      }
  }
  return count;
}

uint32_t WriteFins(const ShellDraw& shells, std::span<Fin> fins) {
  uint32_t count = 0;
  for (uint32_t c = 0; c < shells.fins.size(); ++c) {
    const StrandBlock& block = shells.triangles[c];
    for (uint32_t t = 0; t < block.strand_count; ++t)
      for (uint32_t k = 0; k < 3; ++k) {
        const uint32_t fade = shells.fins[c].fade[t] >> 8 * k & 255u;
        if (fade == 0) continue;
        const auto corner = [&](uint32_t i) { return shells.halo[c].vertex[block.vertex[i][t]]; };
        if (count < fins.size()) fins[count] = {corner(k), corner((k + 1) % 3), fade};
        ++count;
      }
  }
  return count;
}

}  // namespace pelt
