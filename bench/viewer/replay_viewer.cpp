#include "bench/viewer/replay_viewer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "bench/viewer/data_views.hpp"
#include "bench/viewer/page_json.hpp"
#include "jobs/pass_loop.hpp"

namespace pelt {
namespace {

glm::vec3 VecOfThree(const float* p) { return {p[0], p[1], p[2]}; }

// A recorder that has no camera leaves it as it is made.
bool IsNobodys(const Camera& camera) {
  const Camera made;
  return std::ranges::equal(camera.eye, made.eye) && std::ranges::equal(camera.target, made.target);
}

std::string Hex(uint64_t digest) { return fmt::format("{:016x}", digest); }

}  // namespace

// Runs a frame on this thread, and measures it.
class ReplayViewer::FrameTimer final : public Executor {
 public:
  explicit FrameTimer(const FrameProfile* profile) : profile_(profile) {}
  double caller_ms() const { return caller_ms_; }
  double frame_ms() const { return frame_ms_; }

 private:
  double Passed() const { return double(ElapsedNs(start_)) * 1e-6; }
  void RunPasses(const Frame& frame) override {
    caller_ms_ = Passed();
    Frame profiled = frame;
    profiled.profile = profile_;
    SerialExecutor().Run(profiled);
    frame_ms_ = Passed();
  }

