// The ways to simulate a layer that `pelt fit` chooses from.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "bench/scenarios/layer_plan.hpp"
#include "bench/scenarios/scenarios.hpp"

namespace pelt {

struct Tier {
  std::string_view name;
  SimulationChoice choice;
};
std::span<const Tier> Tiers();

// The scene with every layer so that can be. `has`: of each layer of the scene, character by character,
// whether it is; the others keep their own.
Scenario AtTier(const Scenario& scenario, const Tier& tier, std::vector<bool>& has);

// The share of its chains that a layer has at a level (LodBlock::chain_level).
constexpr float ChainShareOf(uint32_t level) { return 1.0f / float(1u << level); }
// Whether a layer can have fewer chains than it has, at that level.
bool CanThin(const LayerParams& layer, uint32_t level);
// The scene with all that can at that level.
void ThinChains(Scenario& scenario, uint32_t level);

// The layers of a scene in the order of FurScene's, as a plan that changes nothing.
std::vector<LayerChoice> ListLayers(const Scenario& scenario);

}  // namespace pelt
