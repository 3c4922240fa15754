// From grooms to a scene's shape and memory: what belongs to what, how many bytes each stream
// takes, and what to say of it.

#include <algorithm>

#include "core/float_rules.hpp"
#include "core/format.hpp"
#include "core/groom/groom_file.hpp"
#include "core/kernels/sort_layer.hpp"
#include "core/layer_block.hpp"
#include "core/outputs.hpp"
#include "jobs/scene.hpp"

namespace pelt {
namespace {

void AddLayers(const Groom& groom, uint32_t character, uint32_t piecewise_chunks,
               const SceneOptions& options, SceneShape& shape) {
  for (const GroomLayer& layer : groom.layers) {
    uint32_t kind = LayerKind(layer.params);
    if (layer.chunk_count > piecewise_chunks) kind |= kLayerSortInPieces;
    if (options.velocities && (kind & kLayerModal)) kind |= kLayerRates;
    if (options.origins) kind |= kLayerApart;
    shape.AddLayer(character, kind, layer.chunk_count, layer.patch_count);
  }
}

// What the sort of a layer has of a local store.
uint32_t SortBytes(const PlanOptions& plan) {
  const uint32_t code = plan.code_bytes ? plan.code_bytes("sort_layer") : 0;
  return code > 0 ? plan.code_and_data_bytes - code : plan.local_store_data_bytes;
}

SceneShape ShapeOf(std::span<const Groom* const> grooms, const SceneOptions& options) {
  SceneShape shape;
  const uint32_t piecewise = options.piecewise_sort_chunks ? options.piecewise_sort_chunks
                             : options.plan.must_fit       ? SortableChunks(SortBytes(options.plan))
                                                           : ~0u;
  for (uint32_t c = 0; c < grooms.size(); ++c) AddLayers(*grooms[c], c, piecewise, options, shape);
  shape.character_count = uint32_t(grooms.size());  // the last may have no layers
  return shape;
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

Result<SceneLayout> MeasureScene(std::span<const Groom* const> grooms,
                                 const SceneOptions& options) {
  SceneLayout layout;
  if (std::string fault = FindFaultOf(grooms); !fault.empty()) return Failure{std::move(fault)};
  layout.shape = ShapeOf(grooms, options);
  if (grooms.empty() || layout.shape.chunk_count == 0)
    return Failure{"a scene needs at least one groom with one chunk of strands"};
  if (layout.shape.layer_count > kLayersPerScene)
    return Failure{Format("the scene has {} layers, {} more than a draw list holds",
                          layout.shape.layer_count, layout.shape.layer_count - kLayersPerScene)};
  for (uint32_t s = 0; s < kStreamCount; ++s) {
    const StreamDesc& desc = DescribeStream(Stream(s));
    const uint32_t blocks = CountBlocks(desc, layout.shape);
    layout.ranges.push_back({desc.name, uint64_t(blocks) * desc.block_bytes, blocks, desc.role});
    layout.total_bytes += layout.ranges.back().bytes;
  }
  for (const Groom* groom : grooms)
    for (const GroomLayer& layer : groom->layers) layout.strand_count += layer.strand_count;
  if (options.memory_budget_bytes != 0) {
    std::string fault = FindBudgetFault(layout, options.memory_budget_bytes);
    if (!fault.empty()) return Failure{std::move(fault)};
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
  const auto less = [](const OutputEntry& a, const OutputEntry& b) {
    return a.OfStrands() && (!b.OfStrands() || a.StrandBytes() < b.StrandBytes());
  };
  const OutputEntry& least = *std::min_element(std::begin(kOutputs), std::end(kOutputs), less);
  for (const OutputEntry& output : kOutputs)
    if (output.OfStrands() && less(least, output) &&
        layout.ranges[size_t(output.in_draw_order)].bytes != 0)
      text += Format("; layers with output = \"{}\" need less than {}", least.name, output.name);
  return text;
}

std::string DescribeMemory(const SceneLayout& layout) {
  std::string out = Format("{:<18} {:>8} {:>12}  {}\n", "memory", "blocks", "bytes", "role");
  for (const MemoryRange& range : layout.ranges)
    if (range.bytes)
      out += Format("{:<18} {:>8} {:>12}  {}\n", range.name, range.blocks, range.bytes,
                    RoleName(range.role));
  out += Format("{:<18} {:>8} {:>12}  {:.0f} per strand, {:.1f} of them simulation state\n", "all",
                "", layout.total_bytes, double(layout.total_bytes) / double(layout.strand_count),
                layout.StateBytesPerStrand());
  return out;
}

double SceneLayout::StateBytesPerStrand() const {
  uint64_t bytes = 0;
  for (size_t s = 0; s < ranges.size(); ++s)
    if (ranges[s].role != Role::kInput && DescribeStream(Stream(s)).kept == Kept::kState)
      bytes += ranges[s].bytes;
  return double(bytes) / double(strand_count);
}

}  // namespace pelt
