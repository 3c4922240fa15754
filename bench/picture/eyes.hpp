// Eyeballs of the built-in character.
#pragma once

#include "bench/picture/body.hpp"

namespace pelt {

// One for each side of the character's middle that has triangles of the material "eye".
std::vector<Eye> FindEyes(const Body& body);

void DrawEye(const Eye& eye, const LightSet& light, const HairLook& look,
             const Projection& projection, Canvas& canvas);

}  // namespace pelt
