#include "jobs/input_check.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "core/float_rules.hpp"
#include "core/format.hpp"
#include "jobs/origins.hpp"

namespace pelt {
namespace {

constexpr const char* kNotUsable = "is not finite, or beyond 1e6";

// Shorter frames than a microsecond have no use, and what is divided by their length grows without
// bound: by 1e-38 s it is infinite.
constexpr double kShortest_s = 1.0e-6;
// A lifetime. The wind's course is a function of the time, and a double has to hold it.
constexpr double kLatest_s = 1.0e9;
// Weights are shares of it.
constexpr float kShortestFalloff_m = 1.0e-3f;
constexpr float kLargestExponent = 1000.0f;

// A fault's text, in place.
template <class... Args>
const char* Say(std::string& text, fmt::format_string<Args...> format, Args&&... args) {
  text.clear();
  FormatTo(text, format, std::forward<Args>(args)...);
  return text.c_str();
}

bool IsWithin(float value, float low, float high) { return value >= low && value <= high; }
// Not so of NaN.
bool IsUnit(const float* n) {
  return std::abs(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] - 1.0f) <= 1.0e-3f;
}

const char* FindCameraRangeFault(const Camera& c) {
  if (const char* fault = FindCameraFault(c)) return fault;
  if (!AreUsable(c.eye, 3)) return "the camera's eye is beyond 1e6";
  if (!AreUsable(c.target, 3)) return "the camera's target is beyond 1e6";
  return AreUsable(c.up, 3) ? nullptr : "the camera's up vector is beyond 1e6";
}

const char* FindOriginFault(const FrameInput& in, const SceneShape& shape) {
  if (!IsOriginUsable(in.origin)) return "it is not finite, or beyond 1e7 m";
  const bool is_any = in.origin[0] != 0.0 || in.origin[1] != 0.0 || in.origin[2] != 0.0;
  const bool may_be = !shape.layer_kind.empty() && (shape.layer_kind[0] & kLayerApart);
  return is_any && !may_be ? "the scene was made without SceneOptions::origins" : nullptr;
}

const char* FindWindFault(const WindSetup& w) {
  const float all[] = {w.velocity[0], w.velocity[1],   w.velocity[2],       w.gust_strength,
                       w.turbulence,  w.gust_period_s, w.turbulence_scale_m};
  if (!AreUsable(all, std::size(all))) return "a value is not finite, or beyond 1e6";
  if (w.gust_period_s < 1.0e-3f) return "the gust period is below 1 ms";
  if (w.turbulence_scale_m < 1.0e-3f) return "the turbulence scale is below 1 mm";
  return nullptr;
}

const char* FindObstacleFault(const FrameInput& in) {
  if (in.use_ground) {
    if (!AreUsable(in.ground, 4)) return "the ground plane is not finite, or beyond 1e6";
    if (!IsUnit(in.ground)) return "the ground plane's normal is not unit";
    if (!AreUsable(in.ground_velocity, 3))
      return "the ground's velocity is not finite, or beyond 1e6";
  }
  if (in.sphere_count > kSpheresPerScene) return "more spheres than a scene holds";
  for (uint32_t s = 0; s < in.sphere_count; ++s) {
    if (!AreUsable(in.sphere[s], 4) || in.sphere[s][3] < 0.0f)
      return "a sphere is not finite, beyond 1e6, or has a negative radius";
    if (!AreUsable(in.sphere_velocity[s], 3))
      return "a sphere's velocity is not finite, or beyond 1e6";
  }
  return nullptr;
}

// Of what may be bound to a joint: writes the reason to `text`; null where there is none.
template <class Bound>
const char* FindBindingFault(const char* what, uint32_t number, const Bound& bound,
                             const SceneShape& shape, const PoseGate& gate, std::string& text) {
  if (bound.joint == Bound::kFree) return nullptr;
  if (bound.character >= shape.character_count)
    return Say(text, "{} {}: bound to character {}, the scene has {}", what, number,
               bound.character, shape.character_count);
  if (const uint32_t joints = gate.JointCount(bound.character); bound.joint >= joints)
    return Say(text, "{} {}: bound to joint {} of character {}, which has {}", what, number,
               bound.joint, bound.character, joints);
  return nullptr;
}

// Writes the reason to `text`; null where there is none.
const char* FindCapsuleFault(const FrameInput& in, const SceneShape& shape, const PoseGate& gate,
                             std::string& text) {
  if (in.capsule_count > kCapsulesPerScene)
    return Say(text, "{} capsules, a scene holds {}", in.capsule_count, kCapsulesPerScene);
  for (uint32_t c = 0; c < in.capsule_count; ++c) {
    const CapsuleCollider& capsule = in.capsule[c];
    if (!AreUsable(capsule.from, 3) || !AreUsable(capsule.to, 3))
      return Say(text, "capsule {}: an end {}", c, kNotUsable);
    if (!AreUsable(&capsule.radius, 1) || capsule.radius < 0.0f)
      return Say(text, "capsule {}: its radius is {}, not in [0, 1e6] m", c, capsule.radius);
    if (!AreUsable(capsule.from_velocity, 3) || !AreUsable(capsule.to_velocity, 3))
      return Say(text, "capsule {}: the velocity of an end {}", c, kNotUsable);
    if (const char* what = FindBindingFault("capsule", c, capsule, shape, gate, text)) return what;
  }
  return nullptr;
}

// Writes the reason to `text`; null where there is none.
const char* FindForceFault(const FrameInput& in, const SceneShape& shape, const PoseGate& gate,
                           std::string& text) {
  constexpr const char* kWhat = "force volume";
  if (in.force_count > kForceVolumesPerScene)
    return Say(text, "{} {}s, a scene holds {}", in.force_count, kWhat, kForceVolumesPerScene);
  for (uint32_t f = 0; f < in.force_count; ++f) {
    const ForceVolume& v = in.force[f];
    if (!AreUsable(v.centre, 3)) return Say(text, "{} {}: its centre {}", kWhat, f, kNotUsable);
    for (const float half : v.half)
      if (!IsWithin(half, kShortestFalloff_m, kLargestInput))
        return Say(text, "{} {}: half of a side is {}, not in [1e-3, 1e6] m", kWhat, f, half);
    if (v.shape >= kForceShapes)
      return Say(text, "{} {}: its shape is {}, there are {}", kWhat, f, v.shape, kForceShapes);
    if (v.kind >= kForceKinds)
      return Say(text, "{} {}: its kind is {}, there are {}", kWhat, f, v.kind, kForceKinds);
    if (!IsUnit(v.direction)) return Say(text, "{} {}: its direction is not unit", kWhat, f);
    if (!AreUsable(&v.strength, 1))
      return Say(text, "{} {}: its strength is {}, beyond 1e6 m/s^2", kWhat, f, v.strength);
    if (!IsWithin(v.hardness, 0.0f, 1.0f))
      return Say(text, "{} {}: its hardness is {}, not in [0, 1]", kWhat, f, v.hardness);
    if (const char* what = FindBindingFault(kWhat, f, v, shape, gate, text)) return what;
  }
  return nullptr;
}

// Null, or what is wrong with the light, or with the sample.
const char* FindOneFault(const SphereLight& light) {
  if (!AreUsable(light.position, 3)) return "its position is not finite, or beyond 1e6";
  if (!AreUsable(light.rgb, 3)) return "its colour is not finite, or beyond 1e6";
  if (!IsWithin(light.radius, 0.0f, kLargestInput)) return "its radius is not in [0, 1e6] m";
  return IsWithin(light.range, 0.0f, kLargestInput) ? nullptr : "its range is not in [0, 1e6] m";
}
const char* FindOneFault(const IrradianceSample& sample) {
  if (!AreUsable(sample.position, 3)) return "its position is not finite, or beyond 1e6";
  if (!AreUsable(sample.sky, 3) || !AreUsable(sample.ground, 3))
    return "a colour is not finite, or beyond 1e6";
  if (!IsWithin(sample.falloff, kShortestFalloff_m, kLargestInput))
    return "its falloff is not in [1e-3, 1e6] m";
  return IsUnit(sample.up) ? nullptr : "its up is not unit";
}

// Writes the reason to `text`; null where there is none.
const char* FindLightingFault(const Lighting& in, std::string& text) {
  if (in.light_count > kLightsPerScene)
    return Say(text, "{} lights, a scene holds {}", in.light_count, kLightsPerScene);
  if (in.sample_count > kIrradianceSamplesPerScene)
    return Say(text, "{} irradiance samples, a scene holds {}", in.sample_count,
               kIrradianceSamplesPerScene);
  for (uint32_t l = 0; l < in.light_count; ++l)
    if (const char* what = FindOneFault(in.light[l])) return Say(text, "light {}: {}", l, what);
  for (uint32_t s = 0; s < in.sample_count; ++s)
    if (const char* what = FindOneFault(in.sample[s]))
      return Say(text, "irradiance sample {}: {}", s, what);
  if (!IsUnit(in.sun_direction)) return Say(text, "the sun's direction is not unit");
  if (!AreUsable(in.sun_rgb, 3)) return Say(text, "the sun's colour {}", kNotUsable);
  if (!IsUnit(in.rim_direction)) return Say(text, "the rim light's direction is not unit");
  if (!AreUsable(in.rim_rgb, 3)) return Say(text, "the rim light's colour {}", kNotUsable);
  if (!IsWithin(in.rim_exponent, 0.0f, kLargestExponent))
    return Say(text, "the rim light's exponent is {}, not in [0, {}]", in.rim_exponent,
               kLargestExponent);
  return nullptr;
}

// Writes the reason to `text`; null where there is none.
const char* FindBrushFault(const FrameInput& in, std::string& text) {
  if (in.brush_count > kBrushesPerScene)
    return Say(text, "{} brushes, a scene holds {}", in.brush_count, kBrushesPerScene);
  for (uint32_t b = 0; b < in.brush_count; ++b) {
    const PaintBrush& brush = in.brush[b];
    if (!AreUsable(brush.centre, 3)) return Say(text, "brush {}: its centre {}", b, kNotUsable);
    if (!IsWithin(brush.radius, 0.0f, kLargestInput))
      return Say(text, "brush {}: its radius is {}, not in [0, 1e6] m", b, brush.radius);
    if (!IsWithin(brush.hardness, 0.0f, 1.0f))
      return Say(text, "brush {}: its hardness is {}, not in [0, 1]", b, brush.hardness);
    if (!IsWithin(brush.amount, -1.0f, 1.0f))
      return Say(text, "brush {}: its amount is {}, not in [-1, 1]", b, brush.amount);
    if (brush.channel >= kPaintChannels)
      return Say(text, "brush {}: its channel is {}, there are {}", b, brush.channel,
                 kPaintChannels);
  }
  return nullptr;
}

const char* FindLodFault(const LodSettings& lod) {
  if (!std::isfinite(lod.full_detail_px) || lod.full_detail_px < 0.0f)
    return "full_detail_px is not a number from 0 on";
  if (!std::isfinite(lod.fast_quality_px) || lod.fast_quality_px < 0.0f)
    return "fast_quality_px is not a number from 0 on";
  if (!(lod.worst_px >= 0.0f && lod.worst_px <= kLargestInput))
    return "worst_px is not a number from 0 on";
  const FurCosts& costs = lod.costs;
  const auto is_cost = [](float ns) { return ns >= 0.0f && ns <= kLargestInput; };
  if (!is_cost(costs.chunk_ns) || !is_cost(costs.vertex_ns) || !is_cost(costs.strand_ns) ||
      !std::ranges::all_of(costs.node_ns, is_cost))
    return "a cost is not a number from 0 on";
  if (lod.budget_us > 0 && !(costs.strand_ns > 0.0f))
    return "budget_us is given without costs: strand_ns is 0";
  const float shares[] = {lod.min_fraction, lod.hysteresis, lod.fade_share, lod.least_chains};
  for (float share : shares)
    if (!(share >= 0.0f && share <= 1.0f)) return "a share is not in [0, 1]";
  return nullptr;
}

// Writes the reason to `text`; null where there is none.
const char* FindLayerFault(const FrameInput& in, const SceneShape& shape, std::string& text) {
  if (!in.importance.empty() && in.importance.size() != shape.layer_count)
    return Say(text, "importance of {} layers, the scene has {}", in.importance.size(),
               shape.layer_count);
  for (size_t l = 0; l < in.importance.size(); ++l)
    if (const float x = in.importance[l];
        x != 0.0f && !IsWithin(x, kLeastImportance, kMostImportance))
      return Say(text, "importance of layer {} is {}, neither 0 nor in [{}, {}]", l, x,
                 kLeastImportance, kMostImportance);
  return nullptr;
}

}  // namespace

