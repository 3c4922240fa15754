// The options of `pelt fit` and `pelt calibrate`.
#include <algorithm>
#include <memory>

#include "bench/command/command_options.hpp"
#include "bench/command/usage_error.hpp"

namespace pelt {
namespace {

void CheckFit(const CLI::App& app, const FitArgs& args) {
  const bool host = std::ranges::count(args.platforms, "host") != 0;
  RefuseUnless(app, host, {"--costs"}, "--platform host");
  if (host && args.costs.empty())
    throw UsageError(
        "--platform host needs --costs: what stages cost on this machine, which pelt calibrate "
        "--out host.toml measures");
}

}  // namespace

Subcommand SetUpFit(CLI::App& root) {
  const auto kept = std::make_shared<FitArgs>();
  FitArgs& args = *kept;
  auto* app = root.add_subcommand("fit",
                                  "Choose solver, quality and share of the chains of each layer "
                                  "for a frame time: the least error on the screen; "
                                  "exit code 1 when not even the cheapest choice fits");
  AddScene(*app, args.request);
  AddGroomSeed(*app, args.request);
  AddClip(*app, args.request);
  app->add_option("--platform", args.platforms,
                  "That the scene is to fit, each: host, ps3, xbox360")
      ->check(OneOf({"host", "ps3", "xbox360"}))
      ->delimiter(',')
      ->default_str("ps3,xbox360");
  AddInputFile(*app, "--costs", args.costs,
               "With --platform host: what pelt calibrate measured; nothing is measured here");
  app->add_option("--target-ms", args.target_ms, "What a frame may take, by its 95th percentile")
      ->check(InRange(0.001, 1000.0))
      ->capture_default_str();
  app->add_option("--worst-px", args.worst_px,
                  "Error on the screen that no layer exceeds which can do better: the strands of "
                  "all get fewer "
                  "before that")
      ->check(InRange(0.0, 1e6))
      ->capture_default_str();
  app->add_flag("--lod", args.lod, "Of frames with level of detail, as stage always has it");
  AddFrames(*app, args.frames);
  app->add_option("--warm-up", args.warm_up, "Frames before those that count")
      ->check(CLI::Range(0, 100'000))
      ->capture_default_str();
  AddOutputFile(*app, "--out", args.out,
                "Plan to write, for --plan of run, report, budget, verify and accuracy --scene",
                ".toml");
  app->add_flag("--json", args.json, "Machine-readable output");
  app->footer(
      "Examples:\n"
      "  pelt fit --scene tiny --platform ps3 --target-ms 0.7 --frames 8 --warm-up 8 --out "
      "plan.toml\n"
      "  pelt budget --scene tiny --plan plan.toml --platform ps3 --target-ms 0.7 --frames 8 "
      "--warm-up 8\n"
      "  pelt run --scene tiny --plan plan.toml --frames 10\n"
      "  pelt fit --scene tiny --lod --frames 4 --warm-up 4 --json");
  return {app,
          [app, kept] {
            CompleteSource(*app, kept->request);
            CheckFit(*app, *kept);
          },
          [kept] { return PrintFit(*kept); }};
}

Subcommand SetUpCalibrate(CLI::App& root) {
  const auto kept = std::make_shared<CalibrateArgs>();
  CalibrateArgs& args = *kept;
  auto* app = root.add_subcommand(
      "calibrate",
      "Measure what the stages of a frame cost on this machine, for pelt fit --platform host; says "
      "UNSURE, in the file too, when others used it meanwhile");
  AddOutputFile(*app, "--out", args.out, "TOML file to write", ".toml")->required();
  app->add_option("--workers", args.workers, "Threads that share a frame; 0: one for each core")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  app->add_option("--frames", args.frames, "Frames of each scene in each solver and quality")
      ->check(CLI::Range(1, 100'000))
      ->capture_default_str();
  app->add_option("--scenes", args.scenes,
                  "Whose stages are measured; the last gives what part of its core time a frame "
                  "takes")
      ->check(IsScene())
      ->delimiter(',')
      ->default_str("everything,eyepet,stage");
  app->footer(
      "Examples:\n"
      "  pelt calibrate --scenes everything,tiny --frames 4 --out host.toml\n"
      "  pelt fit --scene tiny --platform host --costs host.toml --frames 4 --warm-up 4 "
      "--target-ms 500");
  return {app, [] {}, [kept] { return Calibrate(*kept); }};
}

}  // namespace pelt
