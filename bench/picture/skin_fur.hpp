// Where fur grows on a mesh, and of which colour it is at the roots.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "bench/picture/mesh_finder.hpp"
#include "core/character/character.hpp"
#include "jobs/scene.hpp"

namespace pelt {

struct SkinFur {
  std::vector<glm::vec3> colour;  // at each vertex, linear; where no fur grows the mean of all
  std::vector<glm::vec3> tip;     // the same, of the strands' other ends
  std::vector<float> area;  // at each vertex, of its share of the strands seen from the side; m^2
  struct OfLayer {
    uint32_t layer;
    std::vector<float> area;  // as above; the sum over layers is what is above, but for rounding
  };
  std::vector<OfLayer> layers;
  std::vector<uint32_t> place;  // number of each vertex's place: vertices at one have one share
  std::vector<uint8_t> on_material;  // whether any grow on the material's triangles
  // At each vertex, what is on the skin, as SeenPaint: the mean of the strands that grow there. Its
  // wetness is the share of the brightness that is lost, and so goes with a `wet_darken` of 0.
  std::vector<glm::vec4> paint;
  glm::vec3 mud_colour{0.0f};  // sRGB
};

// What frames leave as it is, which is most of it, is found once.
class SkinFurFinder {
 public:
  SkinFurFinder(const FurScene& scene, uint32_t actor, const Mesh& mesh);
  // In the last frame of that scene.
  SkinFur Find(const FurScene& scene) const;

 private:
  struct Layer {
    uint32_t number;
    float shell_density;                        // area of hair for each of skin; 0: of strands
    std::vector<std::vector<uint32_t>> places;  // of the vertices of each chunk
    std::vector<float> area;                    // of strands, at each place
  };
  void AddShells(const FurScene& scene, const Layer& layer, std::vector<float>& area) const;

  MeshFinder finder_;
  std::vector<Layer> layers_;
  std::vector<float> area_;  // of all strands, at each place
  SkinFur fur_;              // but what Find adds
};

inline SkinFur FindSkinFur(const FurScene& scene, uint32_t actor, const Mesh& mesh) {
  return SkinFurFinder(scene, actor, mesh).Find(scene);
}

}  // namespace pelt
