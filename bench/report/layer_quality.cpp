#include "bench/report/layer_quality.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <numeric>

#include "core/groom/layer_params.hpp"
#include "core/modal/quality_on_screen.hpp"

namespace pelt {
namespace {

Value ShareOf(const LayerQuality& layer, ModalQuality quality) {
  const uint32_t all = std::reduce(layer.frames.begin(), layer.frames.end());
  return all ? Value(double(layer.frames[size_t(quality)]) / all) : Value();
}

// `named`: how many layers in text; which and whose in JSON.
void AddRow(const LayerQuality& layer, std::vector<Value> named, Show show, ReportTable& table) {
  const bool modal = !layer.asked.empty();
  std::vector<Value> values = std::move(named);
  values.emplace_back(layer.solver);
  values.push_back(modal ? Value(layer.asked) : Value());
  for (const auto quality : {ModalQuality::kFast, ModalQuality::kFine, ModalQuality::kBest})
    values.push_back(ShareOf(layer, quality));
  values.push_back(modal ? Value(1.0 / double(1u << layer.chain_level)) : Value());
  values.push_back(modal ? Value(double(layer.error_px)) : Value());
  table.Add(std::move(values), show);
}

std::string_view WordOf(auto LayerParams::*param, const LayerParams& params) {
  return LayerParamRowOf(param).words[size_t(params.*param)];
}

}  // namespace

std::vector<LayerQuality> QualitiesOf(const FurScene& scene, std::span<const Groom* const> grooms) {
  std::vector<LayerQuality> layers;
  for (uint32_t c = 0; c < grooms.size(); ++c)
    for (const GroomLayer& layer : grooms[c]->layers)
      layers.push_back({.name = std::string(scene.LayerName(uint32_t(layers.size()))),
                        .character = c,
                        .solver = WordOf(&LayerParams::solver, layer.params),
                        .asked = layer.params.solver == Solver::kModal
                                     ? WordOf(&LayerParams::quality, layer.params)
                                     : std::string_view()});
  return layers;
}

void AddFrame(const FurScene& scene, std::vector<LayerQuality>& layers) {
  for (uint32_t l = 0; l < layers.size(); ++l) {
    LayerQuality& layer = layers[l];
    if (layer.asked.empty()) continue;
    const ScreenQuality ran = scene.QualityOf(l);
    ++layer.frames[size_t(ran.quality)];
    layer.chain_level = std::max(layer.chain_level, ran.chain_level);
    layer.error_px = std::max(layer.error_px, ran.error_px);
  }
}

void AddLayerQuality(const std::vector<LayerQuality>& layers, ReportTree& tree) {
  struct Group {
    LayerQuality sum;
    uint32_t layers = 0;
  };
  std::map<std::pair<std::string_view, std::string_view>, Group> groups;
  ReportTable& table = tree.AddTable("layer_quality", {InText("layers"),
                                                       InJson("layer"),
                                                       InJson("character"),
                                                       {"solver"},
                                                       {"asked", "", -1, "quality"},
                                                       {"ran.fast", "% ran", 1, "fast", 100},
                                                       {"ran.fine", "% ran", 1, "fine", 100},
                                                       {"ran.best", "% ran", 1, "best", 100},
                                                       {"least_chains", "%", 1, "chains", 100},
                                                       {"error_px", "px", 2, "99 % within"}});
  for (size_t l = 0; l < layers.size(); ++l) {
    const LayerQuality& layer = layers[l];
    AddRow(layer,
           {Value(), fmt::format("layer {} {}", l, layer.name),
            fmt::format("character {}", layer.character)},
           Show::kJson, table);
    Group& group = groups[{layer.solver, layer.asked}];
    if (group.layers++ == 0) {
      group.sum = layer;
      continue;
    }
    for (size_t q = 0; q < layer.frames.size(); ++q) group.sum.frames[q] += layer.frames[q];
    group.sum.chain_level = std::max(group.sum.chain_level, layer.chain_level);
    group.sum.error_px = std::max(group.sum.error_px, layer.error_px);
  }
  for (const auto& [key, group] : groups)
    AddRow(group.sum, {group.layers, Value(), Value()}, Show::kText, table);
}

}  // namespace pelt
