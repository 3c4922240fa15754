// What a layer of shells keeps of the sun. A few of its shells stand for all of them: each covers what the hairs do
// that end between it and the next of these, so that a ray straight down the coat meets each hair once. The fur's
// texture is far finer than a shadow map: of its texels the share counts, not one of them.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "bench/picture/picture_scene.hpp"
#include "bench/picture/shadow_map.hpp"

namespace pelt {

inline constexpr size_t kShadowShells = 6;  // at most, of a layer

struct ShadowShell {
  float height;
  std::array<float, 256> covers;  // share of a place, by the stencil there in 8 bits
};

// From the skin up; the topmost shell is one of them.
std::vector<ShadowShell> FindShadowShells(std::span<const Shell> shells, const FurTexture& texture);

// Nothing of a layer of strands.
void AddShells(const LayerDraw& draw, const FurTexture& texture, ShadowMap& map);

}  // namespace pelt
