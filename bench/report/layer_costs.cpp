#include <algorithm>
#include <numeric>

#include "bench/report/budget.hpp"

namespace pelt {
namespace {

Spread SpreadOfCopy(std::vector<double> ms) { return SpreadOf(ms); }

}  // namespace

LayerCosts::LayerCosts(const FurScene& scene, uint32_t frames)
    : scene_(scene),
      ticks_(scene.shape().layer_count + scene.shape().character_count + 1),
      stage_ticks_(scene.shape().layer_count, std::vector<uint64_t>(scene.plan().stages.size())) {
  for (std::vector<uint64_t>& row : ticks_) row.reserve(frames);
}

void LayerCosts::BeginFrame() {
  for (std::vector<uint64_t>& row : ticks_) row.push_back(0);
}

void LayerCosts::Add(uint32_t stage, uint32_t item, uint64_t ticks) {
  const SceneShape& shape = scene_.shape();
  const Domain domain = scene_.plan().stages[stage].domain;
  size_t row = ticks_.size() - 1;
  if (domain == Domain::kCharacter) row = shape.layer_count + item;
  if (domain >= Domain::kLayer) {
    row = shape.LayerOf(domain, item);
    stage_ticks_[row][stage] += ticks;
  }
  ticks_[row].back() += ticks;
}

std::vector<double> LayerCosts::FrameSums(double ms_per_tick,
                                          const std::vector<uint32_t>& rows) const {
  std::vector<double> ms(ticks_.front().size());
  for (const uint32_t row : rows)
    for (size_t f = 0; f < ms.size(); ++f) ms[f] += double(ticks_[row][f]) * ms_per_tick;
  return ms;
}

CostSplit LayerCosts::Summarise(double ms_per_tick, std::span<const uint32_t> layer_strands) const {
  const SceneShape& shape = scene_.shape();
  CostSplit split;
  std::vector<std::vector<uint32_t>> rows_of;  // of each character
  for (uint32_t c = 0; c < shape.character_count; ++c) rows_of.push_back({shape.layer_count + c});
  split.characters.resize(shape.character_count);
  for (uint32_t l = 0; l < shape.layer_count; ++l) {
    const std::vector<uint64_t>& stages = stage_ticks_[l];
    const auto most = std::max_element(stages.begin(), stages.end());
    const uint64_t all = std::accumulate(stages.begin(), stages.end(), uint64_t{0});
    LayerCost layer;
    layer.name = scene_.LayerName(l);
    layer.character = shape.layer_character[l];
    layer.chunks = shape.LayerChunks(l);
    layer.strands = layer_strands[l];
    layer.samples_ms = FrameSums(ms_per_tick, {l});
    layer.core_ms = SpreadOfCopy(layer.samples_ms);
    layer.dearest_stage = uint32_t(most - stages.begin());
    layer.dearest_share = all ? double(*most) / double(all) : 0.0;
    rows_of[layer.character].push_back(l);
    ++split.characters[layer.character].layers;
    split.characters[layer.character].strands += layer.strands;
    split.layers.push_back(std::move(layer));
  }
  for (uint32_t c = 0; c < shape.character_count; ++c) {
    CharacterCost& character = split.characters[c];
    character.samples_ms = FrameSums(ms_per_tick, rows_of[c]);
    character.core_ms = SpreadOfCopy(character.samples_ms);
    character.own_ms = SpreadOfCopy(FrameSums(ms_per_tick, {shape.layer_count + c})).median;
  }
  split.scene_ms = SpreadOfCopy(FrameSums(ms_per_tick, {uint32_t(ticks_.size() - 1)}));
  std::vector<uint32_t> all(ticks_.size());
  std::iota(all.begin(), all.end(), 0u);
  split.all_ms = SpreadOfCopy(FrameSums(ms_per_tick, all));
  return split;
}

}  // namespace pelt
