// What a primitive's vertices have that is kept by corner of its triangles, so that vertices which differ in it alone are
// still one to fur.
#pragma once

#include <cstddef>
#include <vector>

#include "core/character/character.hpp"

namespace pelt::gltf {

// For triangles that have none yet, whose vertices begin at `first`. `size` numbers for each vertex, of which three are
// the colour and a fourth alpha; what is not there, or not finite, is white.
void StoreCornerColours(const std::vector<float>& colours, size_t size, size_t first, Mesh& mesh);

}  // namespace pelt::gltf
