// A tile of hairs seen from above, as heights: what fur is as relief on the skin. Each hair is a dot, highest in its
// middle, one in each cell of a grid at a random place and of a random height; the highest counts. The tile repeats.
//
// Invariant: the same bytes on every machine.
#pragma once

#include <cstdint>
#include <vector>

namespace pelt {

// side x side heights, 0 the skin and 255 the longest hair, of dots_a_side^2 hairs. Both are 1 to 4096, and a dot has at
// least one texel.
std::vector<uint8_t> MakeHeightField(uint32_t side, uint32_t dots_a_side, uint64_t seed);

// The tile that pictures and `pelt bake --height-field` have.
inline constexpr uint32_t kHairTileSide = 512, kHairTileDots = 48;
inline std::vector<uint8_t> MakeHairTile() {
  return MakeHeightField(kHairTileSide, kHairTileDots, 1);
}

}  // namespace pelt
