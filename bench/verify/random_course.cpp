#include "bench/verify/random_course.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pelt {
namespace {

// Of frames.
struct Span {
  uint32_t from = 0, to = 0;
  bool Holds(uint32_t frame) const { return frame >= from && frame < to; }
};
Span DrawSpan(Random& random) {
  const uint32_t from = random.Below(kDrawnFrames + 20);
  return {from < 20 ? 0 : from - 20, from + 1 + random.Below(40)};
}

void Draw(Random& random, double low, double high, float& value) {
  value = float(random.Uniform(low, high));
}
template <size_t kCount>
void Draw(Random& random, double low, double high, float (&values)[kCount]) {
  for (float& value : values) Draw(random, low, high, value);
}
void DrawUnit(Random& random, float* n) {
  float length = 0.0f;
  while (length < 0.1f) {
    for (int c = 0; c < 3; ++c) Draw(random, -1.0, 1.0, n[c]);
    length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  }
  for (int c = 0; c < 3; ++c) n[c] /= length;
}
// In and about the characters.
void DrawPlace(Random& random, float* place) {
  constexpr float kLow[] = {-0.6f, -0.1f, -0.6f}, kHigh[] = {0.6f, 1.3f, 0.6f};
  for (int c = 0; c < 3; ++c) Draw(random, kLow[c], kHigh[c], place[c]);
}

void DrawLighting(Random& random, Lighting& lighting) {
  lighting.light_count = random.Below(kLightsPerScene + 1);
  lighting.sample_count = random.Below(kIrradianceSamplesPerScene + 1);
  for (uint32_t l = 0; l < lighting.light_count; ++l) {
    SphereLight& light = lighting.light[l];
    Draw(random, -2.0, 2.0, light.position);
    Draw(random, 0.0, 0.5, light.radius);
    Draw(random, 0.0, 3.0, light.rgb);
    if (random.Below(2)) Draw(random, 0.1, 5.0, light.range);
  }
  for (uint32_t s = 0; s < lighting.sample_count; ++s) {
    IrradianceSample& sample = lighting.sample[s];
    Draw(random, -2.0, 2.0, sample.position);
    Draw(random, 0.01, 5.0, sample.falloff);
    Draw(random, 0.0, 1.0, sample.sky);
    Draw(random, 0.0, 1.0, sample.ground);
    DrawUnit(random, sample.up);
  }
  DrawUnit(random, lighting.sun_direction);
  DrawUnit(random, lighting.rim_direction);
  Draw(random, 0.0, 2.0, lighting.sun_rgb);
  Draw(random, -1.0, 1.0, lighting.rim_rgb);
  Draw(random, 0.0, 8.0, lighting.rim_exponent);
}

void DrawBrushes(Random& random, FrameInput& base) {
  base.brush_count = random.Below(5);
  for (uint32_t b = 0; b < base.brush_count; ++b) {
    PaintBrush& brush = base.brush[b];
    DrawPlace(random, brush.centre);
    Draw(random, 0.0, 0.8, brush.radius);
    Draw(random, 0.0, 1.0, brush.hardness);
    Draw(random, -0.3, 0.5, brush.amount);
    brush.channel = random.Below(kPaintChannels);
  }
}

void DrawColliders(Random& random, Scenario& scenario) {
  FrameInput& base = scenario.base;
  for (uint32_t s = random.Below(5); s > 0; --s) {
    MovingSphere sphere;
    DrawPlace(random, &sphere.centre[0]);
    for (int c = 0; c < 3; ++c) Draw(random, -0.4, 0.4, sphere.swing[c]);
    sphere.period_s = random.Uniform(0.1, 4.0);
    Draw(random, 0.01, 0.4, sphere.radius);
    // The velocity in the input, which is not that of its swing.
    if (random.Below(2)) Draw(random, -8.0, 8.0, base.sphere_velocity[scenario.spheres.size()]);
    scenario.spheres.push_back(sphere);
  }
  for (uint32_t n = random.Below(4); n > 0; --n) {
    CapsuleCollider capsule;
    Draw(random, 0.01, 0.2, capsule.radius);
    if (random.Below(2)) {
      DrawPlace(random, capsule.from);
      DrawPlace(random, capsule.to);
      if (random.Below(2)) Draw(random, -8.0, 8.0, capsule.from_velocity);
      if (random.Below(2)) Draw(random, -8.0, 8.0, capsule.to_velocity);
    } else {
      Draw(random, -0.2, 0.2, capsule.from);
      Draw(random, -0.2, 0.2, capsule.to);
      capsule.character = random.Below(uint32_t(scenario.actors.size()));
      const Actor& actor = scenario.actors[capsule.character];
      capsule.joint = random.Below(scenario.grooms[actor.groom].joint_count);
    }
    scenario.capsules.push_back(capsule);
  }
  if (random.Below(2)) {
    // Mostly below, as grounds are.
    if (random.Below(2)) DrawUnit(random, base.ground);
    Draw(random, -0.4, 0.4, base.ground[3]);
    if (random.Below(3) == 0) Draw(random, -2.0, 2.0, base.ground_velocity);
  }
}

void DrawAir(Random& random, Scenario& scenario) {
  FrameInput& base = scenario.base;
  constexpr double kSpeeds[] = {1.0, 5.0, 30.0};  // m/s
  const double speed = kSpeeds[random.Below(3)];
  Draw(random, -speed, speed, base.wind.velocity);
  Draw(random, 0.0, 1.0, base.wind.gust_strength);
  Draw(random, 0.01, 5.0, base.wind.gust_period_s);
  Draw(random, 0.0, speed, base.wind.turbulence);
  Draw(random, 0.01, 2.0, base.wind.turbulence_scale_m);
  if (random.Below(3) == 0) Draw(random, -20.0, 20.0, base.gravity);
  Draw(random, 0.0, 1.0, scenario.weather_course.wetness);
  Draw(random, 0.0, 1.0, scenario.weather_course.dirt);
  scenario.weather_course.from_frame = random.Below(kDrawnFrames);
}

void DrawCamera(Random& random, Scenario& scenario) {
  CameraOrbit& orbit = scenario.camera;
  DrawPlace(random, &orbit.target[0]);
  orbit.radius_m = random.Uniform(0.2, 6.0);
  orbit.height_m = random.Uniform(-1.0, 2.0);
  orbit.start_rad = random.Uniform(0.0, 6.0);
  orbit.rate_rad_per_s = random.Below(3) ? random.Uniform(-3.0, 3.0) : 0.0;
  orbit.vertical_fov_rad = random.Uniform(0.1, 2.0);
  Camera& camera = scenario.base.camera;
  Draw(random, 64.0, 4096.0, camera.viewport_width_px);
  Draw(random, 64.0, 4096.0, camera.viewport_height_px);
  Draw(random, 0.5, 20.0, camera.far_m);
  DrawUnit(random, camera.up);
}

// What holds for some frames alone.
struct Spans {
  Span ground, wind, speeds, rates, lights, last_light, brushes, spheres, aside, bad_pose;
  uint64_t steps;  // what their lengths are drawn from
  double dt_s;
};

// A step like the others, one of another length, or a pause.
double StepOf(const Spans& spans, uint32_t frame) {
  constexpr double kOthers[] = {1.0 / 24.0, 1.0 / 240.0, 0.2, 1.0e-5};
  Random random(MixSeed(spans.steps, frame));
  const uint32_t how = random.Below(40);
  if (how == 0) return 0.0;
  return how < 5 ? kOthers[how - 1] : spans.dt_s;
}

void RunCourse(const Spans& spans, uint32_t frame, FurScene& scene, FrameInput& in) {
  in.dt_s = StepOf(spans, frame);
  in.use_ground = spans.ground.Holds(frame);
  if (!spans.wind.Holds(frame)) in.wind = {};
  if (!spans.spheres.Holds(frame)) in.sphere_count = std::min(in.sphere_count, 1u);
  if (!spans.lights.Holds(frame)) in.lighting.light_count = in.lighting.sample_count = 0;
  if (spans.last_light.Holds(frame) && in.lighting.light_count > 0) --in.lighting.light_count;
  if (!spans.brushes.Holds(frame)) in.brush_count = 0;
  Camera& camera = in.camera;
  if (spans.aside.Holds(frame))
    for (int c = 0; c < 3; ++c) camera.target[c] = 2.0f * camera.eye[c] - camera.target[c];
  if (!spans.speeds.Holds(frame)) {
    std::fill_n(in.ground_velocity, 3, 0.0f);
    std::fill_n(in.sphere_velocity[0], 3 * kSpheresPerScene, 0.0f);
    for (CapsuleCollider& capsule : in.capsule) {
      std::fill_n(capsule.from_velocity, 3, 0.0f);
      std::fill_n(capsule.to_velocity, 3, 0.0f);
    }
  }
  for (uint32_t c = 0; c < scene.shape().character_count; ++c)
    if (PoseRateBlock* rates = scene.PoseRates(c); rates && !spans.rates.Holds(frame))
      rates->given = 0;
  // That of the last character alone, and not in its first frame, in which there is none to keep.
  if (frame > 0 && spans.bad_pose.Holds(frame))
    scene.Pose(scene.shape().character_count - 1).root[0] = std::numeric_limits<float>::quiet_NaN();
}

}  // namespace

