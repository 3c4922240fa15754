// The sun's shadows of a whole scene: a map for each character, as one over all of them would be too coarse for hair.
#pragma once

#include <vector>

#include "bench/picture/picture_scene.hpp"
#include "bench/picture/shadow_map.hpp"

namespace pelt {

inline constexpr uint32_t kShadowTexels =
    384;                               // a side: a few millimetres on a character a metre tall
inline constexpr int kSoftTexels = 6;  // of half shadow round what the ground is shaded by
inline constexpr float kLiftTexels = 1.5f;

class SceneShadows {
 public:
  explicit SceneShadows(const PictureScene& scene);

  // Share of the sun that reaches a place on a character: past itself and those whose shadows meet it.
  float OnActor(uint32_t actor, const glm::vec3& world) const;
  // How much of the sun is kept from a place on the ground, softly: 0 to 1.
  float OnGround(const glm::vec3& world) const;
  // A normal's length by which skin is lifted out of its own shadow, m.
  float Lift(uint32_t actor) const { return lift_[actor]; }

 private:
  ShadowLook look_;
  std::vector<ShadowMap> maps_;
  std::vector<float> lift_;
  std::vector<std::vector<uint32_t>>
      near_;  // for each map, those whose rays may meet it, and itself
};

}  // namespace pelt