bool AreUsable(const float* values, size_t count) {
  return std::all_of(values, values + count,
                     [](float value) { return value >= -kLargestInput && value <= kLargestInput; });
}

const char* FindInputFault(const FrameInput& in, const SceneShape& shape, const PoseGate& gate,
                           std::string& text) {
  const auto fault = [&]<class... Args>(fmt::format_string<Args...> format, Args&&... args) {
    return Say(text, format, std::forward<Args>(args)...);
  };
  if (!(in.dt_s == 0.0 || (in.dt_s >= kShortest_s && in.dt_s <= 1.0)))
    return fault("dt_s is {}, neither 0 nor in [{}, 1] s", in.dt_s, kShortest_s);
  if (!(in.time_s >= 0.0 && in.time_s <= kLatest_s))
    return fault("time_s is {}, not in [0, {}] s", in.time_s, kLatest_s);
  if (const char* what = FindOriginFault(in, shape)) return fault("origin: {}", what);
  if (const char* camera = FindCameraRangeFault(in.camera)) return fault("camera: {}", camera);
  if (!AreUsable(in.gravity, 3)) return fault("gravity {}", kNotUsable);
  if (const char* what = FindWindFault(in.wind)) return fault("wind: {}", what);
  if (in.wind.kind >= kWindKinds)
    return fault("wind: its kind is {}, there are {}", in.wind.kind, kWindKinds);
  if (const char* what = FindObstacleFault(in)) return fault("{}", what);
  if (const char* what = FindCapsuleFault(in, shape, gate, text)) return what;
  if (const char* what = FindLightingFault(in.lighting, text)) return what;
  if (const char* what = FindBrushFault(in, text)) return what;
  if (const char* what = FindForceFault(in, shape, gate, text)) return what;
  if (const char* what = FindLodFault(in.lod)) return fault("lod: {}", what);
  if (const char* what = FindLayerFault(in, shape, text)) return what;
  if (!in.weather.empty() && in.weather.size() != shape.character_count)
    return fault("weather for {} characters, the scene has {}", in.weather.size(),
                 shape.character_count);
  for (size_t c = 0; c < in.weather.size(); ++c)
    if (!std::isfinite(in.weather[c].wetness) || !std::isfinite(in.weather[c].dirt))
      return fault("weather of character {} is not finite", c);
  return nullptr;
}

}  // namespace pelt
