// A picture of the last frame, drawn in software from what the frame wrote: the draw list, the
// sorted instances and ribbons, and the palette for the body under them.
//
// For people who want to see what they measure. Nothing here is timed, or fast.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "bench/scenarios/scenarios.hpp"
#include "bench/view/strand_light.hpp"

namespace pelt {

struct PictureOptions {
  uint32_t width_px = 1200, height_px = 900;
  uint32_t samples = 3;                // a side of each pixel
  std::optional<LightSet> light = {};  // none: DefaultLights
};

// A PNG of the scene's last frame as `camera` saw it. What of the characters' own images could not be drawn goes into
// `notes`.
std::vector<std::byte> DrawPicture(const Scenario& scenario, const FurScene& scene,
                                   const Camera& camera, VertexOrder order,
                                   const PictureOptions& options, std::vector<std::string>& notes);

}  // namespace pelt
