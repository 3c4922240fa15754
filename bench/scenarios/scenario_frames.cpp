// A scenario's frames: poses, input, and the scene that runs them.
#include <fmt/format.h>

#include <algorithm>

#include "bench/scenarios/scenarios.hpp"
#include "core/character/pose.hpp"
#include "core/error.hpp"
#include "core/exact_math.hpp"

namespace pelt {
namespace {

// Whether the clip began anew since `before_s`.
bool Loops(const Clip& clip, double now_s, double before_s) {
  const double duration_s = double(clip.duration_s);
  return exact::Floor(now_s / duration_s) != exact::Floor(before_s / duration_s);
}

double Wave(double time_s, double period_s) {
  return exact::Sin(2.0 * exact::kPi * time_s / period_s);
}

}  // namespace

std::vector<const Groom*> Scenario::ActorGrooms() const {
  std::vector<const Groom*> all;
  for (const Actor& actor : actors) all.push_back(&grooms[actor.groom]);
  return all;
}

uint64_t Scenario::StrandCount() const {
  uint64_t strands = 0;
  for (const Actor& actor : actors)
    for (const GroomLayer& layer : grooms[actor.groom].layers) strands += layer.strand_count;
  return strands;
}

// In steps that floats have exactly, and not those of the character.
glm::dvec3 Scenario::OriginOf(uint32_t actor, uint32_t frame) const {
  const double walked = 0.03125 * double(std::min(frame, rest_from_frame) % 64u);
  return place + glm::dvec3(0.25 * double(actor) + walked, 0.125, -2.0 * walked);
}

// What is not a pose, where the scenario is.
void Scenario::Place() {
  if (origins) return (void)std::copy_n(&place[0], 3, input_.origin);
  const Offset offset{{-place[0], -place[1], -place[2]}};
  MovePlaces(offset, input_);
  for (int c = 0; c < 3; ++c) {
    input_.camera.target[c] = offset.Place(input_.camera.target[c], c);
    input_.camera.eye[c] = offset.Place(input_.camera.eye[c], c);
  }
}

double Scenario::ClipTime(const Actor& actor, uint32_t frame) const {
  return std::min(frame, rest_from_frame) * dt_s * clip_rate + actor.phase_s;
}

const FrameInput& Scenario::PrepareFrame(uint32_t frame, FurScene& scene) {
  const double time_s = std::min(frame, rest_from_frame) * dt_s;
  for (uint32_t a = 0; a < actors.size(); ++a) {
    const Actor& actor = actors[a];
    const Character& character = characters[actor.character];
    const double clip_s = ClipTime(actor, frame);
    const Clip* clip = actor.clip < 0 ? nullptr : &character.clips[size_t(actor.clip)];
    glm::mat4 placement = actor.placement;
    if (actor.teleport_frame >= 0 && int32_t(frame) >= actor.teleport_frame)
      placement[3] += glm::vec4(actor.teleport_by, 0.0f);
    glm::dvec3 from(0.0);
    if (double* origin = origins ? scene.Origin(a) : nullptr) {
      from = OriginOf(a, frame);
      std::copy_n(&from[0], 3, origin);
    }
    for (int c = 0; c < 3; ++c)
      if (place[c] != from[c])
        placement[3][c] = float(double(placement[3][c]) + (place[c] - from[c]));
    PoseBlock& pose = scene.Pose(a);
    FillPose(character.skeleton, clip, clip_s, !once, PlaceCharacter(placement, actor.unit_scale),
             &pose);
    pose.teleported = int32_t(frame) == actor.teleport_frame ||
                      (clip && actor.jumps && !once && frame > 0 &&
                       Loops(*clip, clip_s, ClipTime(actor, frame - 1)));
    if (PoseRateBlock* rates = scene.PoseRates(a))
      FillPoseRates(clip, clip_s, !once, frame < rest_from_frame ? clip_rate : 0.0, glm::mat4(0.0f),
                    rates);
  }
  input_ = base;
  input_.dt_s = dt_s;
  input_.time_s = frame * dt_s;
  if (frame == 0)
    for (const PaintBrush& brush : first_brushes) input_.brush[input_.brush_count++] = brush;
  if (frame >= rest_from_frame) input_.wind = WindSetup{};
  const double angle = camera.start_rad + camera.rate_rad_per_s * time_s;
  const glm::vec3 from(float(camera.radius_m * exact::Sin(angle)), float(camera.height_m),
                       float(camera.radius_m * exact::Cos(angle)));
  for (int c = 0; c < 3; ++c) {
    input_.camera.target[c] = camera.target[c];
    input_.camera.eye[c] = camera.target[c] + from[c];
  }
  input_.camera.vertical_fov_rad = float(camera.vertical_fov_rad);
  input_.sphere_count = uint32_t(spheres.size());
  for (size_t s = 0; s < spheres.size(); ++s) {
    const float wave = float(Wave(time_s, spheres[s].period_s));
    for (int c = 0; c < 3; ++c)
      input_.sphere[s][c] = spheres[s].centre[c] + spheres[s].swing[c] * wave;
    input_.sphere[s][3] = spheres[s].radius;
  }
  input_.capsule_count = uint32_t(capsules.size());
  std::copy(capsules.begin(), capsules.end(), input_.capsule);
  constexpr double kWettingFrames = 30.0;
  const double share = std::clamp(
      (double(std::min(frame, rest_from_frame)) - weather_course.from_frame + 1.0) / kWettingFrames,
      0.0, 1.0);
  weather_.resize(actors.size());
  for (size_t a = 0; a < actors.size(); ++a) {
    weather_[a].wetness = float(weather_course.wetness * share * actors[a].weather_share);
    weather_[a].dirt = float(weather_course.dirt * share * actors[a].weather_share);
  }
  input_.weather = weather_;
  input_.cut = cut;
  if (more && frame < rest_from_frame) more(frame, scene, input_);
  if (place != glm::dvec3(0.0)) Place();
  return input_;
}

RunningScenario::RunningScenario(Scenario& scenario, SceneOptions options) : scenario_(&scenario) {
  options.velocities |= scenario.velocities;
  options.origins |= scenario.origins;
  options.strand_writes = std::max(options.strand_writes, scenario.strand_writes);
  scene_ = FurScene::Create(scenario.ActorGrooms(), options).OrThrow();
}

bool RunningScenario::GoOnWith(Scenario& scenario) {
  if (!scene_->ReplaceGrooms(scenario.ActorGrooms())) return false;
  scenario_ = &scenario;
  return true;
}

FrameInput RunningScenario::Prepare(uint32_t frame, const SkipSettings& skip,
                                    const LodSettings& lod) {
  FrameInput input = scenario_->PrepareFrame(frame, *scene_);
  input.skip = skip;
  input.skip.lod |= scenario_->base.skip.lod;  // of a scene that is meant so
  input.lod = lod;
  return input;
}

bool RunningScenario::TryBegin(const FrameInput& input) {
  if (const char* fault = scene_->BeginFrame(input)) {
    refusal_ = fault;
    return false;
  }
  // The frame is begun all the same, with that character as it was: seldom what was asked for.
  if (scenario_->keeps_poses) return true;
  for (const RefusedPose& refused : scene_->RefusedPoses())
    throw Error(fmt::format("{}: {}", scenario_->name, DescribeRefusedPose(refused)));
  return true;
}

std::string RunningScenario::RefusalText(uint32_t frame) const {
  return fmt::format("{}: frame {}: {}", scenario_->name, frame, refusal_);
}

void RunningScenario::Begin(uint32_t frame, const SkipSettings& skip, const LodSettings& lod) {
  if (!TryBegin(Prepare(frame, skip, lod))) throw Error(RefusalText(frame));
}

}  // namespace pelt
