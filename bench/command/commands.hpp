// What the `pelt` command can do. Each function does one subcommand, writes its result to standard
// output and returns the exit code; what keeps it from an answer is thrown as Error.
#pragma once

#include <cstdint>
#include <cstdio>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bench/command/picture_shots.hpp"
#include "bench/report/json_text.hpp"
#include "bench/report/run_report.hpp"
#include "bench/scenarios/scenarios.hpp"
#include "bench/verify/verify.hpp"
#include "core/groom/surface_colour.hpp"
#include "platform_sim/platforms/platform.hpp"
#include "traces/diff.hpp"

namespace pelt {

// What `pelt` came to, of every subcommand. An Error is kNoAnswer, wherever it is thrown: pelt.cpp alone
// says so.
enum ExitCode : int {
  kDone = 0,      // done; of a check: yes
  kNo = 1,        // of a check: no. Nothing else
  kNoAnswer = 2,  // wrong use, a file that cannot be read, written or understood, no memory; UNSURE
  kIncomplete = 3,  // of a check: yes as far as it could look, and it could not look everywhere
};
constexpr ExitCode AnswerOf(bool yes) { return yes ? kDone : kNo; }

struct BakeArgs {
  std::string character = "builtin";
  std::string setup = "monster";
  OutputPath out;
  OutputPath flow_map, height_field, skin_map, stencil_map;  // PNG files
  std::string flow_layer;                                    // empty: the setup's first
  uint32_t flow_side = 512;  // texels, of all of them but the height field
  std::string strip_from;    // a photograph to cut into `strips` and no groom; empty: none
  uint32_t strips = 1;
  OutputPath strip;  // PNG file
  uint64_t seed = 0;
  bool stats = false, keys = false, json = false;
  CheckFilesReadHook check_files_read = {};  // as ScenarioRequest's
};
ExitCode Bake(const BakeArgs& args);

struct ShowCharacterArgs {
  std::string character = "builtin";
  OutputPath out;          // of the setup to start from
  OutputPath uv_template;  // PNG
  bool json = false;
  CheckFilesReadHook check_files_read = {};  // as ScenarioRequest's
};
ExitCode ShowCharacter(const ShowCharacterArgs& args);

// The character's UV layout as lines over the place of its image, to paint a map on. Rows from v = 0 at the top, as
// maps are read, so that what is painted there lies where the lines are. Black but for the lines, a colour for each
// material, which have no red: maps are read from that channel by default, and may be painted right over them.
struct UvTemplate {
  uint32_t width = 0, height = 0;  // of the largest image's shape
  std::vector<uint8_t> rgb;
};

// Throws pelt::Error for a character without texture coordinates.
UvTemplate DrawUvTemplate(const Character&, const SurfaceColour&);

// Where the camera stands instead of where the scene has it.
struct CameraChoice {
  // Yaw and elevation about the target in degrees, and the share of the scene's own distance; then it stands still.
  std::vector<double> orbit;
  std::vector<float> target_m;  // x, y, z
  bool turntable = false;       // once round in the frames that are run
};

struct RunArgs {
  ScenarioRequest request;
  RunOptions options;
  std::optional<WeatherCourse> weather;  // the scenario's own if not given
  double fps = 0.0;                      // 0: the scenario's own
  std::string costs;                     // file of pelt calibrate, for options.lod.budget_us
  CameraChoice camera;
  PaintAmounts paint = {};   // of all of every character; none: as the scenario has it
  std::string haircut = {};  // picture of what is cut off; empty: nothing
  PictureArgs picture;
  OutputPath trace;            // Chrome trace file to write
  uint32_t trace_frames = 10;  // the last ones; 0: all
  bool trace_worst = false;    // the slowest one and those around it instead
  OutputPath digest_log;       // to write
  bool json = false;
  // Options that change what is run or on what, as they were given: "--fps", "30".
  std::vector<std::pair<std::string, std::string>> given = {};
};
ExitCode Run(const RunArgs& args);

inline bool IsPainted(const RunArgs& args) { return args.paint != PaintAmounts{}; }
// The scenario as the arguments change it; what was assumed goes to `notes`, unless that is null.
Scenario LoadForRun(const RunArgs& args, std::FILE* notes);
// What makes its digests others than the scene's own: "lod, strand budget 400"; empty: nothing.
std::string DescribeSettings(const RunArgs& args);

struct RecordArgs {
  RunArgs run;
  uint32_t from = 0;  // the first frame that is recorded, with a snapshot before it
  OutputPath out;
};
ExitCode Record(const RecordArgs& args);

struct ReplayArgs {
  std::string path;
  // What runs it; the vertex order is the recording's.
  VerifyCase as{.executor = "tbb", .workers = 0, .isa = BestIsa()};
  OutputPath digest_log;
  bool json = false;
};
ExitCode ReplayRecording(const ReplayArgs& args);

struct ShowArgs {
  std::string path;
  bool json = false;
};
ExitCode ShowRecording(const ShowArgs& args);

struct DiffArgs {
  std::string left, right;
  bool json = false;
};
ExitCode Diff(const DiffArgs& args);
// Where two grooms first differ, in the order of the groom file: section, item (the chunk or layer), field and lane.
std::optional<Difference> FindDifference(const Groom& left, const Groom& right);

struct CompareArgs {
  std::string left, right;            // files of `pelt run --json`; or
  std::vector<std::string> commands;  // two that print such, run alternately
  uint32_t rounds = 15;               // intervals for up to 819 rows together
  OutputPath page;                    // HTML of both, to write
  bool json = false;
};
// 2: UNSURE, and printed, as others used the machine in a run; otherwise 0.
ExitCode Compare(const CompareArgs& args);

struct GoldenArgs {
  std::string check;  // a folder; or
  OutputPath renew;   // a folder
  std::string scene;  // empty: all
  bool json = false;
  Shard shard = {};
  std::vector<std::string> merge = {};  // files of shards to join, instead of running
};
ExitCode CheckOrRenewGolden(const GoldenArgs& args);

struct ReportArgs {
  RunArgs run;
  OutputPath out = OutputPath::Of("report.html");
  bool consoles = true;  // model the scene on both, too
  std::string accuracy;  // JSON file of `pelt accuracy` to show as well
};
ExitCode Report(const ReportArgs& args);
// What `pelt accuracy` wrote to a file, to be added to the page as one of AddAccuracySection (bench/accuracy/report).
std::function<void(JsonText&)> ReadAccuracySection(const std::string& path);
// A scene's frames as the consoles would run them, for the pages that show it. An object of AddConsoleFrame
// (bench/consoles/console_report.hpp) for each console, into an array: its slowest of at most 60 frames. One that
// cannot run the scene says why.
void AddModelledConsoles(Scenario& scenario, uint32_t frames, const SkipSettings& skip,
                         const LodSettings& lod, JsonText& json);

struct ViewArgs {
  ScenarioRequest request;
  OutputPath out = OutputPath::Of("view.html");
  uint32_t frames = 120;  // whose digests the page compares
  bool open = false;      // served to a browser of this machine, until a signal ends it
  bool watch = false;     // and the page follows what changes in the files
  uint16_t port = 0;      // 0: a free one
  bool consoles = false;  // with a frame of the scene as both would run it
  std::string replay;     // a recording to show instead of a scene
};
// A page that runs the scene in a browser.
ExitCode ViewScene(const ViewArgs& args);

struct PlanArgs {
  ScenarioRequest request;
  SceneOptions options;
  // The plan of `run --executor local-store`, in which every item fits; else that of all other
  // executors, which sort layers of any size whole.
  bool local_store = false;
  // Instead that of a PS3, whose local stores hold a pass's code, too, as `budget` runs it. Error
  // where it cannot, the same as `budget` reports.
  bool ps3 = false;
  uint32_t workers = 0;  // not 0: also how the frame spreads over 2 to so many
  std::string times;     // for that: a file that `run --json` wrote; empty: by bytes
  bool chunk = false, memory = false, json = false;
};
ExitCode PrintPlan(const PlanArgs& args);

struct TimingArgs {
  std::string path;    // of a listing; "-": standard input; or, with this empty:
  std::string kernel;  // how the names of the stages begin that are timed
  std::string scene = "tiny";
  uint32_t chart_slots = 0;      // of each kernel's scheduled code to print
  bool host_operations = false;  // LoweringRules
  std::string core = "spu";
  std::vector<std::string> trips;  // LABEL=N
  std::string second_thread;       // a listing that the PPE's other thread runs
  bool pair_by_order = false, hinted = false, smt = false, json = false;
};
ExitCode PrintTiming(const TimingArgs& args);
ExitCode PrintKernelTiming(const TimingArgs& args);

struct ValidateArgs {
  bool json = false;
};
// The measured rows beside the consoles' models; 1 if one is missed that is not known to be.
ExitCode PrintValidation(const ValidateArgs& args);

struct BudgetArgs {
  ScenarioRequest request;
  std::vector<std::string> platforms = {"host", "ps3", "xbox360"};
  double target_ms = 8.0;
  uint32_t frames = 60;
  SkipSettings skip;
  LodSettings lod;
  // What the consoles have instead of their own; not given: theirs.
  std::optional<uint32_t> spus, local_store_kib, cores, gpu_percent;
  uint32_t warm_up = 60;  // frames before those that count
  OutputPath trace;       // Chrome trace of the modelled consoles to write
  bool advice = true;
  bool qualities =
      false;  // also the error of the scene as it is, and other qualities' price and error
  bool numbers = false;   // only print the platforms' numbers
  bool validate = false;  // only compare the models with the measured rows
  bool json = false;
};
// The consoles' numbers as the arguments change them.
PlatformParameters NumbersOf(const BudgetArgs& args);
// 0: the scene fits every platform asked for; 1: it does not, and nothing else; 2: no answer, which
// is printed where it is UNSURE.
ExitCode PrintBudget(const BudgetArgs& args);

struct FitArgs {
  ScenarioRequest request;
  std::vector<std::string> platforms = {"ps3", "xbox360"};
  double target_ms = 5.0;
  float worst_px = LodSettings{}.worst_px;
  bool lod = false;
  std::string costs;                   // of the host: what Calibrate wrote
  uint32_t frames = 60, warm_up = 60;  // as of BudgetArgs
  OutputPath out;                      // layer plan to write
  bool json = false;
};
// 1: not even the cheapest plan fits; it is printed, and none is written.
ExitCode PrintFit(const FitArgs& args);

struct CalibrateArgs {
  OutputPath out;
  uint32_t workers = 0;  // 0: one for each core
  uint32_t frames = 30;  // of each scene and tier
  std::vector<std::string> scenes = {"everything", "eyepet", "stage"};
};
ExitCode Calibrate(const CalibrateArgs& args);

struct VerifyArgs {
  ScenarioRequest request;
  uint32_t frames = 20;
  std::optional<Isa> isa;  // only this instruction set, besides the reference
  bool skips = true, checks = true, every_executor = false, json = false;
  bool stop_at_failure = false;
  uint32_t rollback = VerifyOptions{}.rollback;
  bool velocities = false;  // poses come with them
  bool origins = false;     // characters have some
  uint32_t random = 0;      // scenes that are drawn from request.seed on, instead of the source's
  Shard shard = {};
  std::vector<std::string> merge = {};  // files of shards to join, instead of running
};
ExitCode VerifyScene(const VerifyArgs& args);

// `--merge`: reads what shards of a subcommand printed, and prints the one verdict.
ExitCode PrintMergedShards(std::string_view command, const std::vector<std::string>& paths,
                           bool json);

struct ConformanceArgs {
  std::string door;      // empty: all
  uint32_t workers = 0;  // 0: one for each core, at least two
  bool json = false;
};
std::vector<std::string> ConformanceDoorNames();
ExitCode CheckConformance(const ConformanceArgs& args);

struct AccuracyArgs;  // accuracy_args.hpp
ExitCode MeasureAccuracy(const AccuracyArgs& args);

struct StressArgs {
  std::vector<std::string> solvers;  // empty: ours, XPBD and implicit Euler
  std::vector<int> rates, links;     // empty: all
  std::vector<Isa> isas;             // empty: all this processor runs
  bool quick = false;
  OutputPath json;  // file to write
};
// 1 when a modal solver broke its promise.
ExitCode StressSolvers(const StressArgs& args);

}  // namespace pelt
