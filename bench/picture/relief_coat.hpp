// Layers of fur that are drawn as relief on the skin instead of as hairs: bench/shading/shaders/relief.glsl with the
// layers' own flow maps and a tile of hairs.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "bench/picture/body.hpp"
#include "bench/picture/hairs.hpp"
#include "core/groom/flow_map.hpp"

namespace pelt {

class ReliefCoat {
 public:
  // The named layers of the setup on this character. Throws Error where a flow map cannot be made.
  ReliefCoat(const Character& character, const FurSetup& setup, float unit_scale,
             std::span<const std::string> names);

  bool Covers(uint32_t triangle) const;
  // The fur's light over that of the skin at a place of the posed body, each layer lit by its own of `looks`.
  glm::vec3 Shade(const Body& body, const SurfacePoint& at, std::span<const PictureLook> looks,
                  const ReliefShow& show, const glm::vec3& eye, float sun_share,
                  const glm::vec3& skin, ReliefCount& count) const;

  struct Layer {
    LayerLook look;
    std::vector<uint16_t> sheet;    // of each triangle
    std::vector<ControlMap> flow;   // of each sheet
    std::vector<glm::vec2> repeat;  // of the tile, over each sheet
    float longest_m;
  };
  // In the setup's order, each over the ones before.
  const std::vector<Layer>& layers() const { return layers_; }
  const ControlMap& tile() const { return tile_; }  // of hairs, grey

 private:
  // Steps in w; below 0 where the layer is bald.
  glm::vec4 ShadeLayer(const Layer& layer, const Body& body, const SurfacePoint& at,
                       const PictureLook& look, const ReliefShow& show, const glm::vec3& to_eye,
                       float sun_share, const glm::vec3& below) const;

  const Mesh& mesh_;
  ControlMap tile_;
  std::vector<Layer> layers_;
};

// Of layers by name, "all" for each. Throws Error for one that the scenario does not have, and for a groom without a
// setup or a character without UVs; and with `rim` where none of the layers has fins.
void CheckRelief(const Scenario& scenario, std::span<const std::string> names, bool rim = false);
// Whether it has the setups and UVs.
bool CanBeRelief(const Scenario& scenario);
// The fur of each actor's groom that is drawn on the skin; null where no layer is named. Throws as CheckRelief.
std::vector<std::shared_ptr<const ReliefCoat>> MakeReliefCoats(const Scenario& scenario,
                                                               std::span<const std::string> names);
// Leaves hairs and shells of the scene's draws to those layers that are not drawn as relief; with `rim` fins to all.
void RemoveRelief(const Scenario& scenario, const FurScene& scene,
                  std::span<const std::string> names, bool rim,
                  std::vector<std::vector<Hair>>& layers, std::span<LayerDraw> draws);

// Of a mesh with its vertices at these places; zeros without UVs.
TextureAxes FindTextureAxes(const Mesh& mesh, const std::vector<glm::vec3>& position);

}  // namespace pelt
