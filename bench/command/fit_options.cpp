// The options of `pelt fit`.
#include <memory>

#include "bench/command/command_options.hpp"
#include "bench/command/file_options.hpp"

namespace pelt {

Subcommand SetUpFit(CLI::App& root) {
  const auto kept = std::make_shared<FitArgs>();
  FitArgs& args = *kept;
  auto* app = root.add_subcommand(
      "fit",
      "Choose solver and quality of each layer for a frame time: the least error on the screen; "
      "exit code 1 when not even the cheapest choice fits");
  AddSource(*app, args.request);
  // What it is there to choose.
  for (const char* chosen : {"--solver", "--quality"}) app->remove_option(app->get_option(chosen));
  AddClip(*app, args.request);
  app->add_option("--platform", args.platforms, "That the scene is to fit, each: ps3, xbox360")
      ->check(OneOf({"ps3", "xbox360"}))
      ->delimiter(',')
      ->default_str("ps3,xbox360");
  app->add_option("--target-ms", args.target_ms, "What a frame may take, by its 95th percentile")
      ->check(InRange(0.001, 1000.0))
      ->capture_default_str();
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
      "  pelt fit --scene tiny --frames 4 --warm-up 4 --json");
  return {app, [app, kept] { CompleteSource(*app, kept->request); },
          [kept] { return PrintFit(*kept); }};
}

}  // namespace pelt
