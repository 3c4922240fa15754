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
  MeanLight all;
  std::vector<MeanLight> of_actor(shape.character_count);
  for (uint32_t l = 0; l < shape.layer_count; ++l) {
    if (!(shape.layer_kind[l] & kLayerLit)) continue;
    const auto* block = scene.memory().Of<&Streams::layer_light>(l);
    if (IsDark(*block)) continue;
    blocks[l] = block;
    all.Add(LitBy(*block));
    of_actor[shape.layer_character[l]].Add(LitBy(*block));
  }
  const PictureLook other = all.MeanOr(DefaultLook());
  for (const MeanLight& actor : of_actor) actors_.push_back(actor.MeanOr(other));
  for (uint32_t l = 0; l < shape.layer_count; ++l)
    layers_.push_back(blocks[l] ? LitBy(*blocks[l]) : actors_[shape.layer_character[l]]);
}

}  // namespace pelt
