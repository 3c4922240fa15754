// How densely a layer grows, as texels over the character's UVs: masks and maps are finer than meshes, of which fur
// knows its share at vertices alone.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <string>
#include <vector>

#include "core/groom/flow_map.hpp"
#include "core/groom/growth.hpp"
#include "jobs/scene.hpp"

namespace pelt {

class GrowthSheets {
 public:
  GrowthSheets(const Mesh& mesh, GrowthMap map);

  // The triangle's; FlowMap::kNoSheet where the layer cannot grow.
  uint16_t SheetOf(uint32_t triangle) const { return sheet_[triangle]; }
  // Wanted density over the layer's densest, 0 to 1, at a place of the texture.
  float At(uint16_t sheet, const glm::vec2& uv) const { return texels_[sheet].Sample(uv, 0); }
  // Means over the triangle of the share times each corner's barycentric.
  const glm::vec3& CornerShare(uint32_t triangle) const { return corner_share_[triangle]; }
  // Grey, one for each sheet, of one size.
  const std::vector<ControlMap>& texels() const { return texels_; }

 private:
  std::vector<ControlMap> texels_;
  std::vector<uint16_t> sheet_;
  std::vector<glm::vec3> corner_share_;
};
using SharedGrowth = std::shared_ptr<const GrowthSheets>;

// Null where it would hold no more than the vertices: for layers of strands that neither maps nor the character's own
// images, `surface`, thin out, and where density is one everywhere. Null with a sentence in `notes` where the mesh's
// UVs allow none.
SharedGrowth MakeGrowthSheets(const Character& character, const RestGeometry& rest,
                              const FurSetup& setup, const LayerSetup& layer,
                              const std::shared_ptr<const SurfaceColour>& surface,
                              std::vector<std::string>& notes);

// Sheets of the vertices of a layer of shells, chunk behind chunk; empty where there is one sheet.
std::vector<uint16_t> SheetsOfShells(const FurScene& scene, uint32_t layer, const Mesh& mesh,
                                     const GrowthSheets& growth);

}  // namespace pelt
