#include "bench/picture/picture_maps.hpp"

#include <algorithm>

#include "bench/picture/relief_coat.hpp"
#include "bench/picture/skin_fur.hpp"
#include "core/character/pose.hpp"

namespace pelt {
namespace {

// Actors that have the same of everything that maps are made from.
bool AreAlike(const Actor& a, const Actor& b) {
  return a.character == b.character && a.groom == b.groom && a.unit_scale == b.unit_scale;
}

}  // namespace

PictureMaps::PictureMaps(const Scenario& scenario, std::span<const std::string> relief, bool rim)
    : relief_(relief.begin(), relief.end()), rim_(rim), coats_(MakeReliefCoats(scenario, relief)) {
  for (const Character& character : scenario.characters) {
    surfaces_.push_back(std::make_shared<const SurfaceColour>(character));
    const auto& faults = surfaces_.back()->faults();
    notes_.insert(notes_.end(), faults.begin(), faults.end());
  }
  for (const Actor& actor : scenario.actors) {
    const auto same = std::ranges::find_if(
        scenario.actors, [&](const Actor& other) { return AreAlike(actor, other); });
    const size_t number = size_t(same - scenario.actors.begin());
    growth_.push_back(number < growth_.size() ? growth_[number] : MakeGrowth(scenario, actor));
  }
}

std::vector<PictureMaps::LayerGrowth> PictureMaps::MakeGrowth(const Scenario& scenario,
                                                              const Actor& actor) {
  std::vector<LayerGrowth> made;
  if (actor.groom >= scenario.setups.size()) return made;
  const Character& character = scenario.characters[actor.character];
  const FurSetup& setup = scenario.setups[actor.groom];
  const RestGeometry rest = ComputeRestGeometry(character, actor.unit_scale);
  for (const LayerSetup& layer : setup.layers)
    if (SharedGrowth growth =
            MakeGrowthSheets(character, rest, setup, layer, surfaces_[actor.character], notes_))
      made.push_back({layer.name, std::move(growth)});
  return made;
}

const SkinFurFinder& PictureMaps::SkinOf(const Scenario& scenario, const FurScene& scene,
                                         uint32_t actor) const {
  skins_.resize(scenario.actors.size());
  if (!skins_[actor])
    skins_[actor] = std::make_shared<SkinFurFinder>(
        scene, actor, scenario.characters[scenario.actors[actor].character].mesh);
  return *skins_[actor];
}

std::shared_ptr<const StripTexture> PictureMaps::StripsOf(
    const std::shared_ptr<const StrandTexture>& texture) const {
  if (!texture) return nullptr;
  for (const auto& [known, made] : strips_)
    if (known == texture) return made;
  return strips_.emplace_back(texture, std::make_shared<const StripTexture>(*texture)).second;
}

SharedGrowth PictureMaps::GrowthOf(uint32_t actor, std::string_view layer) const {
  for (const LayerGrowth& known : growth_[actor])
    if (known.layer == layer) return known.growth;
  return nullptr;
}

}  // namespace pelt
