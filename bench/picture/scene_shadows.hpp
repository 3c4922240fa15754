// The sun's shadows of a whole scene: a map for each character, as one over all of them would be too coarse for hair.
#pragma once

#include <vector>

#include "bench/picture/body.hpp"
#include "bench/picture/hairs.hpp"
#include "bench/picture/shadow_map.hpp"

namespace pelt {

class SceneShadows {
 public:
  SceneShadows(const glm::vec3& to_sun, const std::vector<Body>& bodies,
               const std::vector<std::vector<Hair>>& layers);

  // Share of the sun that reaches a place on a character: past itself and those whose shadows meet it.
  float OnActor(uint32_t actor, const glm::vec3& world) const;
  // How much of the sun is kept from a place on the ground, softly: 0 to 1.
  float OnGround(const glm::vec3& world) const;
  // A normal's length by which skin is lifted out of its own shadow, m.
  float Lift(uint32_t actor) const { return lift_[actor]; }

 private:
  std::vector<ShadowMap> maps_;
  std::vector<float> lift_;
  std::vector<std::vector<uint32_t>>
      near_;  // for each map, those whose rays may meet it, and itself
};

}  // namespace pelt
