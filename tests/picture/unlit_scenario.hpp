// A character whose materials are unlit, without fur before its skin.
#pragma once

#include <algorithm>
#include <cstdlib>
#include <vector>

#include "bench/picture/picture_scene.hpp"
#include "core/groom/surface_colour.hpp"
#include "tests/jobs/tiny_scene.hpp"

namespace pelt::testing {

inline constexpr glm::vec3 kUnlitColour{0.9f, 0.2f, 0.05f};  // linear; brighter than Tone leaves it

inline Scenario UnlitScenario(bool unlit) {
  Scenario scenario = TinyScenario();
  for (Character& character : scenario.characters)
    character.mesh.looks.assign(character.mesh.materials.size(),
                                {.stated = true, .unlit = unlit, .base_colour = kUnlitColour});
  return scenario;
}

// Its skin alone, as if fur covered none of it.
inline PictureScene BareSkin(PictureScene scene) {
  scene.draws.clear();
  scene.layers.clear();
  for (Body& body : scene.bodies) {
    std::ranges::fill(body.covered, 0.0f);
    body.mapped.clear();
  }
  return scene;
}

// Pixels in the colour, to the byte.
inline uint32_t CountUnlit(const std::vector<uint8_t>& rgb) {
  uint8_t own[3];
  for (int c = 0; c < 3; ++c) own[c] = uint8_t(255.0 * ExactSrgb(double(kUnlitColour[c])) + 0.5);
  uint32_t count = 0;
  for (size_t i = 0; i < rgb.size(); i += 3) {
    int most = 0;
    for (size_t c = 0; c < 3; ++c) most = std::max(most, std::abs(int(rgb[i + c]) - int(own[c])));
    count += most <= 1;
  }
  return count;
}

}  // namespace pelt::testing