void DrawCourse(Random& random, Scenario& scenario) {
  DrawColliders(random, scenario);
  DrawAir(random, scenario);
  DrawCamera(random, scenario);
  DrawLighting(random, scenario.base.lighting);
  DrawBrushes(random, scenario.base);
  scenario.clip_rate = random.Uniform(0.25, 4.0);
  scenario.default_frames = kDrawnFrames;
  Spans spans;
  for (Span* span : {&spans.ground, &spans.wind, &spans.speeds, &spans.rates, &spans.lights,
                     &spans.last_light, &spans.brushes, &spans.spheres})
    *span = DrawSpan(random);
  if (random.Below(4) == 0) spans.aside = DrawSpan(random);
  if (random.Below(4) == 0) spans.bad_pose = DrawSpan(random);
  spans.steps = random.U64();
  constexpr double kSteps[] = {1.0 / 60.0, 1.0 / 60.0, 1.0 / 30.0, 1.0 / 144.0};
  spans.dt_s = kSteps[random.Below(4)];
  scenario.dt_s = spans.dt_s;
  scenario.keeps_poses = true;
  scenario.more = [spans](uint32_t frame, FurScene& scene, FrameInput& in) {
    RunCourse(spans, frame, scene, in);
  };
}

}  // namespace pelt
