#include "bench/picture/scene_shadows.hpp"

#include <algorithm>

namespace pelt {
namespace {

constexpr uint32_t kSide = 384;  // texels of a few millimetres on a character a metre tall
constexpr int kSoft = 6;         // texels of half shadow round what the ground is shaded by
constexpr float kLiftTexels = 1.5f;

struct Ball {
  glm::vec3 centre;
  float radius;
};

std::vector<Ball> BoundActors(const std::vector<Body>& bodies,
                              const std::vector<std::vector<Hair>>& layers) {
  struct Box {
    glm::vec3 low{1e30f}, high{-1e30f};
    void Add(const glm::vec3& p) {
      low = glm::min(low, p);
      high = glm::max(high, p);
    }
  };
  std::vector<Box> boxes(bodies.size());
  for (size_t a = 0; a < bodies.size(); ++a)
    for (const glm::vec3& p : bodies[a].position) boxes[a].Add(p);
  for (const auto& hairs : layers)
    for (const Hair& hair : hairs) boxes[hair.actor].Add(hair.knot[hair.knots - 1].at);
  std::vector<Ball> balls;
  for (const Box& box : boxes)
    balls.push_back({(box.low + box.high) * 0.5f, 0.52f * glm::length(box.high - box.low) + 0.01f});
  return balls;
}

// Whether b's shadow may fall on a.
bool Meet(const Ball& a, const Ball& b, const glm::vec3& to_sun) {
  const glm::vec3 apart = b.centre - a.centre;
  const float towards = glm::dot(apart, to_sun);
  return towards > -a.radius - b.radius &&
         glm::length(apart - towards * to_sun) < a.radius + b.radius;
}

}  // namespace

SceneShadows::SceneShadows(const glm::vec3& to_sun, const std::vector<Body>& bodies,
                           const std::vector<std::vector<Hair>>& layers)
    : near_(bodies.size()) {
  const std::vector<Ball> balls = BoundActors(bodies, layers);
  for (uint32_t a = 0; a < bodies.size(); ++a) {
    ShadowMap& map = maps_.emplace_back(to_sun, balls[a].centre, balls[a].radius, kSide);
    lift_.push_back(kLiftTexels * 2.0f * balls[a].radius / float(kSide));
    for (const auto& [p, q, r] : bodies[a].character->mesh.triangles)
      map.AddTriangle(bodies[a].position[p], bodies[a].position[q], bodies[a].position[r]);
    for (uint32_t b = 0; b < bodies.size(); ++b)
      if (a == b || Meet(balls[a], balls[b], to_sun)) near_[a].push_back(b);
  }
  for (const auto& hairs : layers)
    for (const Hair& hair : hairs)
      for (uint32_t k = 1; k < hair.knots; ++k)
        maps_[hair.actor].AddHair(hair.knot[k - 1].at, hair.knot[k].at, hair.knot[k].width,
                                  hair.Alpha());
  for (ShadowMap& map : maps_) map.Soften(kSoft);
}

float SceneShadows::OnActor(uint32_t actor, const glm::vec3& world) const {
  float share = 1.0f;
  for (const uint32_t map : near_[actor]) share *= maps_[map].Share(world);
  return share;
}

float SceneShadows::OnGround(const glm::vec3& world) const {
  float light = 1.0f;
  for (const ShadowMap& map : maps_)
    if (map.Covers(world)) light *= 1.0f - map.Blocked(world);
  return 1.0f - light;
}

}  // namespace pelt
