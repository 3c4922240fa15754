// The options of `pelt accuracy` and `pelt stress`.
#include <algorithm>
#include <memory>
#include <set>

#include "bench/accuracy/chain_problem.hpp"
#include "bench/command/accuracy_args.hpp"
#include "bench/command/command_options.hpp"

namespace pelt {
namespace {

void AddRatesAndLinks(CLI::App& app, std::vector<int>& rates, const std::set<int>& known,
                      std::vector<int>& links, const std::set<int>& known_links,
                      const char* links_text = "Links of a strand, 3 and 4 if not given") {
  app.add_option("--rates", rates, "Frames a second, all if not given")
      ->delimiter(',')
      ->check(CLI::IsMember(known));
  app.add_option("--links", links, links_text)->delimiter(',')->check(CLI::IsMember(known_links));
}

void AddBenchmark(CLI::App& app, AccuracyArgs& args) {
  std::vector<std::string> presets;
  for (const accuracy::Preset& preset : accuracy::kPresets) presets.emplace_back(preset.name);
  AddRatesAndLinks(app, args.rates, {15, 30, 60, 120, 240}, args.links, {3, 4});
  app.add_option("--presets", args.presets, "Materials, all if not given")
      ->delimiter(',')
      ->check(OneOf(presets));
  AddIsa(app, "Instruction set: the widest there is if not given",
         [&args](Isa isa) { args.isa = isa; });
  auto* seed = app.add_option("--seed", args.seed, "That motions and strands are drawn from")
                   ->check(CLI::Range(uint64_t{0}, uint64_t{UINT32_MAX}))
                   ->capture_default_str();
  auto* tuned = app.add_flag("--tuned", args.tuned,
                             "Instead of drawn problems: the suite that chose the constants of "
                             "the modal solver")
                    ->excludes(seed);
  app.add_flag("--calibrated", args.calibrated,
               "With --tuned: strands with the calibrated coefficients of layers, as drawn ones "
               "always are, not equal masses and joints")
      ->needs(tuned);
  app.add_flag("--quick", args.quick, "Few solvers and cases, 3 links at 60 Hz: seconds");
  AddOutputFile(app, "--json", args.json,
                "JSON file to write; pelt report --accuracy draws the benchmark's and a scene's");
}

void AddSceneAndFeatures(CLI::App& app, AccuracyArgs& args) {
  ScenarioRequest& scene = args.scene.emplace();
  AddScene(app, scene,
           "Instead of the benchmark: every way to run the frames of a built-in scene, or of a "
           "--character of yours, from cheapest to most exact, and how far each is off the rods "
           "that strands stand for");
  AddClip(app, scene);
  app.add_option("--frames", args.frames, "Of a scene: frames to run; 0: enough")
      ->check(CLI::Range(0, 100'000))
      ->capture_default_str();
  app.add_flag("!--no-contact", args.contact,
               "Of a scene: without surface, ground and spheres, whose impacts no quality follows "
               "more closely than its substeps");
  AddInputFile(app, "--plan", scene.plan,
               "Of a scene: also with its layers as this file of pelt fit --out has them");
  app.add_flag("--features", args.features,
               "Instead of the benchmark: error, penetration and time of contacts, max_distance, "
               "clumps, strength and wind");
}

// Which scene, if one is asked for.
void CompleteScene(const CLI::App& app, std::optional<ScenarioRequest>& scene) {
  constexpr const char* kScenes[] = {"--scene", "--character", "--setup", "--groom"};
  const auto given = std::ranges::find_if(kScenes, [&](const char* s) { return app.count(s); });
  if (given == std::end(kScenes)) {
    RefuseUnless(app, false, {"--frames", "--no-contact", "--plan", "--clip", "--once", "--lights"},
                 "--scene or --character");
    scene.reset();
    return;
  }
  CompleteSource(app, *scene);
  RefuseBeside(app, *given, {"--rates", "--links", "--presets", "--seed", "--tuned", "--features"});
}

// What replaces the benchmark has options of its own.
void CheckAccuracy(const CLI::App& app, AccuracyArgs& args) {
  CompleteScene(app, args.scene);
  RefuseBeside(app, "--features", {"--rates", "--presets", "--seed", "--tuned"});
}

}  // namespace

Subcommand SetUpAccuracy(CLI::App& root) {
  const auto kept = std::make_shared<AccuracyArgs>();
  AccuracyArgs& args = *kept;
  auto* app = root.add_subcommand("accuracy",
                                  "Error off a rod against run time, of layers and every strand "
                                  "solver");
  AddBenchmark(*app, args);
  AddSceneAndFeatures(*app, args);
  app->footer(
      "All of it takes some minutes, --scene monster about one and a half.\n"
      "Examples:\n"
      "  pelt accuracy --quick\n"
      "  pelt accuracy --quick --presets soft,stiff --json accuracy.json\n"
      "  pelt accuracy --quick --presets soft --seed 7\n"
      "  pelt accuracy --quick --presets soft --tuned --calibrated\n"
      "  pelt accuracy --scene tiny --quick --json scene.json\n"
      "  pelt accuracy --character builtin --setup tiny --clip shake --quick --frames 24\n"
      "  pelt accuracy --features --quick --links 3 --json features.json");
  return {app, [app, kept] { CheckAccuracy(*app, *kept); },
          [kept] { return MeasureAccuracy(*kept); }};
}

Subcommand SetUpStress(CLI::App& root) {
  const auto kept = std::make_shared<StressArgs>();
  StressArgs& args = *kept;
  auto* app = root.add_subcommand(
      "stress",
      "Numerical stability of strand solvers: teleports, white noise, violent motion; exit code 1 "
      "when the modal solver is not finite, settled and unstretched on every row");
  app->add_option("--solvers", args.solvers, "Only these: modal, pbd, xpbd-8, euler-1, ...")
      ->delimiter(',');
  AddRatesAndLinks(*app, args.rates, {15, 24, 30, 60, 120, 240}, args.links, {3, 4, 8},
                   "Links of a strand, 3 and 4 if not given; of 8 the modal solvers alone");
  app->add_option_function<std::vector<std::string>>(
         "--isa",
         [&args](const std::vector<std::string>& names) {
           args.isas.clear();
           for (const std::string& name : names) args.isas.push_back(*ParseIsa(name));
         },
         "Instruction sets, all there are if not given; figures are the first's")
      ->delimiter(',')
      ->check(IsIsa());
  app->add_flag("--quick", args.quick, "Few random starts and frame rates");
  AddOutputFile(*app, "--json", args.json, "JSON file to write");
  app->footer(
      "All of it takes about half a minute of one core on one vector instruction set.\n"
      "Examples:\n"
      "  pelt stress --quick --solvers modal-best,pbd --links 3\n"
      "  pelt stress --quick --solvers modal-fine,xpbd-8 --links 4 --rates 15,240 --json "
      "stress.json\n"
      "  pelt stress --quick --solvers modal --links 8 --rates 60");
  return {app, [] {}, [kept] { return StressSolvers(*kept); }};
}

}  // namespace pelt
