// A hair's knots as they are painted: lit, projected, as wide as in the picture.
#pragma once

#include "bench/picture/canvas.hpp"
#include "bench/picture/hairs.hpp"
#include "bench/shading/shading.hpp"

namespace pelt {

// `depth_light` and `sun_share` as HairPoint has them.
HairEnd ShadeKnot(const Hair& hair, uint32_t k, const LightSet& light, const HairLook& look,
                  float depth_light, float sun_share, const Projection& projection);

}  // namespace pelt
