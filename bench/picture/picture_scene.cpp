#include "bench/picture/picture_scene.hpp"

#include <algorithm>

#include "bench/picture/relief_coat.hpp"
#include "bench/shading/shading.hpp"

namespace pelt {
namespace {

// Of the scene's layers.
std::vector<SharedGrowth> FindGrowth(const PictureMaps& maps, const FurScene& scene) {
  std::vector<SharedGrowth> growth;
  for (uint32_t l = 0; l < scene.shape().layer_count; ++l)
    growth.push_back(maps.GrowthOf(scene.shape().layer_character[l], scene.LayerName(l)));
  return growth;
}

ShellGrowth GrowthOfShells(const Scenario& scenario, const FurScene& scene, const LayerDraw& draw,
                           const SharedGrowth& sheets) {
  if (draw.format().OfStrands() || !sheets) return {};
  const Actor& actor = scenario.actors[scene.shape().layer_character[draw.layer]];
  return {sheets,
          SheetsOfShells(scene, draw.layer, scenario.characters[actor.character].mesh, *sheets)};
}

}  // namespace

PictureScene GatherPicture(const Scenario& scenario, const FurScene& scene, const Camera& camera,
                           VertexOrder order, std::vector<std::string>& notes,
                           std::span<const std::string> relief) {
  const PictureMaps maps(scenario, relief);
  notes.insert(notes.end(), maps.notes().begin(), maps.notes().end());
  return GatherPicture(scenario, maps, scene, camera, order);
}

PictureScene GatherPicture(const Scenario& scenario, const PictureMaps& maps, const FurScene& scene,
                           const Camera& camera, VertexOrder order, std::span<const Body> posed) {
  const std::vector<SharedGrowth> growth = FindGrowth(maps, scene);
  PictureScene shown{};
  shown.camera = camera;
  shown.order = order;
  shown.bodies.assign(posed.begin(), posed.end());
  for (uint32_t a = 0; posed.empty() && a < scenario.actors.size(); ++a)
    shown.bodies.push_back(PoseBody(scenario, scene, a,
                                    maps.SurfaceOf(scenario.actors[a].character), maps.ReliefOf(a),
                                    growth, &maps.SkinOf(scenario, scene, a)));
  const std::span<const LayerDraw> draws = scene.Draws();
  shown.draws.assign(draws.begin(), draws.end());
  shown.layers = ReadHairs(scene, order);
  RemoveRelief(scenario, scene, maps.relief(), maps.has_rim(), shown.layers, shown.draws);
  for (const LayerDraw& draw : draws) {
    shown.growth.push_back(GrowthOfShells(scenario, scene, draw, growth[draw.layer]));
    FurTexture& texture = shown.textures.emplace_back();
    if (!draw.format().OfStrands()) texture.texels = scene.FurTexture(draw.layer, texture.side);
    shown.strips.push_back(maps.StripsOf(scene.StrandTextureOf(draw.layer)));
    shown.actors.push_back(scene.shape().layer_character[draw.layer]);
  }
  LightPicture(scene, shown);
  return shown;
}

namespace {

PictureLook LitBy(const LayerLightBlock& block) {
  PictureLook lit = DefaultLook();
  lit.light = {};
  lit.light.to_sun = VecOf(block.sun_direction);
  lit.light.sun = VecOf(block.sun_rgb);
  lit.light.to_rim = VecOf(block.rim_direction);
  lit.light.rim = VecOf(block.rim_rgb);
  for (uint32_t i = 0; i < kHarmonics; ++i)
    lit.light.sky[i] = {block.harmonics[0][i], block.harmonics[1][i], block.harmonics[2][i]};
  lit.hair.rim_exponent = block.rim_exponent;
  return lit;
}

bool IsDark(const LayerLightBlock& block) {
  const auto none = [](const auto& values) {
    return std::ranges::all_of(values, [](float v) { return v == 0.0f; });
  };
  return none(block.harmonics[0]) && none(block.harmonics[1]) && none(block.harmonics[2]) &&
         none(block.sun_rgb) && none(block.rim_rgb);
}

// What floor and walls have of it: a white floor's light and the mean of white walls on four sides.
glm::vec3 RoomLight(const LightSet& light) {
  const auto on = [&light](const glm::vec3& normal) {
    const float facing = std::max(glm::dot(normal, light.to_sun), 0.0f);
    return ShLight(light.sky, normal, kShLambert) + light.sun * facing;
  };
  glm::vec3 walls(0.0f);
  for (const float side : {-1.0f, 1.0f}) {
    walls += on({side, 0.0f, 0.0f});
    walls += on({0.0f, 0.0f, side});
  }
  return on({0.0f, 1.0f, 0.0f}) + 0.25f * walls;
}

// Lights from all around are added up; sun and rim are one for the whole scene.
struct MeanLight {
  PictureLook sum{};
  uint32_t count = 0;

