// What all pictures of a run have in common: colours of the characters' surfaces, relief, and how densely layers grow.
// Made once, as their textures take longer than a picture.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "bench/picture/growth_sheets.hpp"
#include "bench/picture/strip_texture.hpp"
#include "bench/scenarios/scenarios.hpp"
#include "core/groom/surface_colour.hpp"

namespace pelt {

class ReliefCoat;
class SkinFurFinder;

class PictureMaps {
 public:
  // `relief`: layers by name, "all" for each, that are on the skin instead of hairs, with `rim` all but their fins;
  // throws as MakeReliefCoats. The scenario's characters and setups must outlive this, and stay as they are.
  explicit PictureMaps(const Scenario& scenario, std::span<const std::string> relief = {},
                       bool rim = false);

  const std::shared_ptr<const SurfaceColour>& SurfaceOf(uint32_t character) const {
    return surfaces_[character];
  }
  const std::shared_ptr<const ReliefCoat>& ReliefOf(uint32_t actor) const { return coats_[actor]; }
  // `scene` runs the scenario's grooms; found when it is asked for first.
  const SkinFurFinder& SkinOf(const Scenario& scenario, const FurScene& scene,
                              uint32_t actor) const;
  // Null where the layer has none.
  SharedGrowth GrowthOf(uint32_t actor, std::string_view layer) const;
  // An artist's texture of strands, with levels; made when it is asked for first. Null of null.
  std::shared_ptr<const StripTexture> StripsOf(
      const std::shared_ptr<const StrandTexture>& texture) const;
  const std::vector<std::string>& relief() const { return relief_; }
  bool has_rim() const { return rim_; }
  // What could not be read or made, one sentence each.
  const std::vector<std::string>& notes() const { return notes_; }

 private:
  struct LayerGrowth {
    std::string layer;
    SharedGrowth growth;
  };
  std::vector<LayerGrowth> MakeGrowth(const Scenario& scenario, const Actor& actor);

  std::vector<std::string> relief_;
  bool rim_;
  std::vector<std::shared_ptr<const SurfaceColour>> surfaces_;       // of the characters
  std::vector<std::shared_ptr<const ReliefCoat>> coats_;             // of the actors
  std::vector<std::vector<LayerGrowth>> growth_;                     // of the actors
  mutable std::vector<std::shared_ptr<const SkinFurFinder>> skins_;  // likewise
  mutable std::vector<
      std::pair<std::shared_ptr<const StrandTexture>, std::shared_ptr<const StripTexture>>>
      strips_;
  std::vector<std::string> notes_;
};

}  // namespace pelt
