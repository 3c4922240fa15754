#include "bench/report/layer_costs.hpp"

#include <algorithm>
#include <numeric>

namespace pelt {
namespace {

void AddSpreadTo(JsonText& json, const Spread& ms) {
  json.BeginObject("core_ms");
  json.Add("median", ms.median);
  json.Add("p95", ms.p95);
  json.Add("worst", ms.worst);
  json.EndObject();
}

}  // namespace

LayerCosts::LayerCosts(const FurScene& scene)
    : scene_(scene),
      ticks_(scene.shape().layer_count + scene.shape().character_count + 1),
      stage_ticks_(scene.shape().layer_count, std::vector<uint64_t>(scene.plan().stages.size())) {}

void LayerCosts::Add(const FrameRecord& record) {
  const SceneShape& shape = scene_.shape();
  for (std::vector<uint64_t>& frames : ticks_) frames.push_back(0);
  for (const FrameRecord::Item& item : record.items) {
    const Domain domain = scene_.plan().passes[item.pass].domain;
    for (uint32_t r = item.first_run; r < item.first_run + item.run_count; ++r) {
      const FrameRecord::StageRun& run = record.runs[r];
      size_t row = ticks_.size() - 1;
      if (domain == Domain::kCharacter) row = shape.layer_count + item.item;
      if (domain >= Domain::kLayer) {
        row = domain == Domain::kChunk ? shape.chunk_layer[item.item] : item.item;
        stage_ticks_[row][run.stage] += run.Ticks();
      }
      ticks_[row].back() += run.Ticks();
    }
  }
}

Spread LayerCosts::SpreadOfFrames(double ms_per_tick, const std::vector<uint32_t>& rows) const {
  std::vector<double> ms(ticks_.front().size());
  for (const uint32_t row : rows)
    for (size_t f = 0; f < ms.size(); ++f) ms[f] += double(ticks_[row][f]) * ms_per_tick;
  return SpreadOf(ms);
}

void LayerCosts::AddTo(JsonText& json, double ms_per_tick,
                       std::span<const uint32_t> layer_strands) const {
  const SceneShape& shape = scene_.shape();
  json.BeginArray("layer_costs");
  for (uint32_t l = 0; l < shape.layer_count; ++l) {
    const std::vector<uint64_t>& stages = stage_ticks_[l];
    const auto most = std::max_element(stages.begin(), stages.end());
    const uint64_t all = std::accumulate(stages.begin(), stages.end(), uint64_t{0});
    json.BeginObject();
    json.Add("name", scene_.LayerName(l));
    json.Add("character", shape.layer_character[l]);
    json.Add("strands", layer_strands[l]);
    json.Add("chunks", shape.LayerChunks(l));
    AddSpreadTo(json, SpreadOfFrames(ms_per_tick, {l}));
    json.Add("most_stage", most - stages.begin());
    json.Add("most_share", all ? double(*most) / double(all) : 0.0);
    json.EndObject();
  }
  json.EndArray();
  json.BeginArray("character_costs");
  for (uint32_t c = 0; c < shape.character_count; ++c) {
    std::vector<uint32_t> rows = {shape.layer_count + c};
    uint64_t strands = 0;
    for (uint32_t l = 0; l < shape.layer_count; ++l) {
      if (shape.layer_character[l] != c) continue;
      rows.push_back(l);
      strands += layer_strands[l];
    }
    json.BeginObject();
    json.Add("layers", rows.size() - 1);
    json.Add("strands", strands);
    AddSpreadTo(json, SpreadOfFrames(ms_per_tick, rows));
    json.Add("own_ms", SpreadOfFrames(ms_per_tick, {shape.layer_count + c}).median);
    json.EndObject();
  }
  json.EndArray();
  json.BeginObject("scene_cost");
  AddSpreadTo(json, SpreadOfFrames(ms_per_tick, {uint32_t(ticks_.size() - 1)}));
  json.EndObject();
  json.BeginObject("cost");
  std::vector<uint32_t> all(ticks_.size());
  std::iota(all.begin(), all.end(), 0u);
  AddSpreadTo(json, SpreadOfFrames(ms_per_tick, all));
  json.EndObject();
}

}  // namespace pelt
