// `pelt fit`: which solver and quality each layer gets for a frame time.
#include <fmt/format.h>

#include "bench/command/commands.hpp"
#include "bench/command/progress.hpp"
#include "bench/fit/console_price.hpp"
#include "bench/fit/host_costs.hpp"

namespace pelt {
namespace {

FitPlatform PlatformOf(const std::string& name, const FitArgs& args, const FitRequest& request) {
  if (name == "host")
    return OnHost(ReadHostCosts(args.costs), args.costs, request.warm_up, request.frames);
  return OnConsole({.console = name == "ps3" ? Console::kPs3 : Console::kXbox360,
                    .frames = request.frames,
                    .warm_up = request.warm_up});
}

// What it was fitted to; the rest is the plan's own.
std::string PlanText(const FitArgs& args, const SceneFit& fit) {
  std::string text = fmt::format("# pelt fit: {} for {} ms", fit.scene, args.target_ms);
  for (size_t p = 0; p < fit.platforms.size(); ++p)
    text += fmt::format("; {}: {:.3f} ms", fit.platforms[p], 1e-6 * double(fit.costs[p].frame_ns));
  return text + '\n' + LayerPlanText(fit.Plan());
}

}  // namespace

ExitCode PrintFit(const FitArgs& args) {
  RequireAccuracy();
  RunArgs run;
  run.request = args.request;
  Scenario scenario = LoadForRun(run, args.json ? stderr : stdout);
  scenario.base.skip.lod |= args.lod;
  FitRequest request{.target_ns = uint64_t(args.target_ms * 1e6 + 0.5),
                     .worst_px = args.worst_px,
                     .platforms = {},
                     .warm_up = args.warm_up,
                     .frames = args.frames ? args.frames : scenario.default_frames};
  for (const std::string& name : args.platforms)
    request.platforms.push_back(PlatformOf(name, args, request));
  Progress progress("fit", 1);
  request.progress = [&](const std::string& now) { progress.Show(0, now); };
  const SceneFit fit = FitScene(scenario, request);
  progress.Clear();
  MakeFitTree(fit).Print(args.json);
  if (!fit.Fits()) return kNo;
  if (!args.out.empty()) WriteOutput("layer plan", args.out, PlanText(args, fit));
  if (!args.out.empty() && !args.json) fmt::print("plan {}\n", args.out.path());
  return kDone;
}

}  // namespace pelt
