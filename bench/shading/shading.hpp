// How hair, skin and everything round them are lit: the shaders' own text, shaders/*.glsl, read as C++ with GLM. Each
// file says what its functions are and where they come from.
//
// A tile of hairs, which relief looks up, is here anything that is called with a place and returns a height.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

namespace pelt {
namespace shading {

using glm::abs, glm::ceil, glm::clamp, glm::cos, glm::cross, glm::dot, glm::exp, glm::floor,
    glm::inversesqrt, glm::length, glm::log, glm::max, glm::min, glm::mix, glm::normalize, glm::pow,
    glm::sin, glm::smoothstep, glm::sqrt;
using glm::mat3, glm::ivec2, glm::uvec2, glm::vec2, glm::vec3, glm::vec4;
using uint = uint32_t;

#define CONST inline constexpr
#define FN inline
#define FN_OF_TILE      \
  template <class Tile> \
  inline
#define TILE const Tile&
#define TILE_HEIGHT(tile, place) tile(place)
#define out
#define inout
#include "bench/shading/shaders/spherical_harmonics.glsl"
#include "bench/shading/shaders/strand_shading.glsl"
#include "jobs/shaders/fur_vertex.glsl"
// These are put together of those before them.
#include "bench/shading/shaders/film_strip.glsl"
#include "bench/shading/shaders/shell_shading.glsl"
#include "bench/shading/shaders/strand_light.glsl"
#include "bench/shading/shaders/strand_texture.glsl"
#include "jobs/shaders/relief.glsl"
// And these of those.
#include "bench/shading/shaders/paint_shading.glsl"
#include "bench/shading/shaders/relief_shading.glsl"
#include "bench/shading/shaders/studio.glsl"
#undef CONST
#undef FN
#undef FN_OF_TILE
#undef TILE
#undef TILE_HEIGHT
#undef out
#undef inout

}  // namespace shading
using namespace shading;
}  // namespace pelt
