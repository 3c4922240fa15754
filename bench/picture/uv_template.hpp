// The character's UV layout as lines over the place of its image: a layer to paint a map on. Rows from v = 0 at the top,
// as maps are read, so that what is painted there lies where the lines are.
#pragma once

#include <cstdint>
#include <vector>

#include "core/groom/surface_colour.hpp"

namespace pelt {

struct UvTemplate {
  uint32_t width = 0, height = 0;  // of the largest image's shape
  std::vector<uint8_t> rgba;       // transparent but for the lines, a colour for each material
};

// Throws pelt::Error for a character without texture coordinates.
UvTemplate DrawUvTemplate(const Character&, const SurfaceColour&);

}  // namespace pelt
