// What each layer and each character costs, over many frames: of a scene of 166 layers the stages'
// times do not say which.
//
// A layer's cost is that of all its chunks, and of stages that run on the layer itself; a
// character's, that of its layers and of its pose and joints. What is left is the scene's: the order
// of its layers. The sums of a frame are those of its stages.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "bench/report/spread.hpp"
#include "jobs/scene.hpp"

namespace pelt {

struct LayerCost {
  std::string name;
  uint32_t character = 0, chunks = 0;
  uint64_t strands = 0;
  Spread core_ms;
  std::vector<double> samples_ms;  // of each frame
  uint32_t dearest_stage = 0;
  double dearest_share = 0.0;
};
struct CharacterCost {
  uint32_t layers = 0;
  uint64_t strands = 0;
  Spread core_ms;
  std::vector<double> samples_ms;
  double own_ms = 0.0;  // median of pose and joints
};
struct CostSplit {
  std::vector<LayerCost> layers;
  std::vector<CharacterCost> characters;
  Spread scene_ms, all_ms;
};

class LayerCosts {
 public:
  LayerCosts(const FurScene& scene, uint32_t frames);

  // A frame in which all stages were timed: first this, then every run of a stage.
  void BeginFrame();
  void Add(uint32_t stage, uint32_t item, uint64_t ticks);
  // `layer_strands`: of each layer.
  CostSplit Summarise(double ms_per_tick, std::span<const uint32_t> layer_strands) const;

 private:
  std::vector<double> FrameSums(double ms_per_tick, const std::vector<uint32_t>& rows) const;

  const FurScene& scene_;
  // [row][frame] in ticks: layers, then characters by themselves, then the scene.
  std::vector<std::vector<uint64_t>> ticks_;
  std::vector<std::vector<uint64_t>> stage_ticks_;  // [layer][stage], of all frames
};

}  // namespace pelt
