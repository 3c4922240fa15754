// From grooms to a scene's shape and memory: what belongs to what, and how many bytes each stream
// takes.

#include <fmt/format.h>

#include <algorithm>

#include "core/error.hpp"
#include "jobs/scene.hpp"

namespace pelt {
namespace {

uint32_t KindOf(const LayerParams& p) {
  uint32_t kind = 0;
  if (p.chain == ChainKind::kVertex) kind |= kLayerVertexChains;
  if (p.points == 5) kind |= kLayerFivePoints;
  if (p.solver == Solver::kVerlet) kind |= kLayerVerlet;
  if (p.output == Output::kRibbons) kind |= kLayerRibbons;
  return kind;
}

void AddLayers(const Groom& groom, uint32_t character, uint32_t piecewise_chunks,
               SceneShape& shape) {
  for (const GroomLayer& layer : groom.layers) {
    uint32_t kind = KindOf(layer.params);
    if (layer.chunk_count > piecewise_chunks) kind |= kKindSortInPieces;
    shape.layer_kind.push_back(kind);
    shape.layer_character.push_back(character);
    shape.layer_first_chunk.push_back(shape.chunk_count);
    shape.chunk_layer.insert(shape.chunk_layer.end(), layer.chunk_count, shape.layer_count);
    shape.chunk_count += layer.chunk_count;
    ++shape.layer_count;
  }
}

SceneShape ShapeOf(std::span<const Groom* const> grooms, const SceneOptions& options) {
  SceneShape shape;
  const uint32_t piecewise = options.piecewise_sort_chunks ? options.piecewise_sort_chunks
                             : options.plan.must_fit
                                 ? SortableChunks(options.plan.local_store_data_bytes)
                                 : ~0u;
  for (const Groom* groom : grooms) AddLayers(*groom, shape.character_count++, piecewise, shape);
  shape.layer_first_chunk.push_back(shape.chunk_count);
  return shape;
}

uint32_t BlockCount(const SceneShape& shape, const StreamDesc& desc) {
  if (desc.domain != Domain::kChunk) return shape.ItemCount(desc.domain);
  const KindMask mask{desc.required, desc.forbidden};
  uint32_t count = 0;
  for (uint32_t l = 0; l < shape.layer_count; ++l)
    if (mask.Admits(shape.layer_kind[l])) count += shape.LayerChunks(l);
  return count;
}

}  // namespace

SceneLayout MeasureScene(std::span<const Groom* const> grooms, const SceneOptions& options) {
  SceneLayout layout;
  layout.shape = ShapeOf(grooms, options);
  if (grooms.empty() || layout.shape.chunk_count == 0)
    throw Error("a scene needs at least one groom with one chunk of strands");
  if (layout.shape.layer_count > kLayersPerScene)
    throw Error(fmt::format("the scene has {} layers, {} more than a draw list holds",
                            layout.shape.layer_count, layout.shape.layer_count - kLayersPerScene));
  for (uint32_t s = 0; s < kStreamCount; ++s) {
    const StreamDesc& desc = DescribeStream(Stream(s));
    const uint32_t blocks = desc.block_bytes ? BlockCount(layout.shape, desc) : 0;
    layout.ranges.push_back({desc.name, uint64_t(blocks) * desc.block_bytes, blocks, desc.role});
    layout.total_bytes += layout.ranges.back().bytes;
  }
  for (const Groom* groom : grooms)
    for (const GroomLayer& layer : groom->layers) layout.strand_count += layer.strand_count;
  return layout;
}

double SceneLayout::StateBytesPerStrand() const {
  // Points without a last frame (strands that follow vertex chains) are made anew each frame: no
  // state.
  uint64_t bytes = 0;
  for (Stream s : {Stream::kVertexPrevious, Stream::kStrandPrevious4, Stream::kStrandPrevious5})
    bytes += 2 * ranges[size_t(s)].bytes;
  return double(bytes) / double(strand_count);
}

}  // namespace pelt
