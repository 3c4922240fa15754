#include "bench/picture/eyes.hpp"

#include <algorithm>
#include <cmath>

#include "bench/view/studio.hpp"

namespace pelt {
std::vector<Eye> FindEyes(const Body& body) {
  const Mesh& mesh = body.character->mesh;
  std::vector<Eye> eyes;
  for (const bool left : {false, true}) {
    std::vector<uint32_t> corners;
    for (size_t t = 0; t < mesh.triangles.size(); ++t)
      for (const uint32_t v : mesh.triangles[t])
        if (mesh.materials[mesh.triangle_material[t]] == "eye" &&
            (mesh.position[v].x > 0.0f) == left)
          corners.push_back(v);
    if (corners.empty()) continue;
    Eye eye;
    for (const uint32_t v : corners) {
      eye.centre += body.position[v] / float(corners.size());
      eye.forward += body.normal[v];
    }
    eye.forward = glm::normalize(eye.forward);
    for (const uint32_t v : corners)
      eye.radius = std::max(eye.radius, glm::length(body.position[v] - eye.centre));
    eye.radius *= 0.85f;
    eye.centre -= eye.forward * (0.4f * eye.radius);
    eyes.push_back(eye);
  }
  // Both look the same way, or nearly.
  glm::vec3 ahead(0.0f);
  for (const Eye& eye : eyes) ahead += eye.forward;
  for (Eye& eye : eyes) eye.forward = glm::normalize(ahead + 0.35f * eye.forward);
  return eyes;
}

void DrawEye(const Eye& eye, const LightSet& light, const HairLook& look,
             const Projection& projection, Canvas& canvas) {
  const glm::vec3 middle = projection.Project(eye.centre);
  const float reach = 1.2f * eye.radius * projection.SamplesPerMetre(middle.z);
  const auto clamp = [](float v, uint32_t end) {
    return uint32_t(std::clamp(v, 0.0f, float(end)));
  };
  for (uint32_t y = clamp(middle.y - reach, canvas.height());
       y < clamp(middle.y + reach, canvas.height()); ++y)
    for (uint32_t x = clamp(middle.x - reach, canvas.width());
         x < clamp(middle.x + reach, canvas.width()); ++x) {
      const glm::vec3 ray = projection.RayThrough(float(x) + 0.5f, float(y) + 0.5f);
      const glm::vec3 from = projection.eye() - eye.centre;
      const float along = glm::dot(from, ray);
      const float inside = along * along - glm::dot(from, from) + eye.radius * eye.radius;
      if (inside < 0.0f) continue;
      const glm::vec3 at = projection.eye() + ray * (-along - std::sqrt(inside));
      canvas.DrawPoint(x, y, projection.Project(at).z,
                       ShadeEye(light, look, eye.forward, (at - eye.centre) / eye.radius, -ray));
    }
}

}  // namespace pelt
