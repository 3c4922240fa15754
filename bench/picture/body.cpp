#include "bench/picture/body.hpp"

#include <algorithm>
#include <cmath>

#include "bench/picture/eyes.hpp"
#include "bench/picture/mapped_fur.hpp"
#include "bench/picture/relief_coat.hpp"
#include "bench/picture/skin_fur.hpp"
#include "bench/view/studio.hpp"

namespace pelt {
namespace {

void PoseVertices(const PaletteBlock& palette, Body& body) {
  const Mesh& mesh = body.character->mesh;
  for (size_t v = 0; v < mesh.position.size(); ++v) {
    glm::vec3 position(0.0f), normal(0.0f);
    for (int i = 0; i < 4; ++i) {
      const float* m = palette.matrix[mesh.joints[v][size_t(i)]];
      const float weight = mesh.weights[v][i];
      for (int r = 0; r < 3; ++r) {
        const glm::vec3 row(m[4 * r], m[4 * r + 1], m[4 * r + 2]);
        position[r] += weight * (glm::dot(row, mesh.position[v]) + m[4 * r + 3]);
        normal[r] += weight * glm::dot(row, mesh.normal[v]);
      }
    }
    const float length = glm::length(normal);
    body.position.push_back(position);
    body.normal.push_back(length > 0.0f ? normal / length : glm::vec3(0.0f, 1.0f, 0.0f));
  }
}

// Of strands thrown at random onto the skin, the share of it that is below at least one.
void CoverBody(const SkinFur& fur, Body& body) {
  const std::vector<float> area = AreasRoundVertices(body.character->mesh, body.position);
  float furry = 0.0f;
  for (size_t v = 0; v < area.size(); ++v) {
    body.covered.push_back(1.0f - std::exp(-fur.area[v] / std::max(area[v], 1e-9f)));
    if (fur.area[v] <= 0.0f) continue;
    body.mean_covered += body.covered[v] * area[v];
    furry += area[v];
  }
  body.mean_covered /= std::max(furry, 1e-9f);
}

glm::vec3 UnlitColour(const glm::vec3& own) {
  return {Untone(own.r), Untone(own.g), Untone(own.b)};
}

class BodyPainter {
 public:
  BodyPainter(const Body& body, const PictureLook& look, const SunShare& sun,
              const Projection& projection)
      : body_(body), look_(look), eye_(projection.eye()) {
    for (size_t v = 0; v < body.position.size(); ++v) {
      screen_.push_back(projection.Project(body.position[v]));
      sun_.push_back(sun(body.position[v], body.normal[v]));
    }
  }

  // At the corners alone where all is even between them.
  void Draw(uint32_t triangle, Canvas& canvas) const {
    const auto& corner = body_.character->mesh.triangles[triangle];
    const auto draw = [&](auto shade) {
      canvas.DrawTriangle(screen_[corner[0]], screen_[corner[1]], screen_[corner[2]], shade);
    };
    if (body_.surface->IsCut(triangle))
      return canvas.DrawShellTriangle(screen_[corner[0]], screen_[corner[1]], screen_[corner[2]], 0,
                                      [&](const glm::vec3& bary, glm::vec4& colour) {
                                        colour = glm::vec4(Shade({triangle, bary}), 1.0f);
                                        return !body_.surface->IsHole({triangle, bary});
                                      });
    if (body_.surface->HasImage(triangle) || body_.surface->IsUnlit(triangle) ||
        IsMapped(body_, triangle) || (body_.relief && body_.relief->Covers(triangle)))
      return draw([&](const glm::vec3& bary) { return Shade({triangle, bary}); });
    const glm::vec3 first = Shade({triangle, {1.0f, 0.0f, 0.0f}}),
                    second = Shade({triangle, {0.0f, 1.0f, 0.0f}}),
                    third = Shade({triangle, {0.0f, 0.0f, 1.0f}});
    draw([&](const glm::vec3& bary) { return first * bary.x + second * bary.y + third * bary.z; });
  }

 private:
  glm::vec3 Shade(const SurfacePoint& point) const {
    const auto at = [&](const auto& values) {
      return Interpolate(values, body_.character->mesh, point);
    };
    const float covered = CoveredAt(body_, point);
    glm::vec3 colour = at(body_.fur);
    const bool unlit = body_.surface->IsUnlit(point.triangle);
    if (!unlit && body_.surface->Knows(point.triangle))
      colour = glm::mix(body_.surface->At(point), colour, covered);
    if (const glm::vec4 paint = at(body_.paint); covered > 0.0f && paint != glm::vec4(0.0f))
      colour = PaintedColour(body_.paint_look, colour, paint);
    glm::vec3 skin = ShadeSkin(look_.light, look_.hair, colour, glm::normalize(at(body_.normal)),
                               glm::normalize(eye_ - at(body_.position)),
                               DepthFloor(covered, look_.depth_floor), at(sun_));
    if (unlit) skin = glm::mix(UnlitColour(body_.surface->At(point)), skin, covered);
    if (!body_.relief) return skin;
    return body_.relief->Shade(body_, point, look_, eye_, at(sun_), skin);
  }

  const Body& body_;
  const PictureLook& look_;
  glm::vec3 eye_;
  std::vector<glm::vec3> screen_;
  std::vector<float> sun_;
};

}  // namespace

float DepthFloor(float covered, float floor) { return glm::mix(1.0f, floor, covered); }

Body PoseBody(const Scenario& scenario, const FurScene& scene, uint32_t actor,
              std::shared_ptr<const SurfaceColour> surface,
              std::shared_ptr<const ReliefCoat> relief, std::span<const SharedGrowth> growth,
              const SkinFurFinder* skin) {
  Body body;
  body.surface = std::move(surface);
  body.character = &scenario.characters[scenario.actors[actor].character];
  PoseVertices(*scene.memory().Of<&Streams::palette>(actor), body);
  const SkinFur fur = skin ? skin->Find(scene) : FindSkinFur(scene, actor, body.character->mesh);
  body.fur = fur.colour;
  body.fur_tip = fur.tip;
  body.paint = fur.paint;
  body.paint_look = kDefaultPaint;
  body.paint_look.wet_darken = 0.0f;
  body.paint_look.mud = fur.mud_colour;
  body.furry_material = fur.on_material;
  CoverBody(fur, body);
  MapFur(fur, growth, body);
  body.eyes = FindEyes(body);
  if (relief) body.axes = FindTextureAxes(body.character->mesh, body.position);
  body.relief = std::move(relief);
  return body;
}

void DrawBody(const Body& body, const PictureLook& look, const SunShare& sun,
              const Projection& projection, Canvas& canvas) {
  const BodyPainter painter(body, look, sun, projection);
  canvas.BeginShells();  // skin with holes is drawn as shell 0
  for (uint32_t t = 0; t < body.character->mesh.triangles.size(); ++t) painter.Draw(t, canvas);
  for (const Eye& eye : body.eyes) DrawEye(eye, look.light, look.hair, projection, canvas);
}

}  // namespace pelt
