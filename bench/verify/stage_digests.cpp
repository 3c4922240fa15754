#include "bench/verify/stage_digests.hpp"

#include "core/streams.hpp"
#include "traces/digest.hpp"

namespace pelt {
namespace {

bool WritesItem(const Stage& stage, Stream stream, const SceneShape& shape, uint32_t item) {
  const StreamDesc& desc = DescribeStream(stream);
  if (desc.domain >= Domain::kLayer) {
    if (!stage.kinds.Admits(shape.layer_kind[shape.LayerOf(desc.domain, item)])) return false;
  }
  for (const PortDesc& port : stage.kernel.ports)
    if (port.stream == stream && IsWritten(port.access)) return true;
  return false;
}

// The number of the last stage that writes the item; the number of stages if none does.
size_t LastWriter(const Plan& plan, Stream stream, const SceneShape& shape, uint32_t item) {
  for (size_t s = plan.stages.size(); s-- > 0;)
    if (WritesItem(plan.stages[s], stream, shape, item)) return s;
  return plan.stages.size();
}

}  // namespace

StageDigests::StageDigests(const FurScene& scene) {
  const SceneShape& shape = scene.shape();
  const std::vector<Stage>& stages = scene.plan().stages;
  std::vector<std::vector<Column>> by_stage(stages.size());
  for (uint32_t s = 0; s < kStreamCount; ++s) {
    const StreamDesc& desc = DescribeStream(Stream(s));
    if (desc.role != Role::kValue) continue;
    for (uint32_t item = 0; item < shape.ItemCount(desc.domain); ++item) {
      if (!scene.memory().Block(Stream(s), item)) continue;
      const size_t writer = LastWriter(scene.plan(), Stream(s), shape, item);
      if (writer == stages.size()) continue;
      std::vector<Column>& columns = by_stage[writer];
      if (columns.empty() || columns.back().stream != Stream(s))
        columns.push_back({stages[writer].kernel.name, Stream(s), {}});
      columns.back().items.push_back(item);
    }
  }
  for (const std::vector<Column>& columns : by_stage)
    columns_.insert(columns_.end(), columns.begin(), columns.end());
}

DigestLog StageDigests::Begin(std::string_view scene_name, std::string_view settings,
                              VertexOrder vertex_order) const {
  DigestLog log;
  log.scene = scene_name;
  log.settings = settings;
  log.chunk_strands = kStrandsPerChunk;
  log.vertex_order = VertexOrderName(vertex_order);
  for (const Column& column : columns_)
    log.columns.push_back(
        {std::string(column.stage), std::string(DescribeStream(column.stream).name)});
  log.columns.push_back({std::string(kWholeFrameStage), "all"});
  return log;
}

void StageDigests::AddFrame(const FurScene& scene, DigestLog& log) const {
  for (const Column& column : columns_) {
    Digest digest;
    for (const uint32_t item : column.items) AddItem(digest, scene.memory(), column.stream, item);
    log.digests.push_back(digest.Value());
  }
  log.digests.push_back(scene.DigestFrame());
}

std::string_view VertexOrderName(VertexOrder order) {
  return order == VertexOrder::kSorted ? "sorted" : "index-buffer";
}

}  // namespace pelt
