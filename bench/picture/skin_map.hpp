// The darkening of the skin below fur as a texture, for an engine's base colour to be multiplied with.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/character/character.hpp"
#include "core/groom/fur_setup.hpp"
#include "core/groom/groom.hpp"

namespace pelt {

// Light that is left on the skin of the rest pose, of 255: DepthFloor of what the groom's strands cover there, found
// from where they stand, how long and how wide they are, as pictures darken it, but for seams (JoinSeams). 255 where
// no fur grows. `groom` was baked of the setup for this character; what could not be read goes into `notes`. Throws as
// MakeSkinTexels (core/groom/flow_map.hpp).
std::vector<uint8_t> MakeSkinMap(const Character& character, const FurSetup& setup,
                                 const Groom& groom, uint32_t side,
                                 std::vector<std::string>& notes);

}  // namespace pelt
