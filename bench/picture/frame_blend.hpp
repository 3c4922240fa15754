// Pictures between two frames of the simulation, for a display that is faster than it is: strands, shells, skins and
// the camera on their way from one to the next. Colours and drawing order are the later frame's.
#pragma once

#include <optional>

#include "bench/picture/picture_scene.hpp"

namespace pelt {

class FrameBlend {
 public:
  // The frame to come from, while its scene still holds it.
  void Keep(PictureScene shown);
  void Forget() { kept_.reset(); }
  bool HasFrame() const { return kept_.has_value(); }

  // `shown`, of the frame after the kept one, as it is at `share` of the way, 0 to 1. What was not drawn before is
  // where it is now. Its vertices then lie in its own memory.
  void Blend(float share, PictureScene& shown) const;

 private:
  struct Draw {
    uint32_t layer;
    std::vector<std::byte> vertices;
    std::vector<uint32_t> place_of_strand;  // or kNowhere
    std::vector<Hair> hairs;
  };
  struct Kept {
    Camera camera;
    std::vector<Body> bodies;
    std::vector<Draw> draws;
  };
  std::optional<Kept> kept_;
};

}  // namespace pelt
