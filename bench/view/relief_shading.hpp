// Fur as relief under a whole set of lights: the terms of relief.hpp and strand_light.hpp put together for a place on
// the skin.
// shaders/relief_shading.glsl has the same functions, by the same names.
#pragma once

#include "bench/view/relief.hpp"
#include "bench/view/strand_light.hpp"

namespace pelt {

inline constexpr float kReliefDepth = 0.3f;  // of the fur's height, that a flat skin can show
inline constexpr float kReliefLeastSteps = 4.0f, kReliefMostSteps = 16.0f;
inline constexpr float kReliefShadow = 0.75f, kReliefRoughness = 0.45f;
inline constexpr float kReliefTileDots = 48.0f;  // hairs along a side of the tile

// A place on the skin, and the fur that grows there.
struct ReliefPoint {
  glm::vec3 colour, tip_colour;  // of the hairs' two ends, linear
  glm::vec3 normal;              // unit
  glm::vec3 axis_u, axis_v;      // metres that the skin goes along for one unit of u and of v
  glm::vec2 uv;
  glm::vec2 repeat;  // how often the tile of hairs goes along u and v
  glm::vec4 flow;    // the flow map's texel, channels 0 to 1
  float longest;     // of the flow map, m
  float floor;       // share of light that reaches the skin
  float sun_share;
  glm::vec3 to_eye;  // unit
};

inline glm::vec3 UnitOr(const glm::vec3& v, const glm::vec3& otherwise) {
  const float length = glm::length(v);
  return length > 1e-12f ? v / length : otherwise;
}

// The steps along u and v that make up the step `d`, as well as they can.
inline glm::vec2 InTexture(const glm::vec3& d, const glm::vec3& u, const glm::vec3& v) {
  const float uu = glm::dot(u, u), uv = glm::dot(u, v), vv = glm::dot(v, v);
  const float det = uu * vv - uv * uv;
  if (!(det > 1e-6f * uu * vv)) return glm::vec2(0.0f);
  const float du = glm::dot(d, u), dv = glm::dot(d, v);
  return glm::vec2(du * vv - dv * uv, dv * uu - du * uv) / det;
}

// Which way along the skin hairs of this flow go; zero where they stand up.
inline glm::vec3 ReliefAlong(const ReliefPoint& p, const glm::vec3& flow) {
  const glm::vec3 along = p.axis_u * flow.x + p.axis_v * flow.y;
  return UnitOr(along - p.normal * glm::dot(along, p.normal), glm::vec3(0.0f));
}

// Columns: along u on the skin, across it, the normal. `along` is what there is without u.
inline glm::mat3 ReliefFrame(const ReliefPoint& p, const glm::vec3& along) {
  const glm::vec3 x = UnitOr(p.axis_u - p.normal * glm::dot(p.axis_u, p.normal), along);
  return {x, glm::cross(p.normal, x), p.normal};
}

// ReliefShift in the tile's coordinates, of directions in the world.
inline glm::vec2 ReliefTileShift(const ReliefPoint& p, const glm::mat3& frame,
                                 const glm::vec3& hair, const glm::vec3& towards, float depth) {
  const glm::vec2 m = ReliefShift(hair * frame, towards * frame, depth);
  return InTexture(frame[0] * m.x + frame[1] * m.y, p.axis_u, p.axis_v) * p.repeat;
}

// The fur's light at the place; height(place) is a height of the tile.
template <class Height>
inline glm::vec3 ShadeRelief(const Height& height, const LightSet& light, const HairLook& look,
                             const ReliefPoint& p) {
  const glm::vec3 flow = ReliefFlow(p.flow);
  const glm::vec3 along = ReliefAlong(p, flow);
  const glm::vec3 hair = UnitOr(along * glm::length(glm::vec2(flow)) + p.normal * flow.z, p.normal);
  const glm::mat3 frame = ReliefFrame(p, along);
  const float depth = kReliefDepth * p.flow.b * p.longest * std::max(flow.z, kReliefLowest);
  const float steps =
      ReliefSteps(hair * frame, p.to_eye * frame, kReliefLeastSteps, kReliefMostSteps);
  const glm::vec3 hit =
      ReliefHit(height, p.uv * p.repeat, ReliefTileShift(p, frame, hair, p.to_eye, depth), steps);
  const glm::vec2 to_sun = ReliefTileShift(p, frame, hair, light.to_sun, depth);

  const glm::ivec2 cell(glm::floor(glm::vec2(hit) * kReliefTileDots));
  const HairPoint point{.colour = glm::mix(p.colour, p.tip_colour, hit.z),
                        .tangent = hair,
                        .normal = p.normal,
                        .to_eye = p.to_eye,
                        .depth_light = ReliefAmbient(hit.z, p.floor),
                        .sun_share = p.sun_share * ReliefShadow(height, hit, to_sun, kReliefShadow),
                        .noise = HashShare(uint32_t(cell.x) * 7919u + uint32_t(cell.y))};
  const glm::vec3 sheen = light.sun * glm::mix(point.colour, glm::vec3(1.0f), 0.25f);
  const float shine = ReliefSheen(p.normal, light.to_sun, p.to_eye, kReliefRoughness);
  return ShadeHair(light, look, point) + sheen * (point.sun_share * shine);
}

}  // namespace pelt
