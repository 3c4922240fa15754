// The character's UV layout as lines over the place of its image, to paint a map on. Rows from v = 0 at the top, as maps
// are read, so that what is painted there lies where the lines are. Black but for the lines, a colour for each material,
// which have no red: maps are read from that channel by default, and may be painted right over them.
#pragma once

#include <cstdint>
#include <vector>

#include "core/groom/surface_colour.hpp"

namespace pelt {

struct UvTemplate {
  uint32_t width = 0, height = 0;  // of the largest image's shape
  std::vector<uint8_t> rgb;
};

// Throws pelt::Error for a character without texture coordinates.
UvTemplate DrawUvTemplate(const Character&, const SurfaceColour&);

}  // namespace pelt
