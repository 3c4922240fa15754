// What a picture shows, gathered from a frame that ran: all that a renderer needs, and the same for each of them.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "bench/picture/body.hpp"
#include "bench/picture/hairs.hpp"
#include "bench/picture/picture_maps.hpp"
#include "bench/shading/default_look.hpp"
#include "jobs/scene.hpp"

namespace pelt {

// A layer of shells is cut by it: square, the length of the hair at each texel; of other layers empty.
struct FurTexture {
  uint32_t side = 0;
  std::vector<uint8_t> texels;
};

// How densely a layer of shells grows, per texel: its stencil. Without sheets that is the vertices'.
struct ShellGrowth {
  SharedGrowth sheets;
  std::vector<uint16_t> sheet_of_vertex;  // of `vertices`; empty: the first

  uint16_t SheetOf(size_t vertex) const {
    return sheet_of_vertex.empty() ? uint16_t(0) : sheet_of_vertex[vertex];
  }
};

struct PictureScene {
  Camera camera;
  VertexOrder order;
  PictureLook look;          // of what has none of its own
  std::vector<Body> bodies;  // one for each character
  // In drawing order; and in the same places what each has to draw as hairs or is cut by. Vertices lie in the scene's
  // memory: good until its next frame runs.
  std::vector<LayerDraw> draws;
  std::vector<std::vector<Hair>> layers;
  std::vector<FurTexture> textures;
  std::vector<ShellGrowth> growth;
  std::vector<uint32_t> actors;                        // whose layer it is
  std::vector<PictureLook> layer_looks;                // and what it is lit by
  std::vector<PictureLook> body_looks;                 // of each character's skin
  std::vector<std::vector<PictureLook>> relief_looks;  // and of its layers of relief
  ReliefShow relief;
  // Of each draw, the artist's texture of its strands; null: Pelt's own.
  std::vector<std::shared_ptr<const StripTexture>> strips;
  // Of each draw, where its vertices are the picture's own (OwnVertices); else none.
  std::vector<std::vector<std::byte>> own_vertices;
  std::vector<std::vector<uint32_t>> own_orders;  // likewise, of LayerDraw::order
  // A number of all that is here but the camera and what it is lit by: another picture that has it shows the same. 0:
  // any.
  uint64_t content = 0;

  // change(look) for each of them.
  template <class Change>
  void ForEachLook(const Change& change) {
    change(look);
    for (PictureLook& of_layer : layer_looks) change(of_layer);
    for (PictureLook& of_body : body_looks) change(of_body);
    for (std::vector<PictureLook>& of_relief : relief_looks)
      for (PictureLook& of_layer : of_relief) change(of_layer);
  }
};

// Of the scene's last frame as `camera` saw it, with the scenario's own maps. `posed`: bodies of another picture, where
// nothing has moved or changed its looks since; empty: posed for this one.
PictureScene GatherPicture(const Scenario& scenario, const PictureMaps& maps, const FurScene& scene,
                           const Camera& camera, VertexOrder order,
                           std::span<const Body> posed = {});
// With maps for this picture alone: `relief` is theirs, and what they have to say goes into `notes`.
PictureScene GatherPicture(const Scenario& scenario, const FurScene& scene, const Camera& camera,
                           VertexOrder order, std::vector<std::string>& notes,
                           std::span<const std::string> relief = {});
// What multiplies the colour where a strand texture has extra tint.
inline glm::vec3 TintOfStrands(const LayerDraw& draw) {
  return VecOf(draw.look->strand_tint.data());
}
// Has the draws' vertices in the picture's own memory, where they can be changed; returns them, one for each draw.
std::span<std::vector<std::byte>> OwnVertices(PictureScene& scene);

// What a picture's fur, skin and room are lit by: what the frame's layers are lit by, where there is any, else the
// default. The room, which has no layer, is as much brighter or darker than in the default light as white patches that
// face up and to the sides are in the mean of what reaches the layers.
class FrameLight {
 public:
  explicit FrameLight(const FurScene& scene);

  // A layer that is not lit has its character's light, and a character without a lit layer that of all of them.
  const PictureLook& OnLayer(uint32_t layer) const { return layers_[layer]; }
  const PictureLook& OnActor(uint32_t actor) const { return actors_[actor]; }

 private:
  std::vector<PictureLook> layers_, actors_;
};

// All of the picture's looks, by the lights of the scene's last frame.
void LightPicture(const FurScene& scene, PictureScene& shown);

// A sphere round everything of each character, the tips of its hairs and shells too.
struct Ball {
  glm::vec3 centre;
  float radius;  // m
};
std::vector<Ball> BoundActors(const PictureScene& scene);

// Whether b's shadow may fall on a.
bool ShadowMeets(const Ball& a, const Ball& b, const glm::vec3& to_sun);

}  // namespace pelt
