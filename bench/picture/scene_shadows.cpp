#include "bench/picture/scene_shadows.hpp"

#include "bench/picture/shell_shadow.hpp"

namespace pelt {
SceneShadows::SceneShadows(const PictureScene& scene)
    : look_(scene.look.shadow), near_(scene.bodies.size()) {
  const glm::vec3& to_sun = scene.look.light.to_sun;
  const std::vector<Body>& bodies = scene.bodies;
  const std::vector<Ball> balls = BoundActors(scene);
  for (uint32_t a = 0; a < bodies.size(); ++a) {
    ShadowMap& map = maps_.emplace_back(to_sun, balls[a].centre, balls[a].radius, kShadowTexels);
    lift_.push_back(kLiftTexels * 2.0f * balls[a].radius / float(kShadowTexels));
    for (const auto& [p, q, r] : bodies[a].character->mesh.triangles)
      map.AddTriangle(bodies[a].position[p], bodies[a].position[q], bodies[a].position[r]);
    for (uint32_t b = 0; b < bodies.size(); ++b)
      if (a == b || ShadowMeets(balls[a], balls[b], to_sun)) near_[a].push_back(b);
  }
  for (const auto& hairs : scene.layers)
    for (const Hair& hair : hairs)
      for (uint32_t k = 1; k < hair.knots; ++k)
        maps_[hair.actor].AddHair(hair.knot[k - 1].at, hair.knot[k].at, hair.knot[k].width,
                                  hair.Opacity());
  for (size_t i = 0; i < scene.draws.size(); ++i)
    AddShells(scene.draws[i], scene.textures[i], maps_[scene.actors[i]]);
  for (ShadowMap& map : maps_) map.Soften(kSoftTexels);
}

float SceneShadows::OnActor(uint32_t actor, const glm::vec3& world) const {
  float share = 1.0f;
  for (const uint32_t map : near_[actor]) share *= maps_[map].Share(world, look_);
  return share;
}

float SceneShadows::OnGround(const glm::vec3& world) const {
  float light = 1.0f;
  for (const ShadowMap& map : maps_)
    if (map.Covers(world)) light *= 1.0f - map.Blocked(world);
  return 1.0f - light;
}

}  // namespace pelt
