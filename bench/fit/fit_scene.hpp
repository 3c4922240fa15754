// A scene fitted to a frame time: each layer gets the solver, quality and share of its chains that the time pays for.
//
//   every tier on every layer  -> what each layer costs and how wrong it is (layer_errors.hpp)
//   from the cheapest on       -> what takes most of the error on the screen away for its price (purchases.hpp)
//   the plan as a whole        -> priced, and bought less or more until it fits and can run
//   not even the cheapest fits -> fewer strands of all layers
//
// As at run time (LodSettings::budget_us), strands go before motion gets worse than worst_px. A tier's error with
// fewer chains is not measured for each: what thinning adds to one tier is added to all, in squares.
//
// Core times of layers add up; what a frame takes of them is a matter of the platform. So the core time that
// a frame may have is estimated from a plan whose frame was priced, and what is found for it is priced again.
//
// No clock decides anything: the same plan on every machine.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bench/fit/layer_errors.hpp"
#include "bench/report/report_tree.hpp"
#include "bench/scenarios/layer_plan.hpp"

namespace pelt {

// ns; core times of a frame in the mean.
struct PlatformCost {
  uint64_t frame_ns = 0;                    // what a verdict is about
  std::vector<uint64_t> layer_ns;           // core time, of each layer
  uint64_t rest_ns = 0;                     // core time of characters and of the scene
  std::vector<uint32_t> live_strands = {};  // of each layer, in the last frame

  uint64_t CoreNs() const;
};

struct FitPlatform {
  std::string name;
  // Throws Error for what cannot run there.
  std::function<PlatformCost(Scenario& scenario)> price;
  // Of scenes that differ from the first in their shares of chains and strands alone, whose stages are priced. As if
  // there were room for any code, of which all layers in one tier may need more than a plan does. Estimates; frames
  // are not looked at.
  std::function<std::vector<PlatformCost>(std::span<Scenario> scenes)> price_layers;
};

struct FitRequest {
  uint64_t target_ns = 5'000'000;
  float worst_px =
      LodSettings{}.worst_px;  // what no layer's error on the screen is over that can have better
  std::vector<FitPlatform> platforms;
  uint32_t warm_up = 60, frames = 60;
  std::function<void(const std::string& now)> progress = {};
};

struct SceneFit {
  struct Layer {
    LayerChoice choice;    // nothing in it: its own, as there is nothing to choose
    std::string tier;      // "own" then
    uint32_t strands = 0;  // that live in the last frame
    TipError error;        // measured of this plan
  };
  struct Step {
    uint32_t layer = 0;
    std::string tier;
    double less_px = 0.0;
    std::vector<double> more_ms;  // by platform, estimated
  };
  std::string scene;
  uint64_t target_ns = 0;
  uint32_t warm_up = 0, frames = 0;
  std::vector<std::string> platforms;
  std::vector<Layer> layers;
  std::vector<PlatformCost> costs;  // of the plan, by platform
  float strand_share = 1.0f;        // of each layer's, because nothing else fits
  TipError error;                   // of all tips, of the plan
  std::optional<Step> next;         // none: all is bought, or nothing fits
  uint32_t plans_priced = 0;
  std::vector<std::string> notes;  // tiers that no more layers can have beside each other

  bool Fits(size_t platform) const { return costs[platform].frame_ns <= target_ns; }
  // Else it is the cheapest plan that there is.
  bool Fits() const;
  // The part of the frame that is the layer's.
  double LayerMs(size_t platform, uint64_t core_ns) const;
  std::vector<LayerChoice> Plan() const;
};

SceneFit FitScene(const Scenario& scene, const FitRequest& request);
ReportTree MakeFitTree(const SceneFit& fit);

}  // namespace pelt
