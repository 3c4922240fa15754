// The drawn hairs of a frame as an engine would read them: draw list, sorted instances, ribbons, lines.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "jobs/scene.hpp"

namespace pelt {

inline constexpr uint32_t kCurveKnots = 9;  // a cubic is drawn as eight straight pieces

struct HairKnot {
  glm::vec3 at;  // world, m
  float width;   // m
};

struct Hair {
  std::array<HairKnot, kCurveKnots> knot;
  uint32_t knots;
  uint32_t base_colour, tip_colour;  // 0xAABBGGRR
  uint32_t actor;
  uint32_t number;         // of the strand among all of the scene
  glm::vec3 root, normal;  // on the skin

  float Alpha() const { return float(base_colour >> 24) / 255.0f; }
  // How far above the skin light is whole: the tip's height, or for hair that lies flat a share of its length.
  float DepthOfLight() const;
};

// Layer by layer in the drawing order, each layer far to near.
std::vector<std::vector<Hair>> ReadHairs(const FurScene& scene, VertexOrder order);

}  // namespace pelt
