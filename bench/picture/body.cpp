#include "bench/picture/body.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <span>
#include <vector>

#include "bench/picture/relief_coat.hpp"
#include "bench/picture/skin_fur.hpp"
#include "bench/shading/shading.hpp"

namespace pelt {
namespace {

// How much hair the layers of a body have where their maps let all of it grow, found from the hair that stands there.
float AreaOf(const Body& body, uint32_t triangle) {
  const auto& corner = body.character->mesh.triangles[triangle];
  const glm::vec3& p = body.position[corner[0]];
  return 0.5f * glm::length(glm::cross(body.position[corner[1]] - p, body.position[corner[2]] - p));
}

// What a layer covers at each place, by the maps' shares alone; m^2.
std::vector<float> AreaByShare(const Body& body, const SkinFur& fur, const GrowthSheets& growth) {
  std::vector<float> area(fur.place.size(), 0.0f);
  for (uint32_t t = 0; t < body.character->mesh.triangles.size(); ++t) {
    const glm::vec3 part = growth.CornerShare(t) * AreaOf(body, t);
    for (int k = 0; k < 3; ++k)
      area[fur.place[body.character->mesh.triangles[t][size_t(k)]]] += part[k];
  }
  return area;
}

// Few hairs at the edge of a bald spot are an accident: there the layer's mean counts as well, as much as a share of
// the mean skin round a vertex.
std::vector<float> FindRates(const Body& body, const SkinFur& fur, const SkinFur::OfLayer& layer,
                             const GrowthSheets& growth) {
  constexpr float kMeansShare = 0.02f;
  const std::vector<float> by_share = AreaByShare(body, fur, growth);
  std::vector<float> hair(by_share.size(), 0.0f);  // at each place
  for (size_t v = 0; v < layer.area.size(); ++v) hair[fur.place[v]] = layer.area[v];
  const float all = std::accumulate(by_share.begin(), by_share.end(), 0.0f);
  const float mean = std::accumulate(hair.begin(), hair.end(), 0.0f) / std::max(all, 1e-12f);
  const float weight = std::max(kMeansShare * all / float(by_share.size()), 1e-12f);
  std::vector<float> rate;
  for (const uint32_t place : fur.place)
    rate.push_back((hair[place] + mean * weight) / (by_share[place] + weight));
  return rate;
}

// A third of the area of the triangles round each vertex.
std::vector<float> AreasRoundVertices(const Mesh& mesh, const std::vector<glm::vec3>& position) {
  std::vector<float> area(position.size(), 0.0f);
  for (const auto& triangle : mesh.triangles) {
    const glm::vec3& p = position[triangle[0]];
    const float third =
        glm::length(glm::cross(position[triangle[1]] - p, position[triangle[2]] - p)) / 6.0f;
    for (const uint32_t v : triangle) area[v] += third;
  }
  return area;
}

// Fills mapped and unmapped of a posed body. `growth` as PoseBody has it.
void MapFur(const SkinFur& fur, std::span<const SharedGrowth> growth, Body& body) {
  if (growth.empty()) return;
  std::vector<float> rest(body.position.size(), 0.0f);
  for (const SkinFur::OfLayer& layer : fur.layers) {
    if (const SharedGrowth& sheets = growth[layer.layer];
        sheets && body.mapped.size() < kMappedLayers)
      body.mapped.push_back({sheets, FindRates(body, fur, layer, *sheets)});
    else
      for (size_t v = 0; v < rest.size(); ++v) rest[v] += layer.area[v];
  }
  if (body.mapped.empty()) return;
  const std::vector<float> area = AreasRoundVertices(body.character->mesh, body.position);
  for (size_t v = 0; v < rest.size(); ++v)
    body.unmapped.push_back(rest[v] / std::max(area[v], 1e-9f));
}

// Eyeballs of the built-in character: one for each side of the character's middle that has triangles of the material "eye".
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
  BodyPainter(const Body& body, const PictureLook& look, std::span<const PictureLook> relief_looks,
              const ReliefShow& show, const SunShare& sun, const Projection& projection,
              ReliefCount& count)
      : body_(body),
        look_(look),
        relief_looks_(relief_looks),
        show_(show),
        projection_(projection),
        eye_(projection.eye()),
        count_(count) {
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
    ReliefShow show = show_;
    if (show.frame >= 0) {
      const glm::vec2 sample = glm::floor(glm::vec2(projection_.Project(at(body_.position))));
      show.march.jitter = ReliefJitter(sample, float(show.frame));
    }
    return body_.relief->Shade(body_, point, relief_looks_, show, eye_, at(sun_), skin, count_);
  }

  const Body& body_;
  const PictureLook& look_;
  std::span<const PictureLook> relief_looks_;
  const ReliefShow& show_;
  const Projection& projection_;
  glm::vec3 eye_;
  ReliefCount& count_;
  std::vector<glm::vec3> screen_;
  std::vector<float> sun_;
};

}  // namespace

bool IsMapped(const Body& body, uint32_t triangle) {
  return std::ranges::any_of(body.mapped, [&](const MappedFur& mapped) {
    return mapped.growth->SheetOf(triangle) != FlowMap::kNoSheet;
  });
}

float CoveredAt(const Body& body, const SurfacePoint& point) {
  const Mesh& mesh = body.character->mesh;
  if (!body.furry_material[mesh.triangle_material[point.triangle]]) return 0.0f;
  if (!IsMapped(body, point.triangle)) return Interpolate(body.covered, mesh, point);
  const glm::vec2 uv = Interpolate(mesh.uv, mesh, point);
  float hair = Interpolate(body.unmapped, mesh, point);
  for (const MappedFur& mapped : body.mapped)
    if (const uint16_t sheet = mapped.growth->SheetOf(point.triangle); sheet != FlowMap::kNoSheet)
      hair += Interpolate(mapped.rate, mesh, point) * mapped.growth->At(sheet, uv);
  return 1.0f - std::exp(-hair);
}

void JoinSeams(Body& body) {
  const std::vector<float> area = AreasRoundVertices(body.character->mesh, body.position);
  const auto place = [&](size_t v) {
    const glm::vec3& p = body.position[v];
    return std::array{p.x, p.y, p.z};
  };
  std::map<std::array<float, 3>, float> whole;
  for (size_t v = 0; v < area.size(); ++v) whole[place(v)] += area[v];
  for (size_t v = 0; v < area.size(); ++v) {
    const float own = area[v] / std::max(whole[place(v)], 1e-12f);
    body.covered[v] = 1.0f - std::pow(1.0f - body.covered[v], own);
    if (!body.unmapped.empty()) body.unmapped[v] *= own;
  }
}

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

void DrawBody(const Body& body, const PictureLook& look, std::span<const PictureLook> relief_looks,
              const ReliefShow& show, const SunShare& sun, const Projection& projection,
              Canvas& canvas, ReliefCount& count) {
  const BodyPainter painter(body, look, relief_looks, show, sun, projection, count);
  canvas.BeginShells();  // skin with holes is drawn as shell 0
  for (uint32_t t = 0; t < body.character->mesh.triangles.size(); ++t) painter.Draw(t, canvas);
  for (const Eye& eye : body.eyes) DrawEye(eye, look.light, look.hair, projection, canvas);
}

}  // namespace pelt
