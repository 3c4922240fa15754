// What each layer and each character costs, over many frames: of a scene of 166 layers the stages'
// times do not say which.
//
// A layer's cost is that of all its chunks, and of stages that run on the layer itself; a
// character's, that of its layers and of its pose and joints. What is left is the scene's: the order
// of its layers. The sums of a frame are those of its stages.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "bench/report/budget.hpp"
#include "bench/report/json_text.hpp"
#include "bench/report/timeline.hpp"

namespace pelt {

class LayerCosts {
 public:
  explicit LayerCosts(const FurScene& scene);

  // A frame in which all stages were timed.
  void Add(const FrameRecord& record);
  // "layer_costs", "character_costs", "scene_cost" and "cost"; `layer_strands`: of each layer.
  void AddTo(JsonText& json, double ms_per_tick, std::span<const uint32_t> layer_strands) const;

 private:
  Spread SpreadOfFrames(double ms_per_tick, const std::vector<uint32_t>& rows) const;

  const FurScene& scene_;
  // [row][frame] in ticks: layers, then characters by themselves, then the scene.
  std::vector<std::vector<uint64_t>> ticks_;
  std::vector<std::vector<uint64_t>> stage_ticks_;  // [layer][stage], of all frames
};

}  // namespace pelt
