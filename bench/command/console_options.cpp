// The options of `pelt timing` and `pelt budget`.
#include <algorithm>
#include <memory>

#include "bench/command/command_options.hpp"
#include "bench/command/usage_error.hpp"

namespace pelt {
namespace {

// A listing and a kernel have options of their own.
void CheckTiming(const CLI::App& app, const TimingArgs& args) {
  if (!args.path.empty()) {
    if (args.core == "xenon") throw UsageError("--core xenon: a listing runs on spu or ppe");
    RefuseUnless(app, args.core == "spu", {"--pair-by-order", "--hinted"}, "--core spu");
    RefuseUnless(app, args.core == "ppe", {"--smt", "--second-thread"}, "--core ppe");
    RefuseBeside(app, "--second-thread", {"--trip", "--smt"});
    if (args.path == "-" && args.second_thread == "-")
      throw UsageError("--second-thread -: standard input is the first listing");
    return;
  }
  if (app.count("--kernel") == 0) throw UsageError("a listing or --kernel is required");
  RefuseBeside(app, "--kernel",
               {"--trip", "--pair-by-order", "--hinted", "--smt", "--second-thread"});
  RefuseBeside(app, "--json", {"--chart"});
}

// Each console has options of its own, and what only prints has none of a scene's.
void CheckBudget(const CLI::App& app, const BudgetArgs& args) {
  const auto asks_for = [&](const char* platform) {
    return std::ranges::count(args.platforms, platform) != 0;
  };
  RefuseAllBut(app, "--validate", {"--json"});
  RefuseAllBut(app, "--numbers", {"--spus", "--local-store-kib", "--cores", "--gpu-percent"});
  RefuseUnless(app, asks_for("ps3"), {"--spus", "--local-store-kib"}, "--platform ps3");
  RefuseUnless(app, asks_for("xbox360"), {"--cores", "--gpu-percent"}, "--platform xbox360");
  RefuseUnless(app, asks_for("ps3") || asks_for("xbox360"), {"--trace", "--no-advice"},
               "--platform ps3 or xbox360");
  RefuseUnless(app, !asks_for("host"), {"--budget-us"}, "--platform ps3, xbox360 or both");
}

// A machine that cannot be is refused before anything runs.
void CheckConsoles(const BudgetArgs& args) {
  std::string error;
  if (!CheckPlatforms(NumbersOf(args), error)) throw UsageError(error);
}

}  // namespace

Subcommand SetUpTiming(CLI::App& root) {
  const auto kept = std::make_shared<TimingArgs>();
  TimingArgs& args = *kept;
  auto* app = root.add_subcommand(
      "timing",
      "When each instruction of a listing, or of a kernel of ours, issues on a console's core");
  auto* file = AddInputFile(*app, "file", args.path,
                            "Listing in the GNU assembler's syntax; -: standard input");
  auto* kernel = app->add_option("--kernel", args.kernel,
                                 "Instead of a listing: the stages whose names begin so");
  kernel->excludes(file);
  app->add_option("--scene", args.scene, "Scene that the kernel is recorded in")
      ->check(IsScene())
      ->needs(kernel)
      ->capture_default_str();
  app->add_option("--chart", args.chart_slots, "Print so many issues of the scheduled kernel")
      ->needs(kernel);
  app->add_flag("--host-operations", args.host_operations,
                "Price the host's operations one for one: no multiply-adds, no estimates")
      ->needs(kernel);
  app->add_option("--core", args.core, "Which core runs it; xenon: with --kernel")
      ->check(OneOf({"spu", "ppe", "xenon"}))
      ->capture_default_str();
  app->add_option("--trip", args.trips, "LABEL=N: the loop that begins there runs N iterations")
      ->allow_extra_args(false);
  app->add_flag("--pair-by-order", args.pair_by_order,
                "Pair without looking at addresses, as the vendor's published static tool");
  app->add_flag("--hinted", args.hinted, "Every branch of an SPU as if it were hinted in time");
  app->add_flag("--smt", args.smt, "The PPE's other thread takes every second cycle");
  AddInputFile(*app, "--second-thread", args.second_thread,
               "Listing that the PPE's other thread runs meanwhile: the loop of each, for ever");
  app->add_flag("--json", args.json, "Machine-readable output");
  app->footer(
      "A listing, for example add.s:\n"
      "    loop: lqd $4, 0($3); fa $4, $4, $5; ai $7, $7, -1\n"
      "          stqd $4, 0($3); ai $3, $3, 16; brnz $7, loop\n"
      "Examples:\n"
      "  pelt timing add.s\n"
      "  pelt timing add.s --trip loop=256 --hinted\n"
      "  pelt timing add.s --pair-by-order --json\n"
      "  pelt timing --kernel simulate_pbd\n"
      "  pelt timing --kernel sort --scene monster --core xenon\n"
      "  pelt timing --kernel fit_cubic_4 --chart 40");
  return {app, [app, kept] { CheckTiming(*app, *kept); },
          [kept] { return kept->path.empty() ? PrintKernelTiming(*kept) : PrintTiming(*kept); }};
}

Subcommand SetUpBudget(CLI::App& root) {
  const auto kept = std::make_shared<BudgetArgs>();
  BudgetArgs& args = *kept;
  auto* app = root.add_subcommand(
      "budget",
      "Does a scene fit its milliseconds on the host, a PS3 and an Xbox 360? Exit code 1 "
      "when it does not, 2 when there is no answer: UNSURE, as others used the host meanwhile, or "
      "an error");
  AddSource(*app, args.request);
  AddLayerPlan(*app, args.request);
  AddClip(*app, args.request);
  app->add_option("--platform", args.platforms, "Only these: host, ps3, xbox360")
      ->check(OneOf({"host", "ps3", "xbox360"}))
      ->delimiter(',');
  app->add_option("--target-ms", args.target_ms, "What a frame may take")
      ->check(InRange(0.001, 1000.0))
      ->capture_default_str();
  AddFrames(*app, args.frames);
  app->add_option("--warm-up", args.warm_up, "Frames before those that count")
      ->check(CLI::Range(0, 100'000))
      ->capture_default_str();
  AddSkips(*app, args.skip, args.lod);
  AddFurBudget(*app, args.lod);
  app->add_option("--spus", args.spus, "SPUs of the PS3, instead of the 6 that a game has");
  app->add_option("--local-store-kib", args.local_store_kib, "Of an SPU, instead of 256");
  app->add_option("--cores", args.cores, "Cores of the Xbox 360, instead of 3");
  app->add_option("--gpu-percent", args.gpu_percent,
                  "Of the Xbox 360's memory bandwidth that its GPU takes")
      ->check(CLI::Range(0, 100));
  AddOutputFile(*app, "--trace", args.trace,
                "Chrome trace of each console's slowest frame, in the console's own time");
  app->add_flag("!--no-advice", args.advice, "Do not look for what would make it fit");
  app->add_flag(
      "--qualities", args.qualities,
      "Also at which error: of the scene as it is, and of better qualities for all of its "
      "layers, with what they take");
  app->add_flag("--numbers", args.numbers, "Print the consoles' numbers, their sources, and stop");
  app->add_flag("--validate", args.validate,
                "Compare the models with the measured rows, print the table, and stop");
  app->add_flag("--json", args.json, "Machine-readable output");
  app->footer(
      "Examples:\n"
      "  pelt budget --scene tiny --frames 10\n"
      "  pelt budget --scene tiny --frames 10 --platform ps3 --target-ms 5 --trace ps3.json\n"
      "  pelt budget --scene tiny --frames 10 --platform ps3,xbox360 --spus 4 --json\n"
      "  pelt budget --scene tiny --frames 10 --platform ps3 --qualities\n"
      "  pelt budget --scene tiny --frames 10 --platform ps3 --lod --budget-us 500\n"
      "  pelt budget --validate\n"
      "  pelt budget --numbers");
  return {app,
          [app, kept] {
            CompleteSource(*app, kept->request);
            CheckBudget(*app, *kept);
            CheckConsoles(*kept);
          },
          [kept] { return PrintBudget(*kept); }};
}

}  // namespace pelt
