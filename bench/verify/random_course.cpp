#include "bench/verify/random_course.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/character/builtin_character.hpp"
#include "core/character/pose.hpp"
#include "core/error.hpp"
#include "core/groom/bake.hpp"
#include "core/random.hpp"

namespace pelt {
namespace {

// ---- The course ------------------------------------------------------------------------------

// What the scene is given from frame to frame: every member of FrameInput but time, and the poses' velocities, origins
// and teleports. Most of it holds for some frames, begins and ends.

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

void DrawForces(Random& random, Scenario& scenario) {
  FrameInput& base = scenario.base;
  if (random.Below(2)) base.force_count = random.Below(4);
  for (uint32_t f = 0; f < base.force_count; ++f) {
    ForceVolume& force = base.force[f];
    DrawPlace(random, force.centre);
    Draw(random, 0.05, 1.0, force.half);
    force.shape = random.Below(kForceShapes), force.kind = random.Below(kForceKinds);
    DrawUnit(random, force.direction);
    Draw(random, -20.0, 20.0, force.strength);
    Draw(random, 0.0, 1.0, force.hardness);
    if (random.Below(2)) continue;
    force.character = random.Below(uint32_t(scenario.actors.size()));
    const uint32_t groom = scenario.actors[force.character].groom;
    force.joint = random.Below(scenario.grooms[groom].joint_count);
  }
  base.wind.kind = random.Below(3) == 0 ? uint32_t(WindKind::kPublished) : 0;
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
  Span ground, wind, speeds, rates, lights, last_light, brushes, spheres, aside, bad_pose,
      importance, cut, writes, forces;
  std::vector<float> importances;
  std::vector<uint8_t> cuts;
  std::vector<StrandWrite> strands;
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
  if (spans.importance.Holds(frame)) in.importance = spans.importances;
  if (spans.cut.Holds(frame)) in.cut = spans.cuts;
  if (spans.writes.Holds(frame)) in.strands = spans.strands;
  if (!spans.forces.Holds(frame)) in.force_count = 0;
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

// Layers that are off or matter more or less, strands that are cut off, and one written in each layer.
void DrawLists(Random& random, Scenario& scenario, Spans& spans) {
  constexpr float kImportances[] = {0.0f, 0.1f, 1.0f, 1.0f, 4.0f};
  for (const Actor& actor : scenario.actors) {
    const Groom& groom = scenario.grooms[actor.groom];
    for (const GroomLayer& layer : groom.layers) {
      const auto number = uint32_t(spans.importances.size());
      spans.importances.push_back(kImportances[random.Below(5)]);
      if (layer.params.output == Output::kShells) continue;
      const uint32_t strands = groom.strands[layer.first_chunk].strand_count;
      spans.strands.push_back({number, random.Below(strands), random.U32(), random.U32(),
                               float(random.Uniform(0.0, kWidestWrite)), random.Below(256)});
    }
    for (size_t place = 0; place < kStrandsPerChunk * groom.strands.size(); ++place)
      spans.cuts.push_back(random.Below(3) == 0);
  }
  scenario.strand_writes = uint32_t(spans.strands.size());
  for (Span* span : {&spans.importance, &spans.cut, &spans.writes})
    if (random.Below(3) == 0) *span = DrawSpan(random);
}

// For the characters that the scenario has.
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
  DrawLists(random, scenario, spans);
  spans.steps = random.U64();
  constexpr double kSteps[] = {1.0 / 60.0, 1.0 / 60.0, 1.0 / 30.0, 1.0 / 144.0};
  spans.dt_s = kSteps[random.Below(4)];
  scenario.dt_s = spans.dt_s;
  DrawForces(random, scenario);  // behind what was drawn before there were any
  spans.forces = DrawSpan(random);
  scenario.keeps_poses = true;
  scenario.more = [spans](uint32_t frame, FurScene& scene, FrameInput& in) {
    RunCourse(spans, frame, scene, in);
  };
}

// ---- The scene -------------------------------------------------------------------------------

// Now and then at a bound or anywhere between; else what it usually is, or about that.
double DrawNumber(Random& random, double low, double high, double usual) {
  const uint32_t how = random.Below(32);
  if (how == 0) return low;
  if (how == 1) return high;
  if (how < 4) return random.Uniform(low, high);
  if (how < 18) return usual;
  // What is 0 when unsaid is drawn on all scales below its bound.
  double value = usual != 0.0 ? usual * 4.0 : high;
  value *= random.Uniform(0.5, 1.0) / double(1u << random.Below(usual != 0.0 ? 5 : 12));
  if (low < 0.0 && random.Below(2)) value = -value;
  return std::clamp(value, low, high);
}

template <class T>
void DrawParam(Random& random, const LayerParamEntry<T>& entry, T& value) {
  if constexpr (std::is_same_v<T, float>) {
    value = float(DrawNumber(random, entry.low, entry.high, double(value)));
  } else if constexpr (std::is_same_v<T, bool> || std::is_enum_v<T>) {
    value = T(random.Below(uint32_t(entry.high) + 1));
  } else if constexpr (std::is_same_v<T, uint32_t>) {
    value = uint32_t(DrawNumber(random, entry.low, entry.high, double(value)));
  } else {
    for (auto& element : value)
      element = float(DrawNumber(random, entry.low, entry.high, double(element)));
  }
}

void SetUsual(LayerParams& params, std::string_view key) {
  ForEachLayerParam([&](const auto& entry) {
    if (entry.key == key) params.*entry.member = LayerParams{}.*entry.member;
  });
}

// What does not go together is unsaid again, key by key.
LayerParams DrawParams(Random& random) {
  constexpr uint32_t kPoints[] = {4, 5, 9};
  LayerParams params;
  ForEachLayerParam([&](const auto& entry) { DrawParam(random, entry, params.*entry.member); });
  params.points = kPoints[random.Below(3)];
  params.max_distance =
      std::max(params.max_distance, params.max_distance > 0.0f ? kLeastMaxDistance : 0.0f);
  while (const auto bad = FindBadCombination(params)) SetUsual(params, bad->key);
  return params;
}

Attribute DrawAttribute(Random& random, const StrandAttribute& entry, const Attribute& usual) {
  Attribute drawn(float(DrawNumber(random, entry.low, entry.high, double(usual.value))));
  if (random.Below(2)) drawn.randomise = float(random.Uniform());
  if (random.Below(4) == 0) {
    const float ends[] = {float(DrawNumber(random, entry.low, entry.high, double(usual.value))),
                          float(DrawNumber(random, entry.low, entry.high, double(usual.value)))};
    drawn.range = glm::vec2(std::min(ends[0], ends[1]), std::max(ends[0], ends[1]));
  }
  return drawn;
}

glm::vec3 DrawVector(Random& random, float low, float high) {
  glm::vec3 v;
  for (int c = 0; c < 3; ++c) v[c] = float(random.Uniform(low, high));
  return v;
}

template <class T>
const T& DrawOne(Random& random, const std::vector<T>& from) {
  return from[random.Below(uint32_t(from.size()))];
}

// What the layer's solver or output does not keep is unsaid again, key by key.
void DropBadTraits(LayerSetup& layer) {
  while (const auto bad = FindBadTrait(layer)) {
    if (bad->key == "hardness_profile") layer.hardness_profile.clear();
    for (const StrandAttribute& entry : kStrandAttributes)
      if (entry.key == bad->key) layer.*entry.member = LayerSetup{}.*entry.member;
  }
}

LayerSetup DrawLayer(Random& random, const Character& character, std::string name) {
  LayerSetup layer;
  layer.name = std::move(name);
  layer.seed = random.U64();
  layer.params = DrawParams(random);
  for (const StrandAttribute& entry : kStrandAttributes)
    layer.*entry.member = DrawAttribute(random, entry, layer.*entry.member);
  if (random.Below(2))
    for (uint32_t i = 0; i + 1 < layer.params.points; ++i)
      layer.hardness_profile.push_back(float(random.Uniform(0.0, 2.0)));
  DropBadTraits(layer);
  layer.max_strands = 1 + random.Below(200);
  layer.density = 1.0e4f * float(1u << random.Below(6));
  layer.clump_controls = 16u << random.Below(3);
  layer.film_strip_count = 1 + random.Below(4);
  layer.base_colour = random.U32();
  layer.tip_colour = random.U32();
  for (uint32_t i = random.Below(3); i > 0; --i)
    layer.comb.push_back({DrawVector(random, -0.5f, 1.0f), DrawVector(random, -1.0f, 1.0f),
                          float(random.Uniform(0.05, 0.5))});
  layer.comb_normal_weight = float(random.Uniform());
  if (random.Below(4) == 0) layer.comb_joint = DrawOne(random, character.skeleton.name);
  if (random.Below(2)) layer.mask.materials = {DrawOne(random, character.mesh.materials)};
  return layer;
}

// Both of them take a while to make, so they are made once.
const Character& SmallCharacter(BuiltinBody body) {
  static const Character kMonster = MakeBuiltinCharacter({.tiny = true});
  static const Character kScorpion =
      MakeBuiltinCharacter({.body = BuiltinBody::kScorpion, .tiny = true});
  return body == BuiltinBody::kMonster ? kMonster : kScorpion;
}

// Throws Error where a layer comes out without a strand.
void AddActor(Random& random, Scenario& scenario) {
  const Character& character = SmallCharacter(BuiltinBody(random.Below(4) == 0));
  FurSetup setup;
  setup.path = "drawn";
  const uint32_t layers = 1 + random.Below(4);
  for (uint32_t l = 0; l < layers; ++l)
    setup.layers.push_back(
        DrawLayer(random, character, fmt::format("{}.{}", scenario.actors.size(), l)));
  setup.layers[0].params.enabled = true;
  constexpr float kSizes[] = {1.0f, 1.0f, 1.0f, 0.25f, 3.0f};
  Actor actor{};
  actor.character = uint32_t(scenario.characters.size());
  actor.groom = uint32_t(scenario.grooms.size());
  actor.clip = int32_t(random.Below(uint32_t(character.clips.size()) + 1)) - 1;
  actor.phase_s = random.Uniform();
  actor.weather_share = float(random.Uniform());
  const float size = kSizes[random.Below(5)];
  for (int c = 0; c < 3; ++c) actor.placement[c][c] = size;
  actor.placement[3] = glm::vec4(DrawVector(random, -0.3f, 0.3f), 1.0f);
  if (random.Below(3) == 0) {
    actor.teleport_frame = int32_t(random.Below(50));
    actor.teleport_by = DrawVector(random, -1.0f, 1.0f);
  }
  scenario.grooms.push_back(
      BakeGroom(character, ComputeRestGeometry(character, 1.0f), setup, 1.0f));
  scenario.characters.push_back(character);
  scenario.actors.push_back(actor);
}

RandomScene DrawFrom(Random random) {
  RandomScene drawn;
  Scenario& scenario = drawn.scenario;
  scenario.name = "drawn";
  for (uint32_t c = 1 + random.Below(2); c > 0; --c) AddActor(random, scenario);
  scenario.velocities = random.Below(2);
  scenario.origins = random.Below(3) == 0;
  if (scenario.origins && random.Below(2)) scenario.place = glm::dvec3(1.0e4, 0.0, -5.0e3);
  drawn.skip.cull = random.Below(4) == 0;
  drawn.skip.lod = random.Below(3) == 0;
  drawn.lod.strand_budget = random.Below(2) ? uint32_t(scenario.StrandCount() / 2) : 0;
  drawn.lod.fast_quality_px = float(random.Below(3));
  drawn.lod.budget_us = 50 * random.Below(4);
  drawn.lod.costs = {400.0f, 5.0f, 100.0f, {20.0f, 10.0f, 40.0f, 80.0f, 160.0f}};
  drawn.lod.least_chains = 0.5f * float(random.Below(3));
  DrawCourse(random, scenario);
  size_t layers = 0;
  for (const Groom& groom : scenario.grooms) layers += groom.layers.size();
  drawn.text =
      fmt::format("{} layers, {} strands{}{}", layers, scenario.StrandCount(),
                  scenario.velocities ? ", velocities" : "", scenario.origins ? ", origins" : "");
  return drawn;
}

template <class T>
std::string ShowValue(const LayerParamEntry<T>& entry, const T& value) {
  if constexpr (std::is_enum_v<T>)
    return fmt::format("\"{}\"", entry.words[size_t(value)]);
  else if constexpr (std::is_class_v<T>)
    return fmt::format("[{}, {}, {}]", value[0], value[1], value[2]);
  else
    return fmt::format("{}", value);
}

}  // namespace

RandomScene DrawScene(uint64_t seed) {
  for (uint64_t attempt = 0;; ++attempt) try {
      return DrawFrom(Random(MixSeed(seed, attempt)));
    } catch (const Error&) {  // a layer without a strand: the next
      if (attempt == 1000) throw;
    }
}

std::string DescribeDrawn(const LayerParams& params) {
  std::string text;
  const LayerParams usual;
  ForEachLayerParam([&](const auto& entry) {
    if (params.*entry.member == usual.*entry.member) return;
    text += fmt::format("{}{} = {}", text.empty() ? "" : ", ", entry.key,
                        ShowValue(entry, params.*entry.member));
  });
  return text;
}

}  // namespace pelt
