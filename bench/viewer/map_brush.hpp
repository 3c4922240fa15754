// A brush on a map over the surface: a ball on the skin of the rest pose, so that paint goes on across the seams of the
// texture coordinates, onto all texels whose places on the skin it holds, and onto those beyond an island's edge that a
// look-up near the edge blends in.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "core/character/character.hpp"

namespace pelt {

struct MapDab {
  glm::vec3 centre;  // rest pose, m
  float radius;      // m
  float hardness;    // up to this share of the radius the value is reached at once, 0 to 1
  float value;       // 0 to 1
};

class MapBrush {
 public:
  // On maps of side x side texels, rows from the top. The mesh has UVs. What is needed of both is copied.
  MapBrush(const Mesh& mesh, const RestGeometry& rest, uint32_t side);

  uint32_t side() const { return side_; }
  // Returns how many texels it reached.
  size_t Paint(std::span<uint8_t> texels, const MapDab& dab);

 private:
  struct Triangle {
    std::array<glm::vec2, 3> texel;  // texel i's middle is at i
    std::array<glm::vec3, 3> at;
    std::array<Wrap, 2> wrap;
  };
  // visit(texel, place on the skin, whether its middle is inside of the triangle).
  void ForEachTexel(const Triangle& triangle, const auto& visit) const;

  uint32_t side_;
  std::vector<Triangle> triangles_;
  std::vector<uint8_t> covered_;  // texels whose middle lies in some triangle
  std::vector<float> share_;      // of the dab that is painted; else 0
  std::vector<uint32_t> reached_;
};

}  // namespace pelt
