// A layer of shells as an engine would draw it: each shell a copy of the skin, cut by the texture.
#pragma once

#include "bench/picture/body.hpp"
#include "bench/picture/picture_scene.hpp"

namespace pelt {

// The scene's draw in that place.
void DrawShells(const PictureScene& scene, size_t draw, const SunShare& sun,
                const Projection& projection, Canvas& canvas);

}  // namespace pelt
