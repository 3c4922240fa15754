// Where a layer grows, and how densely: density, its map, and the mask's materials, joint weights,
// box projection, range, margin, stencil, bald map and colours, multiplied; and nowhere where a material's
// alpha leaves no skin.
//
// Invariant: Share() never exceeds TriangleLimit() of the same triangle; the scatter draws its
// candidates by the limit, so that layers which cover little of the mesh cost little.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/character/character.hpp"
#include "core/groom/fur_setup.hpp"

namespace pelt {

// A place on the mesh; the barycentrics sum to 1.
struct SurfacePoint {
  uint32_t triangle;
  glm::vec3 bary;
};

// Of the unit square: the half that is not the triangle's is folded onto it.
inline SurfacePoint PlaceInTriangle(uint32_t triangle, double x, double y) {
  if (x + y > 1.0) {
    x = 1.0 - x;
    y = 1.0 - y;
  }
  return {triangle, {float(1.0 - x - y), float(x), float(y)}};
}

template <class T>
T Interpolate(const std::vector<T>& at_vertex, const Mesh& mesh, const SurfacePoint& point) {
  const auto& v = mesh.triangles[point.triangle];
  return at_vertex[v[0]] * point.bary.x + at_vertex[v[1]] * point.bary.y +
         at_vertex[v[2]] * point.bary.z;
}

// How images and maps go on beyond their edges on a triangle.
inline std::array<Wrap, 2> WrapOn(const Mesh& mesh, uint32_t triangle) {
  const uint16_t material = mesh.triangle_material[triangle];
  return material < mesh.looks.size() ? mesh.looks[material].wrap : std::array<Wrap, 2>{};
}

// How long a side of the UV square is on the skin, m, where maps are finest and where coarsest: 5 % of the area lies
// beyond each. None without UVs that cover an area.
struct UvScale {
  double finest, coarsest;
};
std::optional<UvScale> MeasureUvScale(const Mesh& mesh, const RestGeometry& rest);

class SurfaceColour;

// Whether the character's own images say where the layer grows: its materials' holes, or mask.colours.
bool GrowsByImages(const Mesh&, const LayerSetup&);

class Growth {
 public:
  // References are kept. `surface` is the character's; made here if it is null and needed. Throws
  // pelt::Error for unknown names, for maps without UVs and for colours of a file that has none.
  Growth(const Character&, const RestGeometry&, const FurSetup&, const LayerSetup&,
         std::shared_ptr<const SurfaceColour> surface = nullptr);

  // Strands per square metre where Share() is 1.
  float densest() const { return densest_; }
  float TriangleLimit(uint32_t triangle) const;
  // Wanted density over densest(), 0 to 1.
  float Share(const SurfacePoint&) const;
  // Names the keys that leave the layer without a strand.
  std::string ExplainEmpty() const;

 private:
  enum Factor {
    kDensity,
    kMaterials,
    kJoints,
    kBox,
    kRange,
    kAwayFrom,
    kStencil,
    kBald,
    kHoles,
    kColours,
    kFactorCount
  };
  float Evaluate(Factor, const SurfacePoint&) const;
  float DensityShare(const SurfacePoint&) const;
  float JointShare(const SurfacePoint&) const;
  float JointLimit(uint32_t triangle) const;
  float SampleMap(const MapChannel&, const SurfacePoint&) const;
  bool HasMaskedColour(const SurfacePoint&) const;
  bool IsInMargin(const glm::vec3& position) const;
  glm::vec3 BoxShare(const glm::vec3& position) const;

  const Mesh& mesh_;
  const RestGeometry& rest_;
  const LayerSetup& layer_;
  std::shared_ptr<const SurfaceColour> surface_;  // if it says where fur grows
  float densest_;
  glm::vec3 box_low_, box_extent_;
  std::vector<uint8_t> material_grows_;
  std::vector<std::vector<float>> joint_weight_;  // of each joint mask, at each vertex
  // What mask.away_from keeps away from, and the box about it in which its margin lies.
  std::vector<std::array<glm::vec3, 3>> away_;
  glm::vec3 away_low_{0.0f}, away_high_{0.0f};
};

}  // namespace pelt
