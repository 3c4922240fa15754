// How much work the stages of a scene's frames do for each layer: what is multiplied with the price of a
// stage, whoever pays it.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "bench/scenarios/scenarios.hpp"

namespace pelt {

inline constexpr uint32_t kNoLayer = ~0u;

struct StageWork {
  uint32_t stage, item;
  uint32_t layer;       // kNoLayer: of a character, or of the scene
  uint32_t iterations;  // as CountIterations has them
};

struct WorkFrames {
  uint32_t warm_up = 0, count = 0;
  LodSettings lod = {};
  bool thins = false;                     // by them
  const FrameProfile* profile = nullptr;  // to record frames into
};

// Runs frames in one thread and visits what ran in those that count; after each of them `ended` is called. Both
// may look at the scene.
void WalkWork(RunningScenario& running, const WorkFrames& frames,
              const std::function<void(const StageWork&)>& visit,
              const std::function<void()>& ended);

// Of the layers in FurScene's order.
std::vector<const LayerParams*> ListParams(const Scenario& scenario);

// Of each layer, in the last frame.
std::vector<uint32_t> CountLiveStrands(const FurScene& scene);

// ---- Costs by that work ----------------------------------------------------------------------

// LodSettings::costs of a scene, by what its stages cost wherever it runs.

// ns of one item of a stage: of its own, and of all its iterations.
struct StagePrice {
  double item = 0.0, iterations = 0.0;
};
using PriceOfWork = std::function<StagePrice(const FurScene&, const StageWork&)>;

class FurCostSums {
 public:
  // Over some frames, every layer in its own quality. Several ways of one scene add up: a tier that none has costs 0.
  void Add(Scenario& scene, const PriceOfWork& price, const SceneOptions& options = {});
  FurCosts Take() const;

 private:
  struct Sum {
    double ns = 0.0, count = 0.0;
    float Each() const { return count > 0.0 ? float(ns / count) : 0.0f; }
  };
  Sum chunk_, vertex_, strand_, node_[kSolverTiers];
};

}  // namespace pelt
