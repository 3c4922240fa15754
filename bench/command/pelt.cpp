// The `pelt` command: arguments in, exit code out.
//
// Exit codes are decided here and nowhere else (ExitCode): what keeps a subcommand from an answer is
// thrown. Every error is one line "pelt: ..." on standard error. The examples in the help texts are
// run by a test.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <exception>
#include <iostream>
#include <iterator>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include "bench/command/command_options.hpp"
#include "bench/command/usage_error.hpp"
#include "bench/report/embedded_page.hpp"
#include "bench/report/machine.hpp"
#include "bench/verify/shard.hpp"
#include "core/error.hpp"
#include "core/format.hpp"

namespace pelt {
namespace {

// `pelt --version`: what a report of a fault needs to say.
std::string DescribeVersion() {
  std::string text = fmt::format("pelt {}", PeltVersion());
  for (const auto& [name, value] : FingerprintOfBuild("version"))
    if (name != "command" && name != "version") text += fmt::format("\n{:<17} {}", name, value);
  return text;
}

// What `--help` shows of a subcommand with many options; `--help-all` shows all.
constexpr std::string_view kFirstOptions[] = {
    "help",    "help-all", "scene",   "character", "setup",    "frames",  "workers",  "executor",
    "quality", "lod",      "picture", "trace",     "json",     "out",     "platform", "target-ms",
    "random",  "shard",    "merge",   "memory",    "times",    "kernel",  "core",     "trip",
    "open",    "watch",    "replay",  "quick",     "features", "presets", "stats",    "keys"};
constexpr const char* kMore = "More options";
constexpr size_t kFew = 12;

class HelpText : public CLI::Formatter {
 public:
  std::string make_help(const CLI::App* app, std::string name,
                        CLI::AppFormatMode mode) const override {
    shows_all_ = mode == CLI::AppFormatMode::All;
    return Formatter::make_help(app, std::move(name), mode);
  }
  std::string make_group(std::string group, bool is_positional,
                         std::vector<const CLI::Option*> options) const override {
    if (group == kMore && !shows_all_)
      return fmt::format("\n{} options more: --help-all\n", options.size());
    return Formatter::make_group(std::move(group), is_positional, std::move(options));
  }

