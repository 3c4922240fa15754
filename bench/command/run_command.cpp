#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <deque>

#include "bench/command/commands.hpp"
#include "bench/command/progress.hpp"
#include "bench/fit/host_costs.hpp"
#include "bench/report/timeline.hpp"
#include "bench/verify/stage_digests.hpp"
#include "core/error.hpp"
#include "core/exact_math.hpp"
#include "jobs/tick_clock.hpp"
#include "traces/chrome_trace.hpp"

namespace pelt {
namespace {

std::string TraceText(const FurScene& scene, const RunReport& report,
                      std::span<const FrameRecord> frames, double ns_per_tick) {
  Timeline timeline = BuildTimeline(scene, frames, report.workers, ns_per_tick);
  timeline.process = fmt::format("pelt {}", report.scene);
  timeline.metadata = {
      {"scene", report.scene},
      {"digest", report.options.digest ? fmt::format("{:016x}", report.digest) : "not taken"},
      {"executor", std::string(report.options.executor->name)},
      {"workers", fmt::format("{}", report.workers)},
      {"kernels", std::string(IsaName(report.options.scene.isa))},
      {"machine", fmt::format("{} ({} cores)", report.machine.processor, report.machine.cores)},
      {"compiler", report.machine.compiler},
      {"commit", report.machine.commit}};
  return ChromeTrace(timeline);
}

// The frames that a trace is of, passed in one after the other.
class TracedFrames {
 public:
  explicit TracedFrames(const RunArgs& args) : most_(args.trace_frames), worst_(args.trace_worst) {}

  void Add(FrameRecord record) {
    const uint64_t ticks = record.ticks.end - record.ticks.begin;
    const bool slowest = ticks > slowest_ticks_;
    if (slowest) slowest_ticks_ = ticks, slowest_frame_ = record.frame;
    if (worst_ && slowest) frames_.assign(before_.begin(), before_.end());
    if (!worst_ || slowest || frames_.size() < most_) frames_.push_back(record);
    if (!worst_) return;
    before_.push_back(std::move(record));
    if (before_.size() > (most_ - 1) / 2) before_.pop_front();
  }

  const std::vector<FrameRecord>& frames() const { return frames_; }
  std::string Describe() const {
    const std::string what = fmt::format("trace of {} frames", frames_.size());
    return worst_ ? fmt::format("{}, of which {} was the slowest of all,", what, slowest_frame_)
                  : what;
  }

