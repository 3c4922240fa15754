#include "bench/picture/frame_light.hpp"

#include <algorithm>

#include "bench/picture/canvas.hpp"

namespace pelt {
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

}  // namespace pelt
