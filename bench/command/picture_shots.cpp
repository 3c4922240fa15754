#include "bench/command/picture_shots.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>

#include "bench/picture/light_steps.hpp"
#include "bench/picture/picture.hpp"
#include "bench/picture/png.hpp"
#include "bench/picture/relief_coat.hpp"
#include "bench/picture/renderers.hpp"
#include "bench/picture/skin_map.hpp"
#include "bench/report/budget.hpp"
#include "bench/shading/named_lights.hpp"
#include "core/error.hpp"

namespace pelt {
namespace {

double SecondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

std::vector<uint32_t> FramesAt(std::span<const double> times_s, double dt_s, uint32_t frames) {
  std::vector<uint32_t> found;
  for (const double time_s : times_s) {
    const double frame = std::round(time_s / dt_s);
    if (frame >= frames)
      throw Error(
          fmt::format("--time {}: the last of {} frames is at {:.3f} s; --frames {:.0f} has it",
                      time_s, frames, (frames - 1) * dt_s, frame + 1.0));
    found.push_back(uint32_t(frame));
  }
  std::ranges::sort(found);
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

std::vector<uint32_t> FramesToDraw(const PictureArgs& args, double dt_s, uint32_t frames) {
  if (!args.Any() || frames == 0) return {};
  if (!args.times_s.empty()) return FramesAt(args.times_s, dt_s, frames);
  const bool many = !args.folder.empty() || !args.animation.empty();
  std::vector<uint32_t> found;
  for (uint32_t f = many ? (frames - 1) % args.every : frames - 1; f < frames; f += args.every)
    found.push_back(f);
  return found;
}

ReliefShow ShowRelief(const PictureArgs& args, uint32_t frame, const FrameInput& input) {
  constexpr float kGustTile = 2.0f;  // m: 12 tiles of 48 hairs, 3.5 mm apart
  ReliefShow show;
  show.march.least = args.relief_steps[0];
  show.march.most = args.relief_steps[1];
  show.shows_steps = args.relief_shows_steps;
  if (args.relief_frames > 0) show.frame = int(frame * args.relief_frames % 4096);
  const glm::vec3 air = VecOf(input.wind.velocity);
  show.march.wind = air * args.relief_wind_s;
  // Textures lie in every direction: gusts go over all of them in one.
  const double gone = std::fmod(double(glm::length(air) / kGustTile) * input.time_s, 5.0);
  show.march.pan = {0.8f * float(gone), 0.6f * float(gone)};
  return show;
}

}  // namespace

void RequirePictures() {}

void WritePng(std::string_view what, const OutputPath& path, std::span<const uint8_t> pixels,
              uint32_t width, uint32_t height, uint32_t channels) {
  WriteOutput(what, path, EncodePng(pixels, width, height, channels));
}

std::vector<uint8_t> DrawSkinMap(const Character& character, const FurSetup& setup,
                                 const Groom& groom, uint32_t side,
                                 std::vector<std::string>& notes) {
  return MakeSkinMap(character, setup, groom, side, notes);
}

PictureShots::PictureShots(const PictureArgs& args, Scenario& scenario, FurScene& scene,
                           uint32_t frames, VertexOrder order)
    : args_(args),
      scenario_(scenario),
      scene_(scene),
      order_(order),
      frames_(FramesToDraw(args, scenario.dt_s, frames)) {
  CheckRelief(scenario, args_.relief, args_.relief_rim);
  if (!frames_.empty()) {
    const auto start = std::chrono::steady_clock::now();
    renderer_ = OpenRenderer(args_.renderer).OrThrow();
    open_seconds_ = SecondsSince(start);
  }
  if (args_.folder.empty()) return;
  MakeFolder(args_.folder);
  for (const uint32_t frame : frames_) CheckOutput("picture", FrameFile(frame));
}

PictureShots::PictureShots(PictureShots&&) noexcept = default;
PictureShots::~PictureShots() = default;

OutputPath PictureShots::FrameFile(uint32_t frame) const {
  return args_.folder.Inside(fmt::format("frame-{:05}.png", frame));
}

bool PictureShots::Wants(uint32_t frame) const {
  return std::ranges::binary_search(frames_, frame);
}

PictureScene PictureShots::Gather(uint32_t frame) {
  // The frame's input again, which depends on the frame's number alone.
  const FrameInput& input = scenario_.PrepareFrame(frame, scene_);
  const Camera camera = input.camera;
  const ReliefShow relief = ShowRelief(args_, frame, input);
  if (!maps_) maps_ = std::make_unique<PictureMaps>(scenario_, args_.relief, args_.relief_rim);
  PictureScene shown = GatherPicture(scenario_, *maps_, scene_, camera, order_);
  shown.relief = relief;
  for (const NamedLight& light : kNamedLights)
    if (light.name == args_.light)
      shown.ForEachLook([&](PictureLook& look) {
        look.room = light.room;
        look.light = MakeLight(light, {camera.eye[0], camera.eye[1], camera.eye[2]},
                               {camera.target[0], camera.target[1], camera.target[2]});
      });
  notes_ = maps_->notes();
  return shown;
}

void PictureShots::Take(uint32_t frame) {
  if (!Wants(frame)) return;
  const PictureOptions options{.width_px = args_.width_px,
                               .height_px = args_.height_px,
                               .lighting_buffer = args_.lighting_buffer};
  const auto start = std::chrono::steady_clock::now();
  const std::clock_t core_start = std::clock();
  const PictureScene shown = Gather(frame);
  std::vector<std::byte> png;
  try {
    const std::vector<uint8_t> rgb =
        args_.relief_frames > 0 ? DrawFrames(*renderer_, shown, options, args_.relief_frames)
                                : renderer_->Draw(shown, options);
    png = EncodePng(rgb, options.width_px, options.height_px, 3);
    relief_steps_ += renderer_->ReliefSteps().steps;
    relief_places_ += renderer_->ReliefSteps().places;
  } catch (const Error& error) {
    faults_.push_back(fmt::format("frame {}: {}", frame, error.what()));
    return;
  }
  core_seconds_ += double(std::clock() - core_start) / CLOCKS_PER_SEC;
  seconds_.push_back(SecondsSince(start));
  if (!args_.folder.empty()) Write("picture", FrameFile(frame), png);
  if (!args_.animation.empty()) {
    const auto next = std::ranges::upper_bound(frames_, frame);
    const uint32_t shown_for = next == frames_.end() ? 1 : *next - frame;
    animation_.push_back({png, shown_for * scenario_.dt_s});
  }
  if (frame != frames_.back()) return;
  last_ = std::move(png);
  if (!args_.steps.empty()) steps_ = DrawSteps(shown, options, *renderer_);
}

void PictureShots::Finish() {
  if (seconds_.empty()) return;
  if (!args_.last.empty() && !last_.empty()) Write("picture", args_.last, last_);
  if (!args_.steps.empty() && !steps_.empty()) {
    const uint32_t down = uint32_t(LightSteps().size() + kStepsAcross - 1) / kStepsAcross;
    Write("steps", args_.steps,
          EncodePng(steps_, args_.width_px * kStepsAcross, args_.height_px * down, 3));
  }
  if (!args_.animation.empty()) Write("animation", args_.animation, AnimatePng(animation_));
}

void PictureShots::Write(std::string_view what, const OutputPath& path,
                         std::span<const std::byte> png) {
  try {
    WriteOutput(what, path, png);
    written_.push_back(fmt::format("{} {}", what, path.path()));
  } catch (const Error& error) {
    faults_.push_back(error.what());
  }
}

void PictureShots::AddTo(ReportTree& tree) const {
  if (seconds_.empty()) return;
  std::vector<double> sorted = seconds_;
  const Spread spread = SpreadOf(sorted);
  ReportTree& section = tree.AddSection("pictures", "pictures, in no frame's time");
  section.Add({.key = "count"}, seconds_.size());
  section.Add({.key = "drawn_by"}, renderer_->Device());
  section.Add({.key = "open_ms", .unit = "ms", .decimals = 0, .heading = "opened in"},
              open_seconds_ * 1e3);
  section.Add({.key = "draw_core_ms", .unit = "ms", .decimals = 0, .heading = "core time"},
              core_seconds_ / double(seconds_.size()) * 1e3);
  section.Add({.key = "draw_ms.median", .unit = "ms", .decimals = 0, .heading = "median"},
              spread.median * 1e3);
  section.Add({.key = "draw_ms.worst", .unit = "ms", .decimals = 0, .heading = "worst"},
              spread.worst * 1e3);
  if (relief_places_ > 0)
    section.Add({.key = "relief_steps", .decimals = 2, .heading = "steps of relief"},
                relief_steps_ / double(relief_places_));
}

}  // namespace pelt
