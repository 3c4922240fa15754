#include "bench/fit/tiers.hpp"

#include "core/layer_block.hpp"

namespace pelt {

std::span<const Tier> Tiers() {
  using enum ModalQuality;
  constexpr auto kModal = Solver::kModal;
  constexpr auto kRoot = CurlFollows::kRoot;
  static const Tier kTiers[] = {{"verlet", {Solver::kVerlet, {}, {}}},
                                {"pbd", {Solver::kPbd, {}, {}}},
                                {"fast, curl by root", {kModal, kFast, kRoot}},
                                {"fast", {kModal, kFast, {}}},
                                {"fine, curl by root", {kModal, kFine, kRoot}},
                                {"fine", {kModal, kFine, {}}},
                                {"best", {kModal, kBest, {}}}};
  return kTiers;
}

Scenario AtTier(const Scenario& scenario, const Tier& tier, std::vector<bool>& has) {
  Scenario out = scenario;
  has.clear();
  for (const Actor& actor : out.actors) {
    Groom& groom = out.grooms[actor.groom];
    for (size_t l = 0; l < groom.layers.size(); ++l) {
      const LayerParams& own = groom.layers[l].params;
      // Shells have no chains; of a layer whose curl follows its root the tier without a word of it is
      // the same.
      const bool same = own.output == Output::kShells ||
                        (tier.choice.curl_follows && own.curl_follows == CurlFollows::kRoot);
      has.push_back(!same && !ChangeSimulation(groom, l, tier.choice));
    }
  }
  return out;
}

bool CanThin(const LayerParams& layer, uint32_t level) {
  return layer.chain == ChainKind::kVertex && layer.output != Output::kShells &&
         level > LeastChainLevel(layer) && level < kChainLevels;
}

void ThinChains(Scenario& scenario, uint32_t level) {
  for (Groom& groom : scenario.grooms)
    for (GroomLayer& layer : groom.layers)
      if (CanThin(layer.params, level)) layer.params.chain_share = ChainShareOf(level);
}

std::vector<LayerChoice> ListLayers(const Scenario& scenario) {
  std::vector<LayerChoice> layers;
  for (uint32_t c = 0; c < scenario.actors.size(); ++c)
    for (const GroomLayer& layer : scenario.grooms[scenario.actors[c].groom].layers)
      layers.push_back({.character = c, .name = layer.name, .choice = {}});
  return layers;
}

}  // namespace pelt
