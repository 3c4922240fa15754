// The texture that shells are cut from: how far the hair of each texel reaches, of 255; 0 where
// there is none. It repeats in both directions.
//
// Hairs are thrown at random places with replacement, so of a density of d a texel 1 - exp(-d) of the
// texels have one, and the last that fell on a texel is the one that stands there.
//
// Invariant: of four numbers alone (size, density, least length, seed), the same on every machine,
// so a groom holds those and not the texels.
#pragma once

#include <cstdint>
#include <vector>

#include "core/groom/layer_params.hpp"

namespace pelt {

// Rows of fur_texture_size texels each, from v = 0 up.
std::vector<uint8_t> MakeFurTexture(const LayerParams& params);

}  // namespace pelt