  const FrameProfile* profile_;
  TimePoint start_ = Now();
  double caller_ms_ = 0.0, frame_ms_ = 0.0;
};

Result<std::unique_ptr<ReplayViewer>> ReplayViewer::Open(std::span<const std::byte> file,
                                                         const std::string& name) {
  Result<InputLog> log = ReadInputLog(file, name);
  if (!log) return Failure{log.error()};
  if (log->FrameCount() == 0) return Failure{fmt::format("input log '{}': no frame in it", name)};
  if (log->about.origins)
    return Failure{fmt::format(
        "input log '{}': its characters have origins of their own, and pictures know of "
        "one world; `pelt trace replay` runs it",
        name)};
  std::unique_ptr<ReplayViewer> viewer(new ReplayViewer(*std::move(log), name));
  std::string fault = viewer->MakeStage();
  if (fault.empty()) fault = viewer->Begin();
  if (!fault.empty()) return Failure{std::move(fault)};
  return viewer;
}

// Nothing of what was left out then shows where all the fur is: the first frame runs once without.
std::string ReplayViewer::MakeStage() {
  Result<ReplayScene> replay = ReplayScene::Open(log_, name_, SceneOptions{});
  if (!replay) return replay.error();
  SkipSettings& skip = log_.frames.front().input.skip;
  const SkipSettings recorded = std::exchange(skip, {.cull = false});
  const char* fault = replay->Begin(0);
  skip = recorded;
  if (fault) return fmt::format("input log '{}': frame 0 cannot run: {}", name_, fault);
  SerialExecutor().Run(replay->scene().CurrentFrame());
  for (const LayerDraw& draw : replay->scene().Draws()) {
    box_.low = glm::min(box_.low, VecOfThree(draw.low));
    box_.high = glm::max(box_.high, VecOfThree(draw.high));
  }
  if (box_.low.x > box_.high.x) box_ = {glm::vec3(-1.0f), glm::vec3(1.0f)};
  stage_.name = log_.about.scene;
  stage_.characters.resize(1);
  // No groom of the scenario has this number: no setup is looked for.
  stage_.actors.assign(log_.CharacterCount(),
                       Actor{.character = 0, .groom = ~0u, .clip = -1, .phase_s = 0.0});
  maps_ = std::make_unique<PictureMaps>(stage_);
  return {};
}

std::string ReplayViewer::Begin() {
  before_.Forget();
  ForgetPoses();
  course_.reset();
  times_.reset();
  replay_.reset();
  Result<ReplayScene> replay = ReplayScene::Open(log_, name_, SceneOptions{});
  if (!replay) return replay.error();
  replay_.emplace(*std::move(replay));
  course_.emplace(log_, *replay_);
  times_ = std::make_unique<FrameRecording>(replay_->scene().plan(), replay_->scene().shape());
  return {};
}

void ReplayViewer::Restart() {
  if (const std::string fault = Begin(); !fault.empty()) throw Error(fault);
}

uint32_t ReplayViewer::LastRun() const { return std::max(result().frames, 1u) - 1; }

const char* ReplayViewer::Step() {
  if (AtEnd()) Restart();
  before_.Forget();
  if (result().frames > 0 && IsShownBetween(log_.frames[result().frames].input.dt_s, settings_))
    before_.Keep(GatherFrame());
  ForgetPoses();
  const bool profiled = result().frames % kFramesAProfile == 0;
  FrameTimer executor(profiled ? times_->profile() : nullptr);
  if (!course_->RunNext(executor)) {
    refusal_ = fmt::format("frame {} cannot run: {}", result().frames, result().first->refused);
    return refusal_.c_str();
  }
  caller_ms_ = executor.caller_ms();
  frame_ms_ = executor.frame_ms();
  camera_ = log_.frames[LastRun()].input.camera;
  is_stale_ = user_ || IsNobodys(camera_);
  return nullptr;
}

void ReplayViewer::Set(std::string_view key, double value) {
  const PageEntry& entry = PageEntryFor(key, value);
  if (!IsOfShowing(entry)) throw Error(fmt::format("'{}': a recording has its own", key));
  entry.set(settings_, value);
  if (!IsOfLight(entry)) ForgetPicture();
}

void ReplayViewer::SetCamera(std::optional<PageCamera> camera) {
  user_ = camera;
  is_stale_ = true;
}

void ReplayViewer::Look() {
  if (!is_stale_ || result().frames == 0) return;
  is_stale_ = false;
  FrameInput input = log_.Input(LastRun());
  if (user_ || IsNobodys(input.camera))
    input.camera = StandAt(user_ ? *user_ : OrbitFrom(input.camera), input.camera);
  camera_ = input.camera;
  ForgetPicture();
  input.dt_s = 0.0;
  input.brush_count = 0;
  if (const char* fault = replay_->scene().BeginFrame(input)) throw Error(fault);
  SerialExecutor().Run(replay_->scene().CurrentFrame());
}

// So that the user goes on from where the recorded camera is, round the fur that it looks at; or, where none was
// recorded or it looks elsewhere, stands so that all of the fur is in sight.
PageCamera ReplayViewer::OrbitFrom(const Camera& own) const {
  const glm::vec3 centre = 0.5f * (box_.low + box_.high);
  const float radius = std::max(0.5f * glm::length(box_.high - box_.low), 0.05f);
  const glm::vec3 eye = VecOfThree(own.eye);
  const glm::vec3 ahead = glm::normalize(VecOfThree(own.target) - eye);
  const float along = glm::dot(centre - eye, ahead);
  const bool sees = along > 0.1f && glm::length(centre - eye - along * ahead) < radius + along;
  if (IsNobodys(own) || !sees)
    return {centre, 0.5, 0.15, double(radius) / std::sin(0.5 * double(own.vertical_fov_rad))};
  return {eye + along * ahead, std::atan2(double(-ahead.x), double(-ahead.z)),
          std::asin(std::clamp(double(-ahead.y), -1.0, 1.0)), double(along)};
}

PictureScene ReplayViewer::GatherFrame() const {
  return GatherPicture(stage_, *maps_, replay_->scene(), camera_, replay_->options().vertex_order,
                       posed());
}

void ReplayViewer::Light(PictureScene& shown) const {
  shown.camera = camera_;
  LightPicture(replay_->scene(), shown);
  ApplyLight(settings_, shown);
}

PictureScene ReplayViewer::Gather(float share) const {
  PictureScene shown = GatherFrame();
  if (const auto show = DataViews()[settings_.show].show)
    show(replay_->scene(), shown);
  else if (share < 1.0f)
    before_.Blend(share, shown);
  ApplyLight(settings_, shown);
  ApplyRenderFur(settings_, shown);
  return shown;
}

std::string ReplayViewer::Describe() const {
  PageJson json;
  uint64_t strands = 0;
  for (uint32_t c = 0; c < replay_->scene().shape().chunk_count; ++c)
    strands += replay_->scene().memory().Of<&Streams::strands>(c)->strand_count;
  json["name"] = log_.about.scene.empty() ? name_ : log_.about.scene;
  json["recording"] = {{"file", name_}, {"note", log_.about.note}};
  json["strands"] = strands;
  json["characters"] = log_.CharacterCount();
  json["frames"] = log_.FrameCount();
  json["dt_s"] = log_.frames.front().input.dt_s > 0.0 ? log_.frames.front().input.dt_s : 1.0 / 60.0;
  json["camera"] = DescribeOrbit(OrbitFrom(log_.frames.front().input.camera));
  json["keys"] = json["setups"] = PageJson::array();
  json["settings"] = PageJson::array();
  for (const PageEntry& entry : PageEntries())
    if (IsOfShowing(entry)) json["settings"].push_back(DescribeEntry(entry, settings_));
  json["channels"] = PageJson::array();
  json["views"] = DescribeViews();
  json["passes"] = DescribePasses(replay_->scene());
  json["notes"] = {"a recording holds no bodies: fur alone is drawn"};
  return json.dump(-1, ' ', true, PageJson::error_handler_t::replace);
}

std::string ReplayViewer::LastFrame() const {
  const FurScene& scene = replay_->scene();
  const InputLogFrame& frame = log_.frames[LastRun()];
  PageJson json = {{"frame", LastRun()},
                   {"run_digest", Hex(result().digest)},
                   {"digest", Hex(course_->found())},
                   {"recorded", Hex(frame.digest)},
                   {"others", result().mismatches},
                   {"dt_s", frame.input.dt_s},
                   {"camera", DescribeOrbit(OrbitFrom(frame.input.camera))},
                   {"ms", frame_ms_},
                   {"caller_ms", caller_ms_},
                   {"drawn", scene.DrawnStrands()},
                   {"live", scene.LiveStrands()},
                   {"stages", DescribeStages(scene, *times_)}};
  if (result().first) json["first_other"] = result().first->frame;
  if (!result().refused_pose.empty()) json["refused_pose"] = result().refused_pose;
  return json.dump(-1, ' ', true, PageJson::error_handler_t::replace);
}

}  // namespace pelt
