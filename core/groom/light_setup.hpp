// The lights that a fur setup brings along, as read from its [lights]; in the world, metres. Nothing is derived here
// but directions of unit length.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "core/lighting.hpp"

namespace pelt {

// Colours are linear: what they mean is described in core/lighting.hpp.
struct LightsSetup {
  struct Light {
    glm::vec3 position{0.0f};
    float radius = 0.0f;
    glm::vec3 colour{1.0f};
    float range = 0.0f;
  };
  struct Sample {
    glm::vec3 position{0.0f};
    float falloff = 1000.0f;
    glm::vec3 sky{0.0f}, ground{0.0f};
    glm::vec3 up{0.0f, 1.0f, 0.0f};
  };
  struct Sun {
    glm::vec3 direction{0.0f, 1.0f, 0.0f};
    glm::vec3 colour{0.0f};
  };
  struct Rim {
    glm::vec3 direction{0.0f, 1.0f, 0.0f};
    glm::vec3 colour{0.0f};
    float exponent = 3.0f;
  };
  std::vector<Light> lights;    // at most kLightsPerScene
  std::vector<Sample> samples;  // at most kIrradianceSamplesPerScene
  Sun sun;
  Rim rim;
};

// In the form that a frame takes them.
Lighting MakeLighting(const LightsSetup& setup);

}  // namespace pelt
