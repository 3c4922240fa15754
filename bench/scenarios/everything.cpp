// The scene `everything`.
#include <algorithm>
#include <limits>

#include "bench/scenarios/made_scenes.hpp"
#include "core/character/builtin_character.hpp"
#include "core/character/pose.hpp"
#include "core/groom/bake.hpp"

namespace pelt {
namespace {

constexpr float kBallSpeed = 8.0f;    // m/s: over the length of a strand in a frame
constexpr uint32_t kBallFrames = 12;  // from one side of it to the other

// Between frames that are `from` and `to` of every 30.
bool Holds(uint32_t frame, uint32_t from, uint32_t to) {
  return frame % 30 >= from && frame % 30 < to;
}

// Flies through the character, one way and back, and says how fast.
void Strike(uint32_t frame, const glm::vec3& at, double dt_s, FrameInput& in) {
  if (in.sphere_count == kSpheresPerScene) return;
  const uint32_t turn = frame % (2 * kBallFrames);
  const bool back = turn >= kBallFrames;
  const float way = float(turn % kBallFrames) - 0.5f * float(kBallFrames);
  const float speed = back ? -kBallSpeed : kBallSpeed;
  float* ball = in.sphere[in.sphere_count];
  const float place[] = {at.x + 0.05f, at.y + (back ? 0.95f : 0.6f),
                         at.z + speed * way * float(dt_s)};
  std::copy_n(place, 3, ball);
  ball[3] = 0.1f;
  in.sphere_velocity[in.sphere_count++][2] = speed;
}

// What happens to one character, called from its scene's course.
void ActOn(uint32_t character, const glm::vec3& at, uint32_t frame, FurScene& scene,
           FrameInput& in) {
  Strike(frame, at, in.dt_s, in);
  if (PoseRateBlock* rates = scene.PoseRates(character); rates && !Holds(frame, 4, 13))
    rates->given = 0;
  if (Holds(frame, 5, 17) && in.lighting.light_count > 0) --in.lighting.light_count;
  if (!Holds(frame, 1, 10)) in.brush_count -= std::min(in.brush_count, 1u);
}

// An origin by as much as floats have not exactly, and the pose back.
void MoveOrigin(uint32_t frame, FurScene& scene) {
  double* origin = scene.Origin(0);
  if (!origin) return;
  const double by = 0.1 * double(frame % 7);
  origin[0] += by;
  scene.Pose(0).root[3] -= float(by);
}

// What happens to its own scene besides.
void ActOnScene(uint32_t frame, FurScene& scene, FrameInput& in) {
  MoveOrigin(frame, scene);
  if (Holds(frame, 11, 13)) scene.Pose(0).root[0] = std::numeric_limits<float>::quiet_NaN();
  if (Holds(frame, 14, 16)) in.dt_s = 0.0;
  if (Holds(frame, 23, 24)) in.dt_s = 1.0 / 30.0;
  if (Holds(frame, 16, 20)) in.wind = {};
  if (Holds(frame, 8, 12)) in.ground_velocity[0] = 0.7f;
  Camera& camera = in.camera;
  if (Holds(frame, 20, 22))
    for (int c = 0; c < 3; ++c) camera.target[c] = 2.0f * camera.eye[c] - camera.target[c];
}

void AddLights(const glm::vec3& at, Lighting& lighting) {
  const auto add = [&](glm::vec3 place, const SphereLight& light) {
    if (lighting.light_count == kLightsPerScene) return;
    SphereLight& to = lighting.light[lighting.light_count++] = light;
    for (int c = 0; c < 3; ++c) to.position[c] = at[c] + place[c];
  };
  add({1.0f, 1.5f, 0.5f}, {{}, 0.2f, {2.0f, 1.5f, 1.0f}, 6.0f});
  add({-1.0f, 0.5f, 1.0f}, {{}, 0.0f, {0.2f, 0.3f, 0.8f}, 0.0f});
  if (lighting.sample_count == kIrradianceSamplesPerScene) return;
  lighting.sample[lighting.sample_count++] = {
      {at.x, at.y + 1.0f, at.z}, 4.0f, {0.4f, 0.5f, 0.7f}, {0.2f, 0.15f, 0.1f}, {0, 1, 0}};
}

// A sponge on the head, mud that reaches further, and what wipes some of it off.
void AddBrushes(const glm::vec3& at, FrameInput& base) {
  const auto add = [&](PaintChannel channel, float height, float radius, float amount) {
    if (base.brush_count < kBrushesPerScene)
      base.brush[base.brush_count++] = {
          {at.x + 0.1f, at.y + height, at.z + 0.1f}, radius, 0.5f, uint32_t(channel), amount};
  };
  add(PaintChannel::kWet, 1.0f, 0.3f, 0.05f);
  add(PaintChannel::kMud, 0.5f, 0.5f, 0.1f);
  add(PaintChannel::kMud, 0.6f, 0.2f, -0.04f);
}

// An arm of its own, which rubs the trunk.
CapsuleCollider ArmOf(uint32_t character, const Character& of) {
  CapsuleCollider arm;
  const auto& names = of.skeleton.name;
  arm.character = character;
  arm.joint = uint32_t(std::ranges::find(names, "elbow_l") - names.begin());
  arm.to[1] = -0.25f;
  arm.radius = 0.06f;
  return arm;
}

const Character& ItsCharacter() {
  static const Character kCharacter = MakeBuiltinCharacter({.tiny = true});
  return kCharacter;
}

Groom Bake(const FurSetup& setup) {
  return BakeGroom(ItsCharacter(), ComputeRestGeometry(ItsCharacter(), 1.0f), setup, 1.0f);
}

void Add(Scenario& scenario, const Groom& groom, const glm::vec3& at) {
  const Character& character = ItsCharacter();
  const auto number = uint32_t(scenario.actors.size());
  Actor actor{};
  actor.character = uint32_t(scenario.characters.size());
  actor.groom = uint32_t(scenario.grooms.size());
  actor.clip = int32_t(FindClip(character, "shake") - character.clips.data());
  actor.placement[3] = glm::vec4(at, 1.0f);
  actor.teleport_frame = 18;
  actor.teleport_by = {0.1f, 0.0f, -0.1f};
  scenario.characters.push_back(character);
  scenario.grooms.push_back(groom);
  scenario.actors.push_back(actor);
  if (scenario.capsules.size() < kCapsulesPerScene)
    scenario.capsules.push_back(ArmOf(number, character));
  AddLights(at, scenario.base.lighting);
  AddBrushes(at, scenario.base);
  scenario.more = [=, before = scenario.more](uint32_t frame, FurScene& scene, FrameInput& in) {
    if (before) before(frame, scene, in);
    ActOn(number, at, frame, scene, in);
  };
}

}  // namespace

Scenario MakeEverything(const ScenarioRequest& request, const LoadProgress&) {
  Scenario scenario;
  scenario.setups.push_back(LoadSetup("everything", request.seed, request.SetupText(0)));
  Add(scenario, Bake(scenario.setups[0]), glm::vec3(0.0f));
  scenario.default_frames = 90;
  scenario.base.use_ground = true;
  scenario.base.wind.velocity[0] = 1.6f;
  scenario.base.wind.gust_strength = 0.6f;
  scenario.base.wind.turbulence = 1.0f;
  scenario.weather_course = {0.7f, 0.4f, 3};
  scenario.velocities = scenario.origins = true;
  scenario.more = [its = scenario.more](uint32_t frame, FurScene& scene, FrameInput& in) {
    its(frame, scene, in);
    ActOnScene(frame, scene, in);
  };
  scenario.keeps_poses = true;
  return scenario;
}

void AddEverything(Scenario& scenario, const glm::vec3& at) {
  static const Groom kGroom = Bake(LoadSetup("everything"));
  Add(scenario, kGroom, at);
}

}  // namespace pelt