 private:
  uint32_t most_;
  bool worst_;
  uint64_t slowest_ticks_ = 0;
  uint32_t slowest_frame_ = 0;
  std::vector<FrameRecord> frames_;
  std::deque<FrameRecord> before_;  // what a slower frame would have before itself
};

// As wide as a report, to both streams.
void PrintNotes(const std::vector<std::string>& notes, std::FILE* to) {
  ReportTree tree;
  tree.AddTexts("notes", notes, "note");
  fmt::print(to, "{}", tree.Text());
}

void PlaceCamera(const CameraChoice& choice, Scenario& scenario, uint32_t frames) {
  CameraOrbit& orbit = scenario.camera;
  if (!choice.target_m.empty())
    orbit.target = {choice.target_m[0], choice.target_m[1], choice.target_m[2]};
  if (!choice.orbit.empty()) {
    const double elevation = choice.orbit[1] * exact::kRadiansPerDegree;
    const double distance_m = std::hypot(orbit.radius_m, orbit.height_m) *
                              (choice.orbit.size() > 2 ? choice.orbit[2] : 1.0);
    orbit.start_rad = choice.orbit[0] * exact::kRadiansPerDegree;
    orbit.radius_m = distance_m * exact::Cos(elevation);
    orbit.height_m = distance_m * exact::Sin(elevation);
    orbit.rate_rad_per_s = 0.0;
  }
  if (choice.turntable) orbit.rate_rad_per_s = 2.0 * exact::kPi / (frames * scenario.dt_s);
}

}  // namespace

Scenario LoadForRun(const RunArgs& args, std::FILE* notes) {
  Scenario scenario;
  {
    Progress progress("bake", 1);
    scenario = LoadScenario(args.request, [&](uint32_t done, uint32_t total) {
      progress.Show(done, fmt::format("character {} of {}", done + 1, total));
    });
  }
  if (notes) PrintNotes(scenario.notes, notes);
  if (args.weather) scenario.weather_course = *args.weather;
  if (IsPainted(args)) PaintAll(scenario, args.paint);
  if (!args.haircut.empty()) CutHair(scenario, args.haircut);
  if (args.fps > 0.0) scenario.dt_s = 1.0 / args.fps;
  scenario.origins = args.options.scene.origins;
  PlaceCamera(args.camera, scenario,
              args.options.frames ? args.options.frames : scenario.default_frames);
  return scenario;
}

ExitCode Run(const RunArgs& args) {
  if (!args.trace.empty()) CheckRecords(args.options.executor);
  // In JSON output only the JSON goes to standard output.
  Scenario scenario = LoadForRun(args, args.json ? stderr : stdout);
  RunOptions options = args.options;
  options.scene.plan.must_fit = options.executor->local_store;
  if (!args.costs.empty())
    options.lod.costs = FurCostsOnHost(ReadHostCosts(args.costs), args.costs, scenario);
  RunningScenario running(scenario, options.scene);
  const uint32_t frames = options.frames ? options.frames : scenario.default_frames;
  PictureShots pictures(args.picture, scenario, running.scene(), frames,
                        options.scene.vertex_order);
  TracedFrames traced(args);
  const TickScale tick_scale;
  if (!args.trace.empty()) {
    if (args.trace_worst)
      options.observed_as = Recording::kAll;
    else if (args.trace_frames && args.trace_frames < frames)
      options.observe_from_frame = frames - args.trace_frames;
    options.observe = [&](const FinishedFrame& f) {
      traced.Add(RecordFrame(f.scene, f.profile, f.frame, f.ticks));
    };
  }
  const StageDigests stage_digests(running.scene());
  DigestLog digest_log =
      stage_digests.Begin(scenario.name, DescribeSettings(args), options.scene.vertex_order);
  RunReport report;
  {
    Progress progress("run", frames);
    options.progress = [&](uint32_t done, uint32_t) {
      progress.Show(done, pictures.Count()
                              ? fmt::format("{} of {} pictures", pictures.Taken(), pictures.Count())
                              : "");
    };
    options.after_frame = [&](uint32_t frame, const FurScene& scene) {
      if (!args.digest_log.empty()) stage_digests.AddFrame(scene, digest_log);
      pictures.Take(frame);
    };
    report = RunFrames(scenario, running, options);
  }
  ReportTree tree = MakeRunTree(report);
  ReportTree& given = tree.AddSection("options");
  for (const auto& [option, value] : args.given) given.Add(InJson(option), value);
  pictures.AddTo(tree);
  fmt::print("{}", args.json ? tree.Json() : tree.Text() + '\n');
  PrintNotes(pictures.notes(), args.json ? stderr : stdout);
  pictures.Finish();
  for (const std::string& file : pictures.written())
    if (!args.json) fmt::print("{}\n", file);
  // One that cannot be written keeps no other from being written.
  std::vector<std::string> faults = pictures.faults();
  const auto write = [&](std::string_view what, const OutputPath& path, const auto& make) {
    if (path.empty()) return;
    try {
      WriteOutput(what, path, make());
      if (!args.json) fmt::print("{} {}\n", what, path.path());
    } catch (const Error& error) {
      faults.push_back(error.what());
    }
  };
  write(traced.Describe(), args.trace, [&] {
    return TraceText(running.scene(), report, traced.frames(), tick_scale.NsPerTick());
  });
  write("digest log", args.digest_log, [&] { return WriteDigestLog(digest_log); });
  if (!faults.empty()) throw Error(fmt::format("{}", fmt::join(faults, "; ")));
  if (!report.faults.empty())
    throw Error(
        fmt::format("{} faults, the first: {}", report.faults.size(), report.faults.front()));
  return kDone;
}

}  // namespace pelt
