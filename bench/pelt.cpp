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

// As CLI::Range, but for "nan", which it lets through.
CLI::Validator InRange(double least, double most) {
  const auto check = [=](std::string& text) {
    double value = 0.0;
    if (CLI::detail::lexical_cast(text, value) && value >= least && value <= most)
      return std::string();
    return fmt::format("{} is not in the range from {} to {}", text, least, most);
  };
  return CLI::Validator(check, fmt::format("FLOAT in [{} - {}]", least, most));
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

void AddSkips(CLI::App& app, SkipSettings& skip, LodSettings& lod) {
  const std::pair<const char*, bool*> skips[] = {{"sleep", &skip.sleep},
                                                 {"unmoved", &skip.unmoved},
                                                 {"sort", &skip.sort},
                                                 {"wind", &skip.wind},
                                                 {"cull", &skip.cull}};
  for (const auto& [name, value] : skips)
    app.add_flag(fmt::format("!--no-{}", name), *value,
                 fmt::format("Do not skip what '{}' finds needless", name));
  app.add_flag("--lod", skip.lod, "Fewer strands for layers that are small on screen");
  app.add_option("--strand-budget", lod.strand_budget,
                 "With --lod: most strands in all; 0: no budget")
      ->capture_default_str();
}

void AddFrames(CLI::App& app, uint32_t& frames) {
  app.add_option("--frames", frames, "Frames to run; 0: the scene's own number")
      ->check(CLI::Range(0, 1'000'000))
      ->capture_default_str();
}

void AddExecutor(CLI::App& app, ExecutorKind& executor, uint32_t& workers, uint64_t& order_seed) {
  app.add_option_function<std::string>(
         "--executor", [&executor](const std::string& name) { executor = *ParseExecutor(name); },
         "What runs the frames: tbb if not given")
      ->check(CLI::IsMember({"serial", "tbb", "door", "pull", "permuted", "local-store"}));
  app.add_option("--workers", workers, "Threads for tbb, door and pull; 0: one for each core")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  app.add_option("--order-seed", order_seed, "Order for permuted; 0: backwards")
      ->capture_default_str();
}

void AddTimeAndWeather(CLI::App& app, double& fps, WeatherCourse& weather) {
  app.add_option("--fps", fps, "Frames a second of the simulation; 0: the scene's own")
      ->check(InRange(0.0, 1000.0))
      ->capture_default_str();
  app.add_option("--wetness", weather.wetness, "0 dry to 1 wet")->check(InRange(0.0, 1.0));
  app.add_option("--dirt", weather.dirt, "0 clean to 1 dirty")->check(InRange(0.0, 1.0));
  app.add_option("--wet-at", weather.from_frame, "Frame from which it becomes wet and dirty")
      ->capture_default_str();
}

// What runs and how.
void AddRun(CLI::App& app, RunArgs& args, WeatherCourse& weather) {
  AddSource(app, args.request);
  AddFrames(app, args.options.frames);
  AddExecutor(app, args.options.executor, args.options.workers, args.options.order_seed);
  AddIsa(app, "Instruction set of the kernels: the widest there is if not given",
         [&args](Isa isa) { args.options.scene.isa = isa; });
  AddPlanOptions(app, args.options.scene);
  AddSkips(app, args.options.skip, args.options.lod);
  AddTimeAndWeather(app, args.fps, weather);
  app.add_flag("!--no-digest", args.options.digest, "Do not take digests");
}

void SetUpRun(CLI::App& root, RunArgs& args, WeatherCourse& weather) {
  auto* app = root.add_subcommand("run", "Run frames and print the frame budget");
  AddRun(*app, args, weather);
  app->add_option("--picture", args.picture, "PNG file for a picture of the last frame");
  app->add_option("--picture-width", args.picture_width_px, "In pixels")
      ->check(CLI::Range(16, 4096))
      ->capture_default_str();
  app->add_option("--picture-height", args.picture_height_px, "In pixels")
      ->check(CLI::Range(16, 4096))
      ->capture_default_str();
  app->add_option(
      "--trace", args.trace,
      "Chrome trace of the last frames, for ui.perfetto.dev or speedscope; stages are in "
      "every fourth frame, which keeps its cost below 2 %");
  app->add_option("--trace-frames", args.trace_frames, "With --trace: how many frames; 0: all")
      ->check(CLI::Range(0, 1'000'000))
      ->capture_default_str();
  app->add_option("--digest-log", args.digest_log,
                  "Text file with a digest for each frame, stage and stream; see pelt diff");
  app->add_flag("--json", args.json, "Machine-readable output");
  app->footer(
      "Examples:\n"
      "  pelt run --scene monster --frames 20\n"
      "  pelt run --scene tiny --frames 20 --digest-log tiny.digests\n"
      "  pelt run --scene tiny --frames 20 --trace trace.json --trace-frames 5\n"
      "  pelt run --scene tiny --executor serial --isa reference --no-sleep\n"
      "  pelt run --scene tiny --wetness 1 --dirt 0.5 --wet-at 20 --fps 30 --json\n"
      "  pelt run --character builtin --setup eyepet --frames 10 --picture eyepet.png\n"
      "  pelt run --groom monster.groom --frames 10 --lod --strand-budget 10000");
}

void SetUpReport(CLI::App& root, ReportArgs& args, WeatherCourse& weather) {
  auto* app = root.add_subcommand("report", "Run frames and write one HTML page about them");
  AddRun(*app, args.run, weather);
  app->add_option("--out", args.out, "Page to write; needs nothing else to be read")
      ->capture_default_str();
  app->add_flag("!--no-consoles", args.consoles, "Leave out what consoles would make of it");
  app->footer(
      "Examples:\n"
      "  pelt report --scene tiny --frames 60 --out report.html\n"
      "  pelt report --character builtin --setup eyepet --frames 30 --workers 2 --no-consoles");
}

void SetUpPlan(CLI::App& root, PlanArgs& args) {
  auto* app = root.add_subcommand("plan", "Print the passes, barriers and bytes of a frame");
  AddSource(*app, args.request);
  AddPlanOptions(*app, args.options);
  app->add_flag("--chunk", args.chunk, "Also the blocks of a chunk and their sizes");
  app->add_flag("--memory", args.memory, "Also what every range of the scene's block takes");
  app->add_option_function<double>(
         "--memory-budget-mb",
         [&args](double mb) { args.options.memory_budget_bytes = uint64_t(mb * 1e6); },
         "Refuse a scene whose block is larger (1 MB = 10^6 bytes)")
      ->check(CLI::PositiveNumber);
  app->add_flag("--json", args.json, "Machine-readable output");
  app->footer(
      "Examples:\n"
      "  pelt plan --scene monster\n"
      "  pelt plan --scene tiny --unfused --chunk\n"
      "  pelt plan --scene monster --memory --memory-budget-mb 64\n"
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

struct TraceArgs {
  RecordArgs record;
  ReplayArgs replay;
  ShowArgs show;
};

void SetUpTrace(CLI::App& root, TraceArgs& args, WeatherCourse& weather) {
  auto* app = root.add_subcommand(
      "trace", "Record all that a scene is told; replay it bit for bit, anywhere");
  app->require_subcommand(1);
  app->footer(
      "Examples:\n"
      "  pelt trace record --scene tiny --frames 20 --out tiny.peltinput\n"
      "  pelt trace replay tiny.peltinput\n"
      "  pelt trace replay tiny.peltinput --executor serial --isa reference --digest-log "
      "again.digests\n"
      "  pelt trace show tiny.peltinput\n"
      "  pelt trace replay tiny.peltinput --executor tbb --workers 3 --unfused --json");
  auto* record = app->add_subcommand("record", "Run frames and write an input log");
  AddSource(*record, args.record.run.request);
  AddFrames(*record, args.record.run.options.frames);
  AddIsa(*record, "Instruction set of the kernels: the widest there is if not given",
         [&args](Isa isa) { args.record.run.options.scene.isa = isa; });
  AddPlanOptions(*record, args.record.run.options.scene);
  AddSkips(*record, args.record.run.options.skip, args.record.run.options.lod);
  AddTimeAndWeather(*record, args.record.run.fps, weather);
  record->add_option("--out", args.record.out, "Input log to write")->required();

  auto* replay = app->add_subcommand(
      "replay", "Run an input log again; exit code 1 when a digest is not the recorded one");
  replay->add_option("file", args.replay.path, "Input log")->required();
  AddExecutor(*replay, args.replay.as.executor, args.replay.as.workers, args.replay.as.order_seed);
  AddIsa(*replay, "Instruction set of the kernels: the widest there is if not given",
         [&args](Isa isa) { args.replay.as.isa = isa; });
  replay->add_flag("!--unfused", args.replay.as.fuse, "One stage a pass");
  replay->add_flag("--sort-pieces", args.replay.as.piecewise_sort, "Every layer sorts in pieces");
  replay->add_option("--digest-log", args.replay.digest_log,
                     "Text file with a digest for each frame, stage and stream");
  replay->add_flag("--json", args.replay.json, "Machine-readable output");

  auto* show = app->add_subcommand("show", "What an input log holds");
  show->add_option("file", args.show.path, "Input log")->required();
  show->add_flag("--json", args.show.json, "Machine-readable output");
}

void SetUpDiff(CLI::App& root, DiffArgs& args) {
  auto* app = root.add_subcommand(
      "diff", "The first difference of two digest logs, input logs or grooms; exit code 1 if any");
  app->add_option("left", args.left, "File")->required();
  app->add_option("right", args.right, "Another of its kind")->required();
  app->add_flag("--json", args.json, "Machine-readable output");
  app->footer(
      "Examples:\n"
      "  pelt diff tiny.digests again.digests\n"
      "  pelt diff tiny.peltinput tiny.peltinput\n"
      "  pelt diff monster.groom monster.groom --json");
}

void SetUpGolden(CLI::App& root, GoldenArgs& args) {
  auto* app = root.add_subcommand("golden", "Check the built-in scenes against kept digests");
  auto* check =
      app->add_option("--check", args.check, "Folder of digest logs; exit code 1 when one differs");
  app->add_option("--renew", args.renew, "Folder of digest logs to write; says all that changed")
      ->excludes(check);
  app->add_option("--scene", args.scene, "Only the logs of this scene")
      ->check(CLI::IsMember(Names(ScenarioNames())));
  app->require_option(1, 2);
  app->footer(
      "Examples:\n"
      "  pelt golden --renew . --scene tiny\n"
      "  pelt golden --check . --scene tiny");
}

int RunTrace(const CLI::App& trace, const TraceArgs& args) {
  if (trace.got_subcommand("record")) return Record(args.record);
  if (trace.got_subcommand("replay")) return ReplayRecording(args.replay);
  return ShowRecording(args.show);
}

void SetUpConformance(CLI::App& root, ConformanceArgs& args) {
  auto* app = root.add_subcommand(
      "conformance", "Check that job systems do what an engine door promises (jobs/README.md)");
  app->add_option("--door", args.door, "Only this one")
      ->check(CLI::IsMember(ConformanceDoorNames()));
  app->add_option("--workers", args.workers, "Threads, this one included; 0: one for each core")
      ->check(CLI::Range(0, 256))
      ->capture_default_str();
  app->add_flag("--json", args.json, "Machine-readable output");
  app->footer(
      "Examples:\n"
      "  pelt conformance\n"
      "  pelt conformance --door threads --workers 4 --json");
}

void SetUpTiming(CLI::App& root, TimingArgs& args) {
  auto* app = root.add_subcommand(
      "timing",
      "When each instruction of a listing, or of a kernel of ours, issues on a console's core");
  auto* file = app->add_option("file", args.path,
                               "Listing in the GNU assembler's syntax; -: standard input");
  auto* kernel = app->add_option("--kernel", args.kernel,
                                 "Instead of a listing: the stages whose names begin so");
  kernel->excludes(file);
  app->add_option("--scene", args.scene, "Scene that the kernel is recorded in")
      ->check(CLI::IsMember(Names(ScenarioNames())))
      ->needs(kernel)
      ->capture_default_str();
  app->add_option("--chart", args.chart_slots, "Print so many issues of the scheduled kernel")
      ->needs(kernel);
  app->add_flag("--host-operations", args.host_operations,
                "Price the host's operations one for one: no multiply-adds, no estimates")
      ->needs(kernel);
  app->add_option("--core", args.core, "Which core runs it; xenon: with --kernel")
      ->check(CLI::IsMember({"spu", "ppe", "xenon"}))
      ->capture_default_str();
  app->add_option("--trip", args.trips, "LABEL=N: the loop that begins there runs N turns")
      ->allow_extra_args(false);
  app->add_flag("--pair-by-order", args.pair_by_order,
                "Pair without looking at addresses, as the vendor's published static tool");
  app->add_flag("--hinted", args.hinted, "Every branch of an SPU as if it were hinted in time");
  app->add_flag("--smt", args.smt, "The PPE's other thread takes every second cycle");
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
}

void SetUpBudget(CLI::App& root, BudgetArgs& args) {
  auto* app = root.add_subcommand(
      "budget",
      "Does a scene fit its milliseconds on the host, a PS3 and an Xbox 360? Exit code 1 "
      "when it does not");
  AddSource(*app, args.request);
  app->add_option("--platform", args.platforms, "Only these: host, ps3, xbox360")
      ->check(CLI::IsMember({"host", "ps3", "xbox360"}))
      ->delimiter(',');
  app->add_option("--target-ms", args.target_ms, "What a frame may take")
      ->check(InRange(0.001, 1000.0))
      ->capture_default_str();
  app->add_option("--frames", args.frames, "Frames to run; 0: the scene's own number")
      ->check(CLI::Range(0, 1'000'000))
      ->capture_default_str();
  AddSkips(*app, args.skip, args.lod);
  app->add_option("--spus", args.spus, "SPUs of the PS3, instead of the 6 that a game has");
  app->add_option("--local-store-kib", args.local_store_kib, "Of an SPU, instead of 256");
  app->add_option("--cores", args.cores, "Cores of the Xbox 360, instead of 3");
  app->add_option("--gpu-percent", args.gpu_percent,
                  "Of the Xbox 360's memory bandwidth that its GPU takes")
      ->check(CLI::Range(0, 100));
  app->add_option("--trace", args.trace,
                  "Chrome trace of each console's slowest frame, in the console's own time");
  app->add_flag("!--no-advice", args.advice, "Do not look for what would make it fit");
  app->add_flag("--numbers", args.numbers, "Print the consoles' numbers, their sources, and stop");
  app->add_flag("--validate", args.validate,
                "Hold the models against the measured rows, print the table, and stop");
  app->add_flag("--json", args.json, "Machine-readable output");
  app->footer(
      "Examples:\n"
      "  pelt budget --scene tiny --frames 10\n"
      "  pelt budget --scene tiny --frames 10 --platform ps3 --target-ms 5 --trace ps3.json\n"
      "  pelt budget --scene tiny --frames 10 --platform ps3,xbox360 --spus 4 --json\n"
      "  pelt budget --validate\n"
      "  pelt budget --numbers");
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
  TimingArgs timing;
  SetUpTiming(app, timing);
  BudgetArgs budget;
  SetUpBudget(app, budget);
  ConformanceArgs conformance;
  SetUpConformance(app, conformance);
  TraceArgs trace;
  WeatherCourse trace_weather;
  DiffArgs diff;
  GoldenArgs golden;
  SetUpTrace(app, trace, trace_weather);
  SetUpDiff(app, diff);
  SetUpGolden(app, golden);
  ReportArgs report;
  WeatherCourse report_weather;
  SetUpReport(app, report, report_weather);
  try {
    app.parse(argc, argv);
    for (ScenarioRequest* request : {&run.request, &plan.request, &verify.request})
      if (app.got_subcommand(request == &run.request    ? "run"
                             : request == &plan.request ? "plan"
                                                        : "verify"))
        CompleteSource(*request);
    if (app.got_subcommand("report")) CompleteSource(report.run.request);
    if (app.got_subcommand("budget")) CompleteSource(budget.request);
    if (app.got_subcommand("trace")) CompleteSource(trace.record.run.request);
    if (app.got_subcommand("golden") && golden.check.empty() == golden.renew.empty())
      throw CLI::RequiredError("--check or --renew, which");
    if (app.got_subcommand("timing") && timing.path.empty()) {
      if (app.get_subcommand("timing")->count("--kernel") == 0)
        throw CLI::RequiredError("a listing or --kernel, one of them");
      for (const char* of_listing : {"--trip", "--pair-by-order", "--hinted", "--smt"})
        if (app.get_subcommand("timing")->count(of_listing))
          throw CLI::ExcludesError("--kernel", of_listing);
    } else if (app.got_subcommand("timing") && timing.core == "xenon") {
      throw CLI::ValidationError("--core xenon", "a listing runs on spu or ppe");
    }
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help
    std::string message = error.what();
    std::replace(message.begin(), message.end(), '\n', ' ');
    fmt::print(stderr, "pelt: {} (see pelt --help)\n", message);
    return kUsageError;
  }
  if (weather.wetness > 0.0f || weather.dirt > 0.0f) run.weather = weather;
  if (trace_weather.wetness > 0.0f || trace_weather.dirt > 0.0f)
    trace.record.run.weather = trace_weather;
  if (report_weather.wetness > 0.0f || report_weather.dirt > 0.0f)
    report.run.weather = report_weather;
  if (app.got_subcommand("report")) return Report(report);
  if (app.got_subcommand("trace")) return RunTrace(*app.get_subcommand("trace"), trace);
  if (app.got_subcommand("diff")) return Diff(diff);
  if (app.got_subcommand("golden")) return CheckOrRenewGolden(golden);
  if (app.got_subcommand("bake")) return Bake(bake);
  if (app.got_subcommand("run")) return Run(run);
  if (app.got_subcommand("plan")) return PrintPlan(plan);
  if (app.got_subcommand("timing"))
    return timing.path.empty() ? PrintKernelTiming(timing) : PrintTiming(timing);
  if (app.got_subcommand("budget")) return PrintBudget(budget);
  if (app.got_subcommand("conformance")) return CheckConformance(conformance);
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
