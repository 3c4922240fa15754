// What a picture's fur, skin and room are lit by: what the frame's layers are lit by, where there is any, else the
// default. The room, which has no layer, is as much brighter or darker than in the default light as white patches that
// face up and to the sides are in the mean of what reaches the layers.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "bench/shading/default_look.hpp"
#include "jobs/scene.hpp"

namespace pelt {

class FrameLight {
 public:
  explicit FrameLight(const FurScene& scene);

  // A layer that is not lit has its character's light, and a character without a lit layer that of all of them.
  const PictureLook& OnLayer(uint32_t layer) const { return layers_[layer]; }
  const PictureLook& OnActor(uint32_t actor) const { return actors_[actor]; }

 private:
  std::vector<PictureLook> layers_, actors_;
};

}  // namespace pelt
