// LodSettings::costs of a scene, by what its stages cost wherever it runs.
#pragma once

#include <functional>

#include "bench/fit/layer_work.hpp"

namespace pelt {

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
