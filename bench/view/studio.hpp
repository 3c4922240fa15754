// What pictures have besides hair and skin: the room round a character, its eyes, and how light becomes a byte.
// shaders/studio.glsl has the same functions, by the same names.
#pragma once

#include "bench/view/strand_light.hpp"

namespace pelt {

// Colours up to the middle as they are, brighter ones ever closer to white: no edge where light is strong.
inline float Tone(float v) {
  const float kept = 0.5f;
  return v <= kept ? v : 1.0f - (1.0f - kept) * std::exp((kept - v) / (1.0f - kept));
}

// What Tone shows as v, 0 to 1: for what is to be seen in its own colour. White is at the end of the
// curve, which nothing reaches: it comes out within half of an 8-bit step.
inline float Untone(float v) {
  const float kept = 0.5f, most = 0.9985f;
  const float left = (1.0f - std::min(v, most)) / (1.0f - kept);
  return v <= kept ? v : kept - (1.0f - kept) * std::log(left);
}

// How far along a unit ray the floor is, at height 0; below 0: nowhere.
inline float FloorDistance(float eye_height, float ray_up) {
  return ray_up >= -1e-3f || eye_height <= 0.0f ? -1.0f : -eye_height / ray_up;
}

// A pale floor that meets a pale wall without an edge; `dark`: the share of the sun kept from the floor there.
inline glm::vec3 StudioColour(const glm::vec3& ray, float dark) {
  const glm::vec3 floor(0.62f, 0.60f, 0.60f), wall(0.46f, 0.55f, 0.66f);
  const glm::vec3 shade(0.46f, 0.47f, 0.56f);  // of the floor where no sun is
  const float dip = Saturate(-ray.y * 4.0f);
  const glm::vec3 colour = glm::mix(wall * (1.0f - 0.5f * std::max(ray.y, 0.0f)), floor, dip);
  return colour * glm::mix(glm::vec3(1.0f), shade, dark);
}

// A place on an eyeball that looks `forward`.
inline glm::vec3 ShadeEye(const LightSet& light, const HairLook& look, const glm::vec3& forward,
                          const glm::vec3& normal, const glm::vec3& to_eye) {
  const glm::vec3 white(0.90f, 0.88f, 0.82f), iris(0.75f, 0.36f, 0.03f), pupil(0.005f);
  const float ahead = glm::dot(normal, forward);
  const glm::vec3 colour = ahead > 0.945f ? pupil : ahead > 0.85f ? iris : white;
  const float glint =
      std::pow(std::max(glm::dot(normal, Halfway(light.to_sun, to_eye)), 0.0f), 150.0f);
  return ShadeSkin(light, look, colour, normal, to_eye, 1.0f, 0.6f) + glm::vec3(3.0f * glint);
}

}  // namespace pelt
