// The `pelt` command: arguments in, exit code out.
//
// Exit codes: 0 done (for verify: same bits), 1 bad input or a failed check, 2 wrong usage. Every
// error is one line "pelt: ..." on standard error. The examples in the help texts are run by a
// test.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "bench/commands.hpp"

namespace pelt {
namespace {

constexpr int kUsageError = 2;

std::vector<std::string> Names(const auto& range) {
  std::vector<std::string> names;
  for (const auto& name : range) names.emplace_back(name);
  return names;
}

std::vector<std::string> IsaNames() {
  std::vector<std::string> names;
  for (const Isa isa : kAllIsas) names.emplace_back(IsaName(isa));
  return names;
}

// What to run, for the subcommands that take a scene or files.
void AddSource(CLI::App& app, ScenarioRequest& request) {
  auto* scene = app.add_option("--scene", request.scene, "A built-in scene")
                    ->check(CLI::IsMember(Names(ScenarioNames())));
  auto* character =
      app.add_option("--character", request.character, "A .glb or .gltf file, or 'builtin'")
          ->excludes(scene)
          ->capture_default_str();
  auto* setup = app.add_option("--setup", request.setup,
                               "A fur setup: a .toml file, or the name of a built-in one")
                    ->excludes(scene);
  auto* groom =
      app.add_option("--groom", request.groom, "A baked groom instead of a setup; for --character")
          ->excludes(scene)
          ->excludes(setup);
  static_cast<void>(character);
  static_cast<void>(groom);
  app.add_option("--seed", request.seed, "Another groom from the same setups")
      ->capture_default_str();
}

// The scene is the monster unless something else is named.
void CompleteSource(ScenarioRequest& request) {
  if (!request.scene.empty() || !request.setup.empty() || !request.groom.empty()) return;
  if (request.character != "builtin")
    throw CLI::RequiredError("--character needs --setup or --groom, which");
  request.scene = "monster";
}

void AddIsa(CLI::App& app, const std::string& help, const std::function<void(Isa)>& set) {
  app.add_option_function<std::string>(
         "--isa", [set](const std::string& name) { set(*ParseIsa(name)); }, help)
      ->check(CLI::IsMember(IsaNames()));
}

void AddPlanOptions(CLI::App& app, SceneOptions& options) {
  app.add_flag("!--unfused", options.plan.fuse, "One stage a pass");
  app.add_flag_function(
      "--index-buffer", [&options](int64_t) { options.vertex_order = VertexOrder::kIndexBuffer; },
      "Vertices in strand order with a sorted index buffer, not in draw order");
  app.add_option("--sort-pieces", options.piecewise_sort_chunks,
                 "Layers of more chunks than this sort in pieces; 0: those that do not fit a local "
                 "store")
      ->capture_default_str();
}

void SetUpBake(CLI::App& root, BakeArgs& args) {
  auto* app = root.add_subcommand("bake", "Grow the fur of a character into a groom file");
  app->add_option("--character", args.character, "A .glb or .gltf file, or 'builtin'")
      ->capture_default_str();
  app->add_option("--setup", args.setup, "A fur setup: a .toml file, or the name of a built-in one")
      ->capture_default_str();
  app->add_option("--out", args.out, "Groom file to write");
  app->add_option("--seed", args.seed, "Another groom from the same setup")->capture_default_str();
  app->add_flag("--stats", args.stats, "How even every prefix of the scatter is");
  app->add_flag("--keys", args.keys, "Explain the keys of a fur setup");
  app->add_flag("--json", args.json, "Machine-readable output");
  app->footer(
      "Examples:\n"
      "  pelt bake --character builtin --setup monster --out monster.groom\n"
      "  pelt bake --setup eyepet --stats\n"
      "  pelt bake --setup tiny --json\n"
      "  pelt bake --keys");
}

void AddSkips(CLI::App& app, RunOptions& options) {
  const std::pair<const char*, bool*> skips[] = {{"sleep", &options.skip.sleep},
                                                 {"unmoved", &options.skip.unmoved},
                                                 {"sort", &options.skip.sort},
                                                 {"wind", &options.skip.wind},
                                                 {"cull", &options.skip.cull}};
  for (const auto& [name, value] : skips)
    app.add_flag(fmt::format("!--no-{}", name), *value,
                 fmt::format("Do not skip what '{}' finds needless", name));
  app.add_flag("--lod", options.skip.lod, "Fewer strands for layers that are small on screen");
  app.add_option("--strand-budget", options.lod.strand_budget,
                 "With --lod: most strands in all; 0: no budget")
      ->capture_default_str();
}

void SetUpRun(CLI::App& root, RunArgs& args, WeatherCourse& weather) {
  auto* app = root.add_subcommand("run", "Run frames and print the frame budget");
  AddSource(*app, args.request);
  app->add_option("--frames", args.options.frames, "Frames to run; 0: the scene's own number")
      ->check(CLI::Range(0, 1'000'000))
      ->capture_default_str();
  app->add_option_function<std::string>(
         "--executor",
         [&args](const std::string& name) { args.options.executor = *ParseExecutor(name); },
         "What runs the frames: tbb if not given")
      ->check(CLI::IsMember({"serial", "tbb", "permuted", "local-store"}));
  app->add_option("--workers", args.options.workers, "Threads for tbb; 0: one for each core")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  app->add_option("--order-seed", args.options.order_seed, "Order for permuted; 0: backwards")
      ->capture_default_str();
  AddIsa(*app, "Instruction set of the kernels: the widest there is if not given",
         [&args](Isa isa) { args.options.scene.isa = isa; });
  AddPlanOptions(*app, args.options.scene);
  AddSkips(*app, args.options);
  app->add_option("--fps", args.fps, "Frames a second of the simulation; 0: the scene's own")
      ->check(CLI::Range(0.0, 1000.0))
      ->capture_default_str();
  app->add_option("--wetness", weather.wetness, "0 dry to 1 wet")->check(CLI::Range(0.0, 1.0));
  app->add_option("--dirt", weather.dirt, "0 clean to 1 dirty")->check(CLI::Range(0.0, 1.0));
  app->add_option("--wet-at", weather.from_frame, "Frame from which it becomes wet and dirty")
      ->capture_default_str();
  app->add_flag("!--no-digest", args.options.digest, "Do not take digests");
  app->add_option("--picture", args.picture, "PNG file for a picture of the last frame");
  app->add_option("--picture-width", args.picture_width_px, "In pixels")
      ->check(CLI::Range(16, 4096))
      ->capture_default_str();
  app->add_option("--picture-height", args.picture_height_px, "In pixels")
      ->check(CLI::Range(16, 4096))
      ->capture_default_str();
  app->add_flag("--json", args.json, "Machine-readable output");
  app->footer(
      "Examples:\n"
      "  pelt run --scene monster --frames 20\n"
      "  pelt run --scene tiny --executor serial --isa reference --no-sleep\n"
      "  pelt run --scene tiny --wetness 1 --dirt 0.5 --wet-at 20 --fps 30 --json\n"
      "  pelt run --character builtin --setup eyepet --frames 10 --picture eyepet.png\n"
      "  pelt run --groom monster.groom --frames 10 --lod --strand-budget 10000");
}

void SetUpPlan(CLI::App& root, PlanArgs& args) {
  auto* app = root.add_subcommand("plan", "Print the passes, barriers and bytes of a frame");
  AddSource(*app, args.request);
  AddPlanOptions(*app, args.options);
  app->add_flag("--chunk", args.chunk, "Also the blocks of a chunk and their sizes");
  app->add_flag("--json", args.json, "Machine-readable output");
  app->footer(
      "Examples:\n"
      "  pelt plan --scene monster\n"
      "  pelt plan --scene tiny --unfused --chunk\n"
      "  pelt plan --scene eyepet --json");
}

void SetUpVerify(CLI::App& root, VerifyArgs& args) {
  auto* app = root.add_subcommand(
      "verify", "Check that every executor, order, plan and instruction set gives the same bits");
  AddSource(*app, args.request);
  app->add_option("--frames", args.frames, "Frames to compare")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  AddIsa(*app, "Only this instruction set, against the reference",
         [&args](Isa isa) { args.isa = isa; });
  app->add_flag("!--no-skips", args.skips, "Leave out the section on skips");
  app->add_flag("--json", args.json, "Machine-readable output");
  app->footer(
      "Examples:\n"
      "  pelt verify --scene tiny --frames 5\n"
      "  pelt verify --scene tiny --frames 3 --isa reference --no-skips --json");
}

int Main(int argc, char** argv) {
  CLI::App app("Pelt: character fur on the CPU, to profile, verify and port", "pelt");
  app.require_subcommand(1);
  app.footer("See 'pelt bake --help' and so on for each.");
  BakeArgs bake;
  RunArgs run;
  WeatherCourse weather;
  PlanArgs plan;
  VerifyArgs verify;
  SetUpBake(app, bake);
  SetUpRun(app, run, weather);
  SetUpPlan(app, plan);
  SetUpVerify(app, verify);
  try {
    app.parse(argc, argv);
    for (ScenarioRequest* request : {&run.request, &plan.request, &verify.request})
      if (app.got_subcommand(request == &run.request    ? "run"
                             : request == &plan.request ? "plan"
                                                        : "verify"))
        CompleteSource(*request);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help
    std::string message = error.what();
    std::replace(message.begin(), message.end(), '\n', ' ');
    fmt::print(stderr, "pelt: {} (see pelt --help)\n", message);
    return kUsageError;
  }
  if (weather.wetness > 0.0f || weather.dirt > 0.0f) run.weather = weather;
  if (app.got_subcommand("bake")) return Bake(bake);
  if (app.got_subcommand("run")) return Run(run);
  if (app.got_subcommand("plan")) return PrintPlan(plan);
  return VerifyScene(verify);
}

}  // namespace
}  // namespace pelt

int main(int argc, char** argv) {
  try {
    return pelt::Main(argc, argv);
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "pelt: out of memory\n");
  } catch (const std::exception& error) {
    fmt::print(stderr, "pelt: {}\n", error.what());
  }
  return 1;
}