 private:
  mutable bool shows_all_ = false;
};

void PutFirstOptionsFirst(CLI::App& app) {
  for (CLI::App* sub : app.get_subcommands([](CLI::App*) { return true; }))
    PutFirstOptionsFirst(*sub);
  const std::vector<CLI::Option*> options = app.get_options();
  if (options.size() <= kFew) return;
  for (CLI::Option* option : options)
    if (option->nonpositional() &&
        std::ranges::find(kFirstOptions, option->get_single_name()) == std::end(kFirstOptions))
      option->group(kMore);
}

// One line, for any text that the message quotes. Not by fmt, which throws where standard error is closed.
void PrintError(const std::string& message) {
  std::fputs(("pelt: " + Printable(message) + "\n").c_str(), stderr);
}

// What may be set to other than the scene's own.
void CompleteRun(const CLI::App& app, const WeatherCourse& weather, RunArgs& args) {
  CompleteSource(app, args.request);
  args.weather = WeatherOf(app, weather);
  CheckCamera(args.camera);
}

// What runs and how.
void AddRun(CLI::App& app, RunArgs& args, WeatherCourse& weather) {
  AddSource(app, args.request);
  AddLayerPlan(app, args.request);
  AddClip(app, args.request);
  AddFrames(app, args.options.frames);
  AddExecutor(app, args.options.executor, args.options.workers, args.options.order_seed);
  AddIsa(app, "Instruction set of the kernels: the widest there is if not given",
         [&args](Isa isa) { args.options.scene.isa = isa; });
  AddPlanOptions(app, args.options.scene);
  AddSkips(app, args.options.skip, args.options.lod);
  AddTimeAndWeather(app, args.fps, weather);
  AddCamera(app, args.camera);
  AddPaint(app, args.paint);
  AddInputFile(app, "--haircut", args.haircut,
               "A .png or .jpg over the skin's texture: fur is cut off where it is dark");
  app.add_flag("!--no-digest", args.options.digest, "Do not take digests");
}

Subcommand SetUpRun(CLI::App& root) {
  const auto kept = std::make_shared<RunArgs>();
  const auto weather = std::make_shared<WeatherCourse>();
  RunArgs& args = *kept;
  auto* app = root.add_subcommand("run", "Run frames and print the frame budget");
  AddRun(*app, args, *weather);
  // All there are so far; the others say what is written.
  const std::vector<const CLI::Option*> of_run = std::as_const(*app).get_options();
  auto* costs = AddInputFile(*app, "--costs", args.costs,
                             "For --budget-us: what stages cost here, as pelt calibrate wrote it");
  costs->needs(AddFurBudget(*app, args.options.lod)->needs(costs));
  AddPictures(*app, args.picture);
  auto* trace = AddOutputFile(
      *app, "--trace", args.trace,
      "Chrome trace of the last frames, for ui.perfetto.dev or speedscope; stages are in "
      "every fourth frame, which keeps its cost below 2 %");
  app->add_option("--trace-frames", args.trace_frames, "With --trace: how many frames; 0: all")
      ->needs(trace)
      ->check(CLI::Range(0, 1'000'000))
      ->capture_default_str();
  app->add_flag(
         "--trace-worst", args.trace_worst,
         "With --trace: the slowest frame and those around it, not the last ones; every frame "
         "is recorded, with all stages, for about 3 %")
      ->needs(trace);
  AddOutputFile(*app, "--digest-log", args.digest_log,
                "Text file with a digest for each frame, stage and stream; see pelt diff");
  app->add_flag("--json", args.json, "Machine-readable output");
  app->footer(
      "Examples:\n"
      "  pelt run --scene monster --frames 20\n"
      "  pelt run --character builtin --setup eyepet --clip idle --once --frames 120\n"
      "  pelt run --scene tiny --frames 20 --digest-log tiny.digests\n"
      "  pelt run --scene tiny --frames 20 --trace trace.json --trace-frames 5\n"
      "  pelt run --scene tiny --frames 20 --trace worst.json --trace-worst --trace-frames 1\n"
      "  pelt run --scene tiny --executor serial --isa reference --no-sleep\n"
      "  pelt run --scene tiny --wetness 1 --dirt 0.5 --wet-at 20 --fps 30 --json\n"
      "  pelt run --character builtin --setup eyepet --frames 10 --picture eyepet.png\n"
      "  pelt run --scene monster --frames 61 --picture wet.png --time 1 --wetness 1 --light "
      "backlit\n"
      "  pelt run --scene tiny --frames 24 --animation turn.png --turntable --picture-width 320 "
      "--picture-height 240\n"
      "  pelt run --scene monster --frames 1 --picture relief.png --relief body,arms\n"
      "  pelt run --scene cast --frames 1 --lights night --picture night.png\n"
      "  pelt run --scene tiny --frames 5 --mud 0.6 --wet 1 --picture muddy.png\n"
      "  pelt run --groom monster.groom --frames 10 --lod --strand-budget 10000\n"
      "  pelt calibrate --scenes everything,tiny --frames 4 --out host.toml\n"
      "  pelt run --scene tiny --frames 60 --lod --budget-us 150 --costs host.toml");
  return {app,
          [app, kept, weather, of_run] {
            CompleteRun(*app, *weather, *kept);
            kept->given = ListGiven(of_run);
            CompletePictures(*app, kept->picture);
            if (kept->trace_worst && kept->trace_frames == 0)
              throw UsageError("--trace-worst has no effect with --trace-frames 0, which is all");
            CheckExecutor(*app, kept->options.executor);
          },
          [kept] { return Run(*kept); }};
}

Subcommand SetUpReport(CLI::App& root) {
  const auto kept = std::make_shared<ReportArgs>();
  const auto weather = std::make_shared<WeatherCourse>();
  ReportArgs& args = *kept;
  auto* app = root.add_subcommand("report", "Run frames and write one HTML page about them");
  AddRun(*app, args.run, *weather);
  AddOutputFile(*app, "--out", args.out, "Page to write; needs nothing else to be read");
  app->add_flag("!--no-consoles", args.consoles, "Leave out what consoles would make of it");
  AddInputFile(*app, "--accuracy", args.accuracy,
               "Also what pelt accuracy --json, with --scene or without, wrote to this file");
  app->footer(
      "Examples:\n"
      "  pelt report --scene tiny --frames 60 --out report.html\n"
      "  pelt report --character builtin --setup eyepet --frames 30 --workers 2 --no-consoles\n"
      "Two runs side by side are a page of pelt compare --page.");
  return {app,
          [app, kept, weather] {
            CompleteRun(*app, *weather, kept->run);
            CheckExecutor(*app, kept->run.options.executor);
          },
          [kept] { return Report(*kept); }};
}

Subcommand SetUpPlan(CLI::App& root) {
  const auto kept = std::make_shared<PlanArgs>();
  PlanArgs& args = *kept;
  auto* app = root.add_subcommand(
      "plan", "Print the passes, waits and bytes of a frame, and how far it spreads");
  AddSource(*app, args.request);
  AddPlanOptions(*app, args.options);
  app->add_flag("--local-store", args.local_store,
                "The plan for local stores, as pelt run --executor local-store runs it");
  app->add_option_function<std::string>(
         "--platform", [&args](const std::string&) { args.ps3 = true; },
         "The plan for a PS3, as pelt budget runs it: its local stores hold the code, too; refused "
         "where it cannot run the scene")
      ->check(OneOf({"ps3"}));
  auto* workers =
      app->add_option(
             "--workers", args.workers,
             "Also how much faster 2 to so many workers are, simulated: the same on every machine")
          ->check(CLI::Range(2, 64));
  AddInputFile(
      *app, "--times", args.times,
      "With --workers: stages take what they took in this run, which pelt run --json wrote, "
      "by the bytes of each item; without: as long as their bytes are many")
      ->needs(workers);
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
      "  pelt plan --scene monster --local-store\n"
      "  pelt plan --scene tiny --platform ps3 --quality best\n"
      "  pelt plan --scene monster --workers 16\n"
      "  pelt plan --scene tiny --unfused --chunk\n"
      "  pelt plan --scene monster --memory --memory-budget-mb 64\n"
      "  pelt plan --scene eyepet --json");
  return {app,
          [app, kept] {
            CompleteSource(*app, kept->request);
            RefuseBeside(*app, "--json", {"--chunk"});
            RefuseBeside(*app, "--platform", {"--local-store", "--workers"});
          },
          [kept] { return PrintPlan(*kept); }};
}

Subcommand SetUpVerify(CLI::App& root) {
  const auto kept = std::make_shared<VerifyArgs>();
  VerifyArgs& args = *kept;
  auto* app = root.add_subcommand(
      "verify", "Check that every executor, order, plan and instruction set gives the same bits");
  AddSource(*app, args.request);
  AddLayerPlan(*app, args.request);
  AddClip(*app, args.request);
  app->add_option("--frames", args.frames, "Frames to compare")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  AddIsa(*app, "Only this instruction set, against the reference",
         [&args](Isa isa) { args.isa = isa; });
  AddVelocities(*app, args.velocities);
  AddOrigins(*app, args.origins);
  app->add_option(
         "--random", args.random,
         "Instead of a scene so many that are drawn, each with its course, from --seed and "
         "the seeds after it")
      ->check(CLI::Range(1, 1'000'000));
  app->add_flag("!--no-skips", args.skips, "Leave out the section on skips");
  app->add_flag("--stop-at-failure", args.stop_at_failure,
                "Run nothing after the first case that fails");
  CLI::Option* no_checks =
      app->add_flag("!--no-checks", args.checks,
                    "Leave out the checks of access, waking, culling, rollback and digests");
  app->add_option("--rollback", args.rollback,
                  "Frames that are gone back at random places, under every executor; 0: none")
      ->check(CLI::Range(0, 1000))
      ->excludes(no_checks)
      ->capture_default_str();
  app->add_flag("--full", args.every_executor,
                "Every changed input under every executor; otherwise they rotate");
  app->add_flag("--json", args.json, "Machine-readable output");
  AddShards(*app, args.shard, args.merge);
  app->footer(
      "Examples:\n"
      "  pelt verify --scene tiny --frames 5\n"
      "  pelt verify --scene tiny --frames 3 --isa reference --no-skips --no-checks --json\n"
      "  pelt verify --scene tiny --frames 2 --isa reference --shard 0/8\n"
      "  pelt verify --scene tiny --frames 2 --isa reference --solver modal --velocities\n"
      "  pelt verify --scene tiny --frames 4 --isa reference --no-skips --rollback 8\n"
      "  pelt verify --random 3 --seed 7\n"
      "Several processes, and the one verdict of what they print:\n"
      "  mpirun -n 3 sh -c 'pelt verify --shard env --json > $OMPI_COMM_WORLD_RANK.json'\n"
      "  parallel 'pelt verify --shard {}/3 --json > {}.json' ::: 0 1 2\n"
      "  and then: pelt verify --merge 0.json 1.json 2.json");
  return {app,
          [app, kept] {
            RefuseAllBut(*app, "--random",
                         {"--seed", "--isa", "--stop-at-failure", "--shard", "--json"});
            CompleteSource(*app, kept->request);
          },
          [kept] { return VerifyScene(*kept); }};
}

struct TraceArgs {
  RecordArgs record;
  ReplayArgs replay;
  ShowArgs show;
};

ExitCode RunTrace(const CLI::App& trace, const TraceArgs& args) {
  if (trace.got_subcommand("record")) return Record(args.record);
  if (trace.got_subcommand("replay")) return ReplayRecording(args.replay);
  return ShowRecording(args.show);
}

Subcommand SetUpTrace(CLI::App& root) {
  const auto kept = std::make_shared<TraceArgs>();
  const auto weather = std::make_shared<WeatherCourse>();
  TraceArgs& args = *kept;
  auto* app =
      root.add_subcommand("trace", "Record all input of a scene; replay it bit for bit, anywhere");
  app->require_subcommand(1);
  app->footer(
      "Examples:\n"
      "  pelt trace record --scene tiny --frames 20 --out tiny.peltinput\n"
      "  pelt trace record --scene tiny --frames 20 --from 15 --out end.peltinput\n"
      "  pelt trace replay tiny.peltinput\n"
      "  pelt trace replay tiny.peltinput --executor serial --isa reference --digest-log "
      "again.digests\n"
      "  pelt trace show tiny.peltinput\n"
      "  pelt trace replay tiny.peltinput --executor tbb --workers 3 --unfused --json");
  auto* record = app->add_subcommand("record", "Run frames and write an input log");
  AddSource(*record, args.record.run.request);
  AddClip(*record, args.record.run.request);
  AddFrames(*record, args.record.run.options.frames);
  AddIsa(*record, "Instruction set of the kernels: the widest there is if not given",
         [&args](Isa isa) { args.record.run.options.scene.isa = isa; });
  AddPlanOptions(*record, args.record.run.options.scene);
  AddSkips(*record, args.record.run.options.skip, args.record.run.options.lod);
  AddTimeAndWeather(*record, args.record.run.fps, *weather);
  AddPaint(*record, args.record.run.paint);
  record
      ->add_option("--from", args.record.from,
                   "First frame to record: what came before is a snapshot at the log's head")
      ->capture_default_str();
  AddOutputFile(*record, "--out", args.record.out, "Input log to write")->required();

  auto* replay = app->add_subcommand(
      "replay", "Run an input log again; exit code 1 when a digest is not the recorded one");
  AddInputFile(*replay, "file", args.replay.path, "Input log")->required();
  AddExecutor(*replay, args.replay.as.executor, args.replay.as.workers, args.replay.as.order_seed);
  AddIsa(*replay, "Instruction set of the kernels: the widest there is if not given",
         [&args](Isa isa) { args.replay.as.isa = isa; });
  replay->add_flag("!--unfused", args.replay.as.fuse, "One stage a pass");
  replay->add_flag("--sort-pieces", args.replay.as.piecewise_sort, "Every layer sorts in pieces");
  AddOutputFile(*replay, "--digest-log", args.replay.digest_log,
                "Text file with a digest for each frame, stage and stream");
  replay->add_flag("--json", args.replay.json, "Machine-readable output");

  auto* show = app->add_subcommand("show", "What an input log holds");
  AddInputFile(*show, "file", args.show.path, "Input log")->required();
  show->add_flag("--json", args.show.json, "Machine-readable output");
  return {app,
          [=] {
            if (*record) CompleteRun(*record, *weather, kept->record.run);
            if (*replay) CheckExecutor(*replay, kept->replay.as.executor);
          },
          [app, kept] { return RunTrace(*app, *kept); }};
}

Subcommand SetUpDiff(CLI::App& root) {
  const auto kept = std::make_shared<DiffArgs>();
  DiffArgs& args = *kept;
  auto* app = root.add_subcommand(
      "diff", "The first difference of two digest logs, input logs or grooms; exit code 1 if any");
  AddInputFile(*app, "left", args.left, "File")->required();
  AddInputFile(*app, "right", args.right, "Another of its kind")->required();
  app->add_flag("--json", args.json, "Machine-readable output");
  app->footer(
      "Examples:\n"
      "  pelt diff tiny.digests again.digests\n"
      "  pelt diff tiny.peltinput tiny.peltinput\n"
      "  pelt diff monster.groom monster.groom --json");
  return {app, [] {}, [kept] { return Diff(*kept); }};
}

Subcommand SetUpGolden(CLI::App& root) {
  const auto kept = std::make_shared<GoldenArgs>();
  GoldenArgs& args = *kept;
  auto* app = root.add_subcommand("golden", "Check the built-in scenes against kept digests");
  auto* check =
      app->add_option("--check", args.check, "Folder of digest logs; exit code 1 when one differs");
  AddOutputFolder(*app, "--renew", args.renew,
                  "Folder of digest logs to write; says all that changed")
      ->excludes(check);
  app->add_option("--scene", args.scene, "Only the logs of this scene")->check(IsScene());
  app->add_flag("--json", args.json, "Machine-readable output of --check");
  AddShards(*app, args.shard, args.merge);
  app->footer(
      "Examples:\n"
      "  pelt golden --renew . --scene tiny\n"
      "  pelt golden --check . --scene tiny\n"
      "  pelt golden --check . --scene tiny --json\n"
      "Several processes: pelt golden --check . --shard 0/2 --json > 0.json, and so on; then\n"
      "pelt golden --merge 0.json 1.json.");
  return {app,
          [kept] {
            const int ways = !kept->check.empty() + !kept->renew.empty() + !kept->merge.empty();
            if (ways != 1) throw UsageError("one of --check, --renew and --merge is required");
            if (!kept->renew.empty() && (kept->json || !kept->shard.IsAll()))
              throw UsageError("--json and --shard are for --check, not for --renew");
          },
          [kept] { return CheckOrRenewGolden(*kept); }};
}

Subcommand SetUpConformance(CLI::App& root) {
  const auto kept = std::make_shared<ConformanceArgs>();
  ConformanceArgs& args = *kept;
  auto* app = root.add_subcommand(
      "conformance", "Check that job systems do what an engine door promises (jobs/README.md)");
  app->add_option("--door", args.door, "Only this one")->check(OneOf(ConformanceDoorNames()));
  app->add_option("--workers", args.workers, "Threads, this one included; 0: one for each core")
      ->check(CLI::Range(0, 256))
      ->capture_default_str();
  app->add_flag("--json", args.json, "Machine-readable output");
  app->footer(
      "Examples:\n"
      "  pelt conformance\n"
      "  pelt conformance --door threads --workers 4 --json");
  return {app, [] {}, [kept] { return CheckConformance(*kept); }};
}

ExitCode Main(int argc, char** argv) {
  CLI::App app("Pelt: character fur on the CPU, to profile, verify and port", "pelt");
  app.require_subcommand(1);
  app.formatter(std::make_shared<HelpText>());
  app.set_help_all_flag("--help-all", "Print this help message with all options and exit");
  app.add_flag_callback(
      "--json-keys",
      [] {
        throw CLI::CallForVersion(std::string(JsonKeys().substr(0, JsonKeys().size() - 1)), 0);
      },
      "What every key of every command's --json is");
  app.set_version_flag("--version", DescribeVersion, "What this program is and was built with");
  app.footer("See 'pelt bake --help' and so on for each.");
  const Subcommand subcommands[] = {SetUpBake(app),        SetUpRun(app),    SetUpPlan(app),
                                    SetUpVerify(app),      SetUpTiming(app), SetUpBudget(app),
                                    SetUpConformance(app), SetUpTrace(app),  SetUpDiff(app),
                                    SetUpGolden(app),      SetUpReport(app), SetUpView(app),
                                    SetUpAccuracy(app),    SetUpStress(app), SetUpCompare(app),
                                    SetUpShow(app),        SetUpFit(app),    SetUpCalibrate(app)};
  PutFirstOptionsFirst(app);
  try {
    app.parse(argc, argv);
    const Subcommand& chosen = *std::find_if(std::begin(subcommands), std::end(subcommands),
                                             [](const Subcommand& s) { return s.app->parsed(); });
    chosen.complete();
    CheckFiles(*chosen.app);
    return chosen.run();
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0)
      return app.exit(error), kDone;  // --help, --version, --json-keys
    PrintError(DescribeUsage(app, error));
    return kNoAnswer;
  }
}

// What is still in the buffer may find the disk full or the reader gone.
ExitCode FinishOutput(ExitCode exit_code) {
  std::cout.flush();
  if (std::fflush(stdout) == 0 && !std::ferror(stdout)) return exit_code;
  PrintError(std::string("standard output: ") +
             (errno ? std::generic_category().message(errno) : "not all could be written"));
  return exit_code == kDone ? kNoAnswer : exit_code;
}

}  // namespace
}  // namespace pelt

int main(int argc, char** argv) {
  pelt::ExitCode exit_code = pelt::kNoAnswer;
  try {
    exit_code = pelt::Main(argc, argv);
  } catch (const std::bad_alloc&) {
    pelt::PrintError("out of memory");
  } catch (const std::exception& error) {
    if (!std::ferror(stdout)) pelt::PrintError(error.what());
  }
  return pelt::FinishOutput(exit_code);
}
