// The drawn hairs of a frame as an engine would read them: draw list, sorted instances, ribbons, lines.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "bench/picture/canvas.hpp"
#include "bench/shading/shading.hpp"
#include "jobs/scene.hpp"

namespace pelt {

inline constexpr uint32_t kCurveKnots = kMostPieces + 1;

// Strands as wide as this when they were baked, m, are cards of several hairs; no hair is, and few tufts are.
inline constexpr float kCardWidth = 0.004f;

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
  uint32_t film_strip;     // of bench/shading/shaders/film_strip.glsl
  bool is_card;            // wide enough to show silhouettes, or with a texture
  bool has_texture;        // an artist's
  glm::vec3 root, normal;  // on the skin
  glm::vec4 paint;         // amounts, none of a layer that is not lit
  PaintLook paint_look;
  float shadow = 1.0f;  // how much wider it is in shadow maps; 0: another stands for it there

  float Alpha() const { return float(base_colour >> 24) / 255.0f; }
  // How far above the skin light is whole: the tip's height, or for hair that lies flat a share of its length.
  float DepthOfLight() const;
  // Of the light that falls on it, the share that it keeps.
  float Opacity() const { return is_card ? Alpha() * StripShare(film_strip) : Alpha(); }
};

// A record's amounts, and what a draw says of how they look.
glm::vec4 PaintOf(const LookRecord& record);
PaintLook PaintLookOf(const LayerDraw& draw);

// Layer by layer in the drawing order, each layer far to near.
std::vector<std::vector<Hair>> ReadHairs(const FurScene& scene, VertexOrder order);

// How many of Pelt's own film strips their cards need, from the first; 0 without such cards.
uint32_t CountStrips(const std::vector<std::vector<Hair>>& layers);

// A hair's knots as they are painted: lit, projected, as wide as in the picture. `depth_light` and `sun_share` as
// HairPoint has them.
HairEnd ShadeKnot(const Hair& hair, uint32_t k, const LightSet& light, const HairLook& look,
                  float depth_light, float sun_share, const Projection& projection);

}  // namespace pelt
