// Lights that a picture can be taken in, by name.
#pragma once

#include <string_view>

#include "bench/shading/default_look.hpp"

namespace pelt {

namespace named_lights_detail {

// Level, from what is seen to the eye, and to the right of that as the eye sees it.
struct Stage {
  glm::vec3 to_eye, right;
};

inline LightSet WithSky(const glm::vec3& sky, const glm::vec3& floor) {
  LightSet light{};
  const glm::vec3 up(0.0f, 1.0f, 0.0f);
  const glm::vec4 half = ShHemisphere() * ShWindow(6.0f);
  ShAddZonal(up, half, sky, light.sky);
  ShAddZonal(-up, half, floor, light.sky);
  light.to_sun = light.to_rim = up;
  return light;
}

inline LightSet Studio(const Stage&) { return DefaultLights(); }

inline LightSet DarkRim(const Stage&) {
  LightSet light = DefaultLights();
  light.rim *= -0.8f;
  return light;
}

inline LightSet Backlit(const Stage& stage) {
  LightSet light = WithSky({0.26f, 0.30f, 0.40f}, {0.16f, 0.14f, 0.14f});
  light.to_sun = glm::normalize(-stage.to_eye + 0.25f * stage.right + glm::vec3(0.0f, 0.45f, 0.0f));
  light.sun = {2.9f, 2.5f, 2.0f};
  light.to_rim = light.to_sun;
  light.rim = {2.2f, 1.9f, 1.5f};
  return light;
}

inline LightSet Overcast(const Stage&) {
  return WithSky({1.15f, 1.2f, 1.3f}, {0.42f, 0.41f, 0.40f});
}

inline LightSet Evening(const Stage& stage) {
  LightSet light = WithSky({0.30f, 0.36f, 0.58f}, {0.20f, 0.16f, 0.14f});
  light.to_sun = glm::normalize(stage.right + 0.35f * stage.to_eye + glm::vec3(0.0f, 0.35f, 0.0f));
  light.sun = {2.6f, 1.45f, 0.62f};
  light.to_rim = glm::normalize(-stage.right - 0.6f * stage.to_eye + glm::vec3(0.0f, 0.5f, 0.0f));
  light.rim = {0.35f, 0.50f, 0.95f};
  return light;
}

}  // namespace named_lights_detail

struct NamedLight {
  std::string_view name, text;
  LightSet (*make)(const named_lights_detail::Stage& stage);
  glm::vec3 room;  // PictureLook has it
};

inline constexpr NamedLight kNamedLights[] = {
    {"studio", "a warm sun, a pale sky, a cool light behind", &named_lights_detail::Studio,
     glm::vec3(1.0f)},
    {"dark-rim", "the studio, with outlines darker instead of brighter",
     &named_lights_detail::DarkRim, glm::vec3(1.0f)},
    {"backlit",
     "the sun behind what is seen",
     &named_lights_detail::Backlit,
     {0.42f, 0.44f, 0.50f}},
    {"overcast", "a grey sky alone", &named_lights_detail::Overcast, {0.92f, 0.93f, 0.95f}},
    {"evening",
     "a low red sun from the right, a blue sky",
     &named_lights_detail::Evening,
     {0.62f, 0.50f, 0.52f}},
};

// As the eye at `eye` sees what stands at `target`; from straight above, as one at +z does.
inline LightSet MakeLight(const NamedLight& light, const glm::vec3& eye, const glm::vec3& target) {
  const glm::vec3 level(eye.x - target.x, 0.0f, eye.z - target.z);
  const float length = glm::length(level);
  const glm::vec3 to_eye = length > 1e-6f ? level / length : glm::vec3(0.0f, 0.0f, 1.0f);
  return light.make({to_eye, glm::cross(glm::vec3(0.0f, 1.0f, 0.0f), to_eye)});
}

}  // namespace pelt
