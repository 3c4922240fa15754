#include "bench/viewer/viewer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "bench/picture/relief_coat.hpp"
#include "bench/viewer/data_views.hpp"
#include "bench/viewer/page_json.hpp"
#include "core/groom/setup_schema.hpp"
#include "jobs/pass_loop.hpp"

namespace pelt {
namespace {

using Json = PageJson;

glm::vec3 VecOfPlace(const float* p) { return {p[0], p[1], p[2]}; }

// Once for all layers, which have the values alone.
Json DescribeKeys() {
  Json keys = Json::array();
  for (const KeyEntry<LayerSetup>& entry : Schema<LayerSetup>()) {
    const KeyInfo& info = entry.info;
    Json& key = keys.emplace_back(Json{{"key", info.key},
                                       {"type", info.type},
                                       {"unit", info.unit},
                                       {"low", info.low},
                                       {"high", info.high},
                                       {"text", info.doc}});
    if (!info.words.empty()) key["words"] = info.words;
  }
  return keys;
}

Json DescribeSetups(const Scenario& scenario) {
  Json setups = Json::array();
  for (size_t s = 0; s < scenario.setups.size(); ++s) {
    Json layers = Json::array();
    for (const LayerSetup& layer : scenario.setups[s].layers) {
      Json values = Json::array();
      for (const KeyEntry<LayerSetup>& entry : Schema<LayerSetup>())
        values.push_back(entry.show(entry.info, layer));
      layers.push_back({{"name", layer.name}, {"values", values}});
    }
    setups.push_back({{"name", scenario.characters[s].name}, {"layers", layers}});
  }
  return setups;
}

Json DescribeSettings(const PageSettings& settings) {
  Json entries = Json::array();
  for (const PageEntry& entry : PageEntries()) entries.push_back(DescribeEntry(entry, settings));
  return entries;
}

std::unique_ptr<PictureMaps> MapsFor(const Scenario& scenario, const PageSettings& settings) {
  static const std::string kAll = "all";
  const bool relief = settings.relief > 0 && CanBeRelief(scenario);
  return std::make_unique<PictureMaps>(scenario, std::span(&kAll, size_t(relief)));
}

// Where the ray meets the triangle: how far on, or less than 0; and the shares of b and c there.
glm::vec3 Meet(const PageRay& ray, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  const glm::vec3 ab = b - a, ac = c - a, across = glm::cross(ray.along, ac);
  const float volume = glm::dot(ab, across);
  if (std::abs(volume) < 1e-12f) return {-1.0f, 0.0f, 0.0f};
  const glm::vec3 from = ray.from - a, over = glm::cross(from, ab);
  const float u = glm::dot(from, across) / volume, v = glm::dot(ray.along, over) / volume;
  return {u < 0.0f || v < 0.0f || u + v > 1.0f ? -1.0f : glm::dot(ac, over) / volume, u, v};
}

}  // namespace

Viewer::Viewer(ScenarioRequest request) : request_(std::move(request)) { Load(); }

void Viewer::Load() {
  auto scenario = std::make_unique<Scenario>(LoadScenario(request_));
  if (painted_) PaintAll(*scenario, {});
  auto settings = std::make_unique<PageSettings>(PageSettings{*scenario});
  for (const auto& [entry, value] : set_) entry->set(*settings, value);
  auto maps = MapsFor(*scenario, *settings);
  if (!running_ || !running_->GoOnWith(*scenario)) Begin(*scenario, settings->isa);
  maps_ = std::move(maps);
  settings_ = std::move(settings);
  scenario_ = std::move(scenario);
  ++loads_;
  last_input_.reset();
  ForgetPoses();
}

// On its groom, at the frame that is next.
void Viewer::Begin(Scenario& scenario, Isa isa) {
  auto running = std::make_unique<RunningScenario>(scenario, SceneOptions{.isa = isa});
  times_ = std::make_unique<FrameRecording>(running->scene().plan(), running->scene().shape());
  running_ = std::move(running);
  run_digest_ = {};
  is_begun_ = is_stale_ = false;
  last_input_.reset();
  ForgetPoses();
  before_.Forget();
}

// In the middle of the run: not a bit of it is another.
void Viewer::ChangeKernels() {
  const std::unique_ptr<RunningScenario> before = std::move(running_);
  const Digest digest = run_digest_;
  const bool is_begun = is_begun_;
  Begin(*scenario_, settings_->isa);
  running_->scene().CopyStateFrom(before->scene());
  run_digest_ = digest;
  is_begun_ = is_begun;
}

void Viewer::Restart() {
  Begin(*scenario_, settings_->isa);
  next_frame_ = 0;
}

void Viewer::ChangeKey(size_t setup, std::string_view layer, std::string_view key,
                       std::string_view value) {
  ReplaceSetup(setup, ChangeLayerKey(setup_text(setup), "setup", layer, key, value));
}

void Viewer::ReplaceSetup(size_t setup, std::string text) {
  std::vector<std::string> kept = request_.setup_texts;
  request_.setup_texts.resize(std::max(kept.size(), setup + 1));
  request_.setup_texts[setup] = std::move(text);
  try {
    Load();
  } catch (const Error&) {
    request_.setup_texts = std::move(kept);
    throw;
  }
}

void Viewer::Set(std::string_view key, double value) {
  const PageEntry& entry = PageEntryFor(key, value);
  const double dt_s = scenario_->dt_s;
  const Isa isa = settings_->isa;
  const bool had_relief = settings_->relief > 0;
  entry.set(*settings_, value);
  if (had_relief != (settings_->relief > 0)) {
    maps_ = MapsFor(*scenario_, *settings_);
    ForgetPoses();
  }
  is_stale_ |= !IsOfShowing(entry);
  if (!IsOfLight(entry)) ForgetPicture();
  set_[&entry] = value;
  if (settings_->isa != isa) ChangeKernels();
  // Time goes on where it is, to the next of the new frames.
  if (scenario_->dt_s != dt_s)
    next_frame_ = uint32_t(std::lround(next_frame_ * dt_s / scenario_->dt_s));
}

void Viewer::SetViewport(uint32_t width_px, uint32_t height_px) {
  width_px_ = width_px;
  height_px_ = height_px;
}

void Viewer::Paint(uint32_t channel, const glm::vec3& centre) {
  if (!painted_) {
    painted_ = true;
    Load();
  }
  PaintBrush brush;
  for (int c = 0; c < 3; ++c) brush.centre[c] = centre[c];
  brush.radius = float(settings_->brush_radius);
  brush.hardness = 0.5f;
  brush.channel = channel;
  brush.amount = float(settings_->brush_amount);
  brush_ = brush;
}

void Viewer::SetCamera(std::optional<PageCamera> camera) {
  camera_ = camera;
  if (settings_->hold_view && last_input_)
    StandFor(last_input_->camera);
  else
    is_stale_ = true;
}

// Where the user stands; returns where the frame is seen from, which may be held.
const Camera& Viewer::StandFor(const Camera& own) {
  last_camera_ = camera_ ? StandAt(*camera_, own) : own;
  if (!settings_->hold_view || !held_camera_) held_camera_ = last_camera_;
  return *held_camera_;
}

void Viewer::Look() {
  if (!is_stale_ || !last_input_) return;
  is_stale_ = false;
  FrameInput input = *last_input_;
  input.camera = StandFor(input.camera);
  ForgetPicture();
  input.skip = scenario_->base.skip;
  input.lod = scenario_->base.lod;
  input.dt_s = 0.0;
  input.brush_count = 0;
  if (const char* fault = scene().BeginFrame(input)) throw Error(fault);
  SerialExecutor().Run(scene().CurrentFrame());
}

// What the page adds to the scenario's own input.
void Viewer::AddOwn(FrameInput& input) {
  if (settings_->sphere_radius > 0.0 && sphere_centre_ && input.sphere_count < kSpheresPerScene) {
    const uint32_t s = input.sphere_count++;
    for (int c = 0; c < 3; ++c) {
      input.sphere[s][c] = (*sphere_centre_)[c];
      if (last_sphere_)
        input.sphere_velocity[s][c] =
            float(((*sphere_centre_)[c] - (*last_sphere_)[c]) / input.dt_s);
    }
    input.sphere[s][3] = float(settings_->sphere_radius);
    last_sphere_ = sphere_centre_;
  } else {
    last_sphere_.reset();
  }
  if (brush_ && input.brush_count < kBrushesPerScene) input.brush[input.brush_count++] = *brush_;
  brush_.reset();
}

// The last frame, before the next one takes its memory.
void Viewer::KeepForBlend() {
  before_.Forget();
  if (is_begun_ && IsShownBetween(scenario_->dt_s, *settings_)) before_.Keep(GatherFrame());
}

const char* Viewer::Step() {
  KeepForBlend();
  const TimePoint start = Now();
  FrameInput input = running_->Prepare(next_frame_, scenario_->base.skip, scenario_->base.lod);
  AddOwn(input);
  last_input_ = input;
  input.camera = StandFor(input.camera);
  is_stale_ = false;
  ForgetPoses();
  if (const char* fault = scene().BeginFrame(input)) return fault;
  caller_ms_ = double(ElapsedNs(start)) * 1e-6;
  Frame frame = scene().CurrentFrame();
  if (next_frame_ % kFramesAProfile == 0 || !is_begun_) frame.profile = times_->profile();
  SerialExecutor executor;
  executor.Run(frame);
  frame_ms_ = double(ElapsedNs(start)) * 1e-6;
  is_begun_ = true;
  if (next_frame_ < digest_frames_) run_digest_.Add64(scene().DigestFrame());
  ++next_frame_;
  return nullptr;
}

// The camera's axes, and half of the picture's extent a metre in front of the eye.
Viewer::Lens Viewer::FindLens() const {
  Lens lens;
  lens.eye = VecOfPlace(last_camera_.eye);
  lens.ahead = glm::normalize(VecOfPlace(last_camera_.target) - lens.eye);
  lens.right = glm::normalize(glm::cross(lens.ahead, VecOfPlace(last_camera_.up)));
  lens.up = glm::cross(lens.right, lens.ahead);
  lens.height = std::tan(0.5 * double(last_camera_.vertical_fov_rad));
  lens.width = lens.height * width_px_ / height_px_;
  return lens;
}

PageRay Viewer::RayAt(double x, double y) const {
  const Lens lens = FindLens();
  return {lens.eye, glm::normalize(lens.ahead + lens.right * float((2.0 * x - 1.0) * lens.width) +
                                   lens.up * float((1.0 - 2.0 * y) * lens.height))};
}

glm::vec3 Viewer::ShareOf(const glm::vec3& place) const {
  const Lens lens = FindLens();
  const glm::vec3 to = place - lens.eye;
  const float depth = glm::dot(to, lens.ahead);
  const float reach = std::max(depth, 1e-6f);
  return {0.5f + 0.5f * glm::dot(to, lens.right) / (reach * float(lens.width)),
          0.5f - 0.5f * glm::dot(to, lens.up) / (reach * float(lens.height)), depth};
}

std::span<const Body> Viewer::Bodies() const {
  if (!posed().empty()) return posed();
  if (!bodies_.empty()) return bodies_;
  for (uint32_t a = 0; a < scenario_->actors.size(); ++a)
    bodies_.push_back(PoseBody(*scenario_, running_->scene(), a,
                               maps_->SurfaceOf(scenario_->actors[a].character), nullptr, {},
                               &maps_->SkinOf(*scenario_, running_->scene(), a)));
  return bodies_;
}

std::optional<Viewer::Hit> Viewer::FindHit(const PageRay& ray) const {
  std::optional<Hit> nearest;
  float least = 1e30f;
  const std::span<const Body> bodies = Bodies();
  for (uint32_t a = 0; a < bodies.size(); ++a) {
    const auto& triangles = bodies[a].character->mesh.triangles;
    for (uint32_t t = 0; t < triangles.size(); ++t) {
      const auto& [p, q, r] = triangles[t];
      const std::vector<glm::vec3>& at = bodies[a].position;
      const glm::vec3 met = Meet(ray, at[p], at[q], at[r]);
      if (!(met.x > 0.0f && met.x < least)) continue;
      least = met.x;
      nearest = Hit{ray.from + met.x * ray.along, a, {t, {1.0f - met.y - met.z, met.y, met.z}}};
    }
  }
  return nearest;
}

std::optional<glm::vec3> Viewer::Pick(const PageRay& ray) const {
  const auto hit = FindHit(ray);
  if (!hit) return std::nullopt;
  return hit->position;
}

PictureScene Viewer::GatherFrame() const {
  return GatherPicture(*scenario_, *maps_, running_->scene(), last_camera_, VertexOrder::kSorted,
                       posed());
}

void Viewer::Light(PictureScene& shown) const {
  shown.camera = last_camera_;
  LightPicture(running_->scene(), shown);
  ApplyLook(shown);
}

void Viewer::ApplyLook(PictureScene& shown) const {
  ApplyLight(*settings_, shown);
  shown.relief.frame = settings_->relief == 2 ? int(next_frame_ % 64) : -1;
  shown.relief.shows_steps = settings_->relief == 3;
}

PictureScene Viewer::Gather(float share) const {
  PictureScene shown = GatherFrame();
  if (const auto show = DataViews()[settings_->show].show)
    show(running_->scene(), shown);
  else if (share < 1.0f)
    before_.Blend(share, shown);
  ApplyLook(shown);
  ApplyRenderFur(*settings_, shown);
  return shown;
}

std::string Viewer::Describe() const {
  Json json;
  json["name"] = scenario_->name;
  json["strands"] = scenario_->StrandCount();
  json["characters"] = scenario_->actors.size();
  json["frames"] = scenario_->default_frames;
  json["dt_s"] = scenario_->dt_s;
  const CameraOrbit& orbit = scenario_->camera;
  json["camera"] =
      DescribeOrbit({orbit.target, orbit.start_rad, std::atan2(orbit.height_m, orbit.radius_m),
                     std::hypot(orbit.height_m, orbit.radius_m)});
  json["keys"] = DescribeKeys();
  json["setups"] = DescribeSetups(*scenario_);
  json["settings"] = DescribeSettings(*settings_);
  json["channels"] = kPaintChannelNames;
  json["views"] = DescribeViews();
  json["joints"] = DescribeJoints(scenario_->characters.front().skeleton.name);
  json["passes"] = DescribePasses(running_->scene());
  json["notes"] = scenario_->notes;
  return json.dump(-1, ' ', true, Json::error_handler_t::replace);
}

std::string Viewer::LastFrame() const {
  const FurScene& scene = running_->scene();
  const Json json = {
      {"frame", next_frame_ == 0 ? 0 : next_frame_ - 1},
      {"run_digest",
       next_frame_ <= digest_frames_ ? fmt::format("{:016x}", run_digest_.Value()) : std::string()},
      {"ms", frame_ms_},
      {"caller_ms", caller_ms_},
      {"drawn", scene.DrawnStrands()},
      {"live", scene.LiveStrands()},
      {"stages", DescribeStages(scene, *times_)},
      {"layer_ns", DescribeLayerCosts(*scenario_, scene, *times_)}};
  return json.dump();
}

}  // namespace pelt
