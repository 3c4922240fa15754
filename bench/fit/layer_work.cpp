#include "bench/fit/layer_work.hpp"

#include "platform_sim/pricing/stage_costs.hpp"

namespace pelt {

void WalkWork(RunningScenario& running, const WorkFrames& frames,
              const std::function<void(const StageWork&)>& visit,
              const std::function<void()>& ended) {
  SerialExecutor serial;
  const FurScene& scene = running.scene();
  const SceneShape& shape = scene.shape();
  for (uint32_t f = 0; f < frames.warm_up + frames.count; ++f) {
    running.Begin(f, {.lod = frames.thins}, frames.lod);
    Frame frame = scene.CurrentFrame();
    frame.profile = frames.profile;
    serial.Run(frame);
    if (f < frames.warm_up) continue;
    for (uint32_t s = 0; s < scene.plan().stages.size(); ++s) {
      const Stage& stage = scene.plan().stages[s];
      for (uint32_t i = 0; i < shape.ItemCount(stage.domain); ++i) {
        if (!IsWanted(stage, scene.memory(), i)) continue;
        const bool has_layer = stage.domain >= Domain::kLayer;
        visit({.stage = s,
               .item = i,
               .layer = has_layer ? shape.LayerOf(stage.domain, i) : kNoLayer,
               .iterations = CountIterations(frame, s, i)});
      }
    }
    ended();
  }
}

std::vector<const LayerParams*> ListParams(const Scenario& scenario) {
  std::vector<const LayerParams*> params;
  for (const Groom* groom : scenario.ActorGrooms())
    for (const GroomLayer& layer : groom->layers) params.push_back(&layer.params);
  return params;
}

std::vector<uint32_t> CountLiveStrands(const FurScene& scene) {
  std::vector<uint32_t> live(scene.shape().layer_count);
  for (uint32_t c = 0; c < scene.shape().chunk_count; ++c)
    live[scene.shape().chunk_layer[c]] += scene.memory().Of<&Streams::chunk_state>(c)->live_strands;
  return live;
}

}  // namespace pelt