  void Add(const PictureLook& lit) {
    PictureLook next = lit;
    for (uint32_t i = 0; count > 0 && i < kHarmonics; ++i) next.light.sky[i] += sum.light.sky[i];
    sum = next;
    ++count;
  }
  PictureLook MeanOr(const PictureLook& other) const {
    if (count == 0) return other;
    PictureLook mean = sum;
    for (glm::vec3& coefficient : mean.light.sky) coefficient /= float(count);
    return mean;
  }
};

}  // namespace

FrameLight::FrameLight(const FurScene& scene) {
  const SceneShape& shape = scene.shape();
  std::vector<const LayerLightBlock*> blocks(shape.layer_count, nullptr);
  bool is_dark = true;
  for (uint32_t l = 0; l < shape.layer_count; ++l) {
    if (!(shape.layer_kind[l] & kLayerLit)) continue;
    blocks[l] = scene.memory().Of<&Streams::layer_light>(l);
    is_dark = is_dark && IsDark(*blocks[l]);
  }
  // A layer that no light reaches is black beside one that is lit.
  if (is_dark) std::ranges::fill(blocks, nullptr);
  MeanLight all;
  std::vector<MeanLight> of_actor(shape.character_count);
  for (uint32_t l = 0; l < shape.layer_count; ++l) {
    if (!blocks[l]) continue;
    all.Add(LitBy(*blocks[l]));
    of_actor[shape.layer_character[l]].Add(LitBy(*blocks[l]));
  }
  const PictureLook other = all.MeanOr(DefaultLook());
  for (const MeanLight& actor : of_actor) actors_.push_back(actor.MeanOr(other));
  for (uint32_t l = 0; l < shape.layer_count; ++l)
    layers_.push_back(blocks[l] ? LitBy(*blocks[l]) : actors_[shape.layer_character[l]]);
  const glm::vec3 room = RoomLight(other.light) / RoomLight(DefaultLights());
  for (PictureLook& look : actors_) look.room = room;
  for (PictureLook& look : layers_) look.room = room;
}

void LightPicture(const FurScene& scene, PictureScene& shown) {
  const FrameLight light(scene);
  shown.look = light.OnActor(0);
  shown.body_looks.clear();
  for (uint32_t a = 0; a < shown.bodies.size(); ++a) shown.body_looks.push_back(light.OnActor(a));
  // A layer on the skin has the skin's light, and its own highlights.
  shown.relief_looks.assign(shown.bodies.size(), {});
  for (uint32_t a = 0; a < shown.bodies.size(); ++a) {
    if (!shown.bodies[a].relief) continue;
    for (const ReliefCoat::Layer& layer : shown.bodies[a].relief->layers()) {
      PictureLook& look = shown.relief_looks[a].emplace_back(light.OnActor(a));
      look.hair = HairLookOf(layer.look, look.hair.rim_exponent);
    }
  }
  shown.layer_looks.clear();
  for (const LayerDraw& draw : shown.draws) {
    PictureLook& look = shown.layer_looks.emplace_back(light.OnLayer(draw.layer));
    look.hair = HairLookOf(scene.Look(draw.layer), look.hair.rim_exponent);
  }
}

std::span<std::vector<std::byte>> OwnVertices(PictureScene& scene) {
  for (size_t i = scene.own_vertices.size(); i < scene.draws.size(); ++i) {
    std::span<const std::byte>& vertices = scene.draws[i].vertices;
    scene.own_vertices.emplace_back(vertices.begin(), vertices.end());
    vertices = scene.own_vertices.back();
  }
  return scene.own_vertices;
}

std::vector<Ball> BoundActors(const PictureScene& scene) {
  struct Box {
    glm::vec3 low{1e30f}, high{-1e30f};
    void Add(const glm::vec3& p) {
      low = glm::min(low, p);
      high = glm::max(high, p);
    }
  };
  std::vector<Box> boxes(scene.bodies.size());
  for (size_t a = 0; a < scene.bodies.size(); ++a)
    for (const glm::vec3& p : scene.bodies[a].position) boxes[a].Add(p);
  for (const auto& hairs : scene.layers)
    for (const Hair& hair : hairs) boxes[hair.actor].Add(hair.knot[hair.knots - 1].at);
  for (size_t i = 0; i < scene.draws.size(); ++i) {
    const LayerDraw& draw = scene.draws[i];
    if (draw.shells.shell.empty()) continue;
    std::vector<uint32_t> indices(WriteShellIndices(draw.shells, {}));
    WriteShellIndices(draw.shells, indices);
    for (const uint32_t v : indices) {
      const ShellVertex& vertex = draw.As<ShellVertex>()[v];
      boxes[scene.actors[i]].Add(
          ShellPosition(VecOf(vertex.position), VecOf(vertex.groom), VecOf(vertex.force), 1.0f));
    }
  }
  std::vector<Ball> balls;
  balls.reserve(boxes.size());
  for (const Box& box : boxes)
    balls.push_back({(box.low + box.high) * 0.5f, 0.52f * glm::length(box.high - box.low) + 0.01f});
  return balls;
}

bool ShadowMeets(const Ball& a, const Ball& b, const glm::vec3& to_sun) {
  const glm::vec3 apart = b.centre - a.centre;
  const float towards = glm::dot(apart, to_sun);
  return towards > -a.radius - b.radius &&
         glm::length(apart - towards * to_sun) < a.radius + b.radius;
}

}  // namespace pelt
