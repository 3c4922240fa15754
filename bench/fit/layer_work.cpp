#include "bench/fit/layer_work.hpp"

#include <string_view>

#include "jobs/lod_budget.hpp"
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

// ---- Costs by that work ----------------------------------------------------------------------

namespace {

constexpr uint32_t kFrames = 4;  // and as many before them

// That kernels work on.
uint32_t LanesOf(const FurScene& scene, Domain domain, uint32_t item) {
  const FrameMemory& memory = scene.memory();
  return RoundUpToLaneGroups(domain == Domain::kPatch
                                 ? memory.Of<&Streams::mesh>(item)->vertex_count
                                 : memory.Of<&Streams::chunk_state>(item)->live_strands);
}

}  // namespace

void FurCostSums::Add(Scenario& scene, const PriceOfWork& price, const SceneOptions& options) {
  RunningScenario running(scene, options);
  const FurScene& fur = running.scene();
  const std::vector<const LayerParams*> params = ListParams(scene);
  LodSettings lod;
  lod.fast_quality_px = 0.0f;
  const auto visit = [&](const StageWork& work) {
    if (work.layer == kNoLayer) return;
    const Stage& stage = fur.plan().stages[work.stage];
    const LayerParams& layer = *params[work.layer];
    const StagePrice cost = price(fur, work);
    chunk_.ns += cost.item;
    if (!std::string_view(stage.kernel.name).starts_with("simulate_")) {
      (stage.domain == Domain::kPatch ? vertex_ : strand_).ns += cost.iterations;
      return;
    }
    Sum& node = node_[CostTier(layer.solver, layer.quality)];
    node.ns += cost.iterations;
    node.count += double(LanesOf(fur, stage.domain, work.item)) * (layer.points - 1);
  };
  const auto ended = [&] {
    chunk_.count += fur.shape().chunk_count + fur.shape().patch_count;
    for (uint32_t c = 0; c < fur.shape().chunk_count; ++c)
      strand_.count += LanesOf(fur, Domain::kChunk, c);
    for (uint32_t p = 0; p < fur.shape().patch_count; ++p)
      vertex_.count += LanesOf(fur, Domain::kPatch, p);
  };
  WalkWork(running, {.warm_up = kFrames, .count = kFrames, .lod = lod}, visit, ended);
}

FurCosts FurCostSums::Take() const {
  FurCosts costs{
      .chunk_ns = chunk_.Each(), .vertex_ns = vertex_.Each(), .strand_ns = strand_.Each()};
  for (uint32_t t = 0; t < kSolverTiers; ++t) costs.node_ns[t] = node_[t].Each();
  return costs;
}

}  // namespace pelt
