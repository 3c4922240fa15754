#include <fmt/format.h>

#include <cstdio>

#include "bench/commands.hpp"
#include "bench/picture.hpp"
#include "bench/progress.hpp"
#include "core/error.hpp"

namespace pelt {

int Run(const RunArgs& args) {
  Scenario scenario;
  {
    Progress progress("bake", 1);
    scenario = LoadScenario(args.request, [&](uint32_t done, uint32_t total) {
      progress.Show(done, fmt::format("character {} of {}", done + 1, total));
    });
  }
  // In JSON output only the JSON goes to standard output.
  for (const std::string& note : scenario.notes)
    fmt::print(args.json ? stderr : stdout, "note: {}\n", note);
  if (args.weather) scenario.weather_course = *args.weather;
  if (args.fps > 0.0) scenario.dt_s = 1.0 / args.fps;
  RunOptions options = args.options;
  options.scene.plan.must_fit = options.executor == ExecutorKind::kLocalStore;
  RunningScenario running(scenario, options.scene);
  RunReport report;
  {
    Progress progress("run", options.frames ? options.frames : scenario.default_frames);
    options.progress = [&](uint32_t done, uint32_t) { progress.Show(done); };
    report = RunFrames(scenario, running, options);
  }
  if (!args.picture.empty()) {
    const Camera camera = scenario.PrepareFrame(report.frames - 1, running.scene()).camera;
    WritePicture(scenario, running.scene(), camera, options.scene.vertex_order,
                 {args.picture_width_px, args.picture_height_px}, args.picture);
  }
  fmt::print("{}\n", args.json ? RunAsJson(report) : DescribeRun(report));
  if (!args.picture.empty() && !args.json) fmt::print("picture {}\n", args.picture);
  if (!report.faults.empty())
    throw Error(fmt::format("{} local-store faults, the first: {}", report.faults.size(),
                            report.faults.front()));
  return 0;
}

}  // namespace pelt
