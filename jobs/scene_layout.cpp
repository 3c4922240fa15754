// From grooms to a scene's shape and memory: what belongs to what, how many bytes each stream
// takes, and what to say of it.

#include <algorithm>

#include "core/float_rules.hpp"
#include "core/format.hpp"
#include "core/groom/groom_file.hpp"
#include "jobs/scene.hpp"

namespace pelt {
namespace {

uint32_t KindOf(const LayerParams& p) {
  uint32_t kind = 0;
  if (p.chain == ChainKind::kVertex) kind |= kLayerVertexChains;
  if (p.points == 5) kind |= kLayerFivePoints;
  if (p.solver == Solver::kVerlet) kind |= kLayerVerlet;
  if (p.solver == Solver::kModal) kind |= kLayerModal;
  if (p.output == Output::kRibbons) kind |= kLayerRibbons;
  return kind;
}

void AddLayers(const Groom& groom, uint32_t character, uint32_t piecewise_chunks,
               SceneShape& shape) {
  for (const GroomLayer& layer : groom.layers) {
    uint32_t kind = KindOf(layer.params);
    if (layer.chunk_count > piecewise_chunks) kind |= kLayerSortInPieces;
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
  uint32_t count = 0;
  for (uint32_t l = 0; l < shape.layer_count; ++l)
    if (desc.kinds.Admits(shape.layer_kind[l])) count += shape.LayerChunks(l);
  return count;
}

// What no file was read for may hold anything: kernels would follow its indices, and memory would
// be asked for by its counts. A groom of several characters is looked at once. Empty: all is well.
std::string FindFaultOf(std::span<const Groom* const> grooms) {
  for (size_t c = 0; c < grooms.size(); ++c) {
    if (!grooms[c]) return Format("character {} has no groom", c);
    const auto before = grooms.first(c);
    if (std::find(before.begin(), before.end(), grooms[c]) != before.end()) continue;
    std::string fault = FindGroomFault(*grooms[c], Format("of character {}", c));
    if (!fault.empty()) return fault;
  }
  return {};
}

}  // namespace

std::optional<SceneLayout> TryMeasureScene(std::span<const Groom* const> grooms,
                                           const SceneOptions& options, std::string& error) {
  SceneLayout layout;
  if (std::string fault = FindFaultOf(grooms); !fault.empty()) {
    error = std::move(fault);
    return std::nullopt;
  }
  layout.shape = ShapeOf(grooms, options);
  if (grooms.empty() || layout.shape.chunk_count == 0) {
    error = "a scene needs at least one groom with one chunk of strands";
    return std::nullopt;
  }
  if (layout.shape.layer_count > kLayersPerScene) {
    error = Format("the scene has {} layers, {} more than a draw list holds",
                   layout.shape.layer_count, layout.shape.layer_count - kLayersPerScene);
    return std::nullopt;
  }
  for (uint32_t s = 0; s < kStreamCount; ++s) {
    const StreamDesc& desc = DescribeStream(Stream(s));
    const uint32_t blocks = desc.block_bytes ? BlockCount(layout.shape, desc) : 0;
    layout.ranges.push_back({desc.name, uint64_t(blocks) * desc.block_bytes, blocks, desc.role});
    layout.total_bytes += layout.ranges.back().bytes;
  }
  for (const Groom* groom : grooms)
    for (const GroomLayer& layer : groom->layers) layout.strand_count += layer.strand_count;
  if (options.memory_budget_bytes != 0) {
    error = FindBudgetFault(layout, options.memory_budget_bytes);
    if (!error.empty()) return std::nullopt;
  }
  return layout;
}

std::string FindBudgetFault(const SceneLayout& layout, uint64_t budget_bytes) {
  if (layout.total_bytes <= budget_bytes) return {};
  std::string text = Format(
      "the scene needs {} bytes, {} more than its memory budget of {}; the largest ranges are",
      layout.total_bytes, layout.total_bytes - budget_bytes, budget_bytes);
  std::vector<MemoryRange> ranges = layout.ranges;
  constexpr size_t kNamed = 4;
  std::stable_sort(ranges.begin(), ranges.end(),
                   [](const MemoryRange& a, const MemoryRange& b) { return a.bytes > b.bytes; });
  for (size_t i = 0; i < kNamed; ++i)
    text += Format("{} {} ({} bytes)", i ? "," : "", ranges[i].name, ranges[i].bytes);
  const double share = double(budget_bytes) / double(layout.total_bytes);
  text += Format(
      "; about {:.0f} of its {} strands would fit: lower density or max_strands in the fur setup, "
      "or leave out layers or characters",
      share * double(layout.strand_count), layout.strand_count);
  if (layout.ranges[size_t(StreamOf<&Streams::ribbon_vertices>)].bytes != 0)
    text += "; layers with output = \"instances\" need less than ribbons";
  return text;
}

std::string DescribeMemory(const SceneLayout& layout) {
  std::string out = Format("{:<18} {:>8} {:>12}  {}\n", "memory", "blocks", "bytes", "role");
  for (const MemoryRange& range : layout.ranges)
    if (range.bytes)
      out += Format("{:<18} {:>8} {:>12}  {}\n", range.name, range.blocks, range.bytes,
                    RoleName(range.role));
  out += Format("{:<18} {:>8} {:>12}  {:.0f} a strand, {:.1f} of them simulation state\n", "all",
                "", layout.total_bytes, double(layout.total_bytes) / double(layout.strand_count),
                layout.StateBytesPerStrand());
  return out;
}

double SceneLayout::StateBytesPerStrand() const {
  uint64_t bytes = 0;
  for (size_t s = 0; s < ranges.size(); ++s)
    if (DescribeStream(Stream(s)).kept == Kept::kState) bytes += ranges[s].bytes;
  return double(bytes) / double(strand_count);
}

}  // namespace pelt
