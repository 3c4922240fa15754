// What a renderer of shells works out for a vertex and a sample (jobs/DRAWING.md, core/chunk.hpp).
// Shells are lit as hair is, strand_light.hpp: along ShellDirection, with a shell's `shadow` as the
// light that the coat leaves at its depth. shaders/shell_shading.glsl has the same functions.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>

namespace pelt {

// Where a vertex is at a height of 0, the skin, to 1, the tips.
inline glm::vec3 ShellPosition(const glm::vec3& position, const glm::vec3& groom,
                               const glm::vec3& force, float height) {
  return position + height * (groom + height * force);
}

// Which way the hairs there go: ShellPosition's derivative, unit.
inline glm::vec3 ShellDirection(const glm::vec3& groom, const glm::vec3& force, float height) {
  const glm::vec3 along = groom + 2.0f * height * force;
  return along / std::max(glm::length(along), 1e-9f);
}

// Whether a hair of this length, of the longest, where this share of the fur stands, reaches past the
// shell's threshold: 1, or 0.
inline float ShellCoverage(float hair, float stencil, float threshold) {
  return hair * stencil > threshold ? 1.0f : 0.0f;
}

// A fin, an edge of the skin drawn out along its hairs, is a strip of kFinSteps quads that follow their
// bend. Its ends are at ShellPosition; a hair at a share of the edge covers it up to its height, by
// ShellCoverage with the height as threshold.
inline constexpr uint32_t kFinSteps = 4;

inline float FinHeight(uint32_t step) { return float(step) / float(kFinSteps); }

}  // namespace pelt
