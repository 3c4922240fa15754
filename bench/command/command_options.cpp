#include "bench/command/command_options.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdlib>
#include <optional>

#include "bench/command/usage_error.hpp"
#include "bench/scenarios/embedded_files.hpp"
#include "core/error.hpp"
#include "core/groom/nearest_word.hpp"

namespace pelt {
namespace {

std::vector<std::string> Names(const auto& range) {
  std::vector<std::string> names;
  for (const auto& name : range) names.emplace_back(name);
  return names;
}

// An option that is one of the words of a layer parameter.
template <class Enum>
void AddWord(CLI::App& app, const char* name, const char* help, Enum LayerParams::*param,
             std::optional<Enum>& target) {
  const auto words = LayerParamEntryOf(param).words;
  const auto set = [&target, words](const std::string& word) {
    target = Enum(std::ranges::find(words, word) - words.begin());
  };
  app.add_option_function<std::string>(name, set, help)->check(OneOf(Names(words)));
}

using Entry = ExecutorEntry;

// "tbb, door and pull"
std::string ListOf(bool (Entry::*which)() const) {
  std::vector<std::string> names = OfferedExecutors(which);
  const std::string last = names.back();
  names.pop_back();
  return names.empty() ? last : fmt::format("{} and {}", fmt::join(names, ", "), last);
}

std::string DescribeExecutors() {
  std::string text = "What runs the frames: tbb if not given";
  for (const std::string& name : OfferedExecutors())
    text += fmt::format("\n{}: {}", name, ExecutorKind(name)->text);
  return text;
}

}  // namespace

CLI::Validator OneOf(std::vector<std::string> words) {
  const CLI::IsMember is_member(words);
  const auto check = [=](std::string& text) {
    const std::string word = text, fault = is_member(text);
    return fault.empty() ? fault : fault + DidYouMean(word, words);
  };
  return CLI::Validator(check, is_member.get_description());
}

CLI::Validator IsScene() { return OneOf(Names(ScenarioNames())); }

CLI::Validator IsIsa() {
  std::vector<std::string> names;
  for (const Isa isa : kAllIsas) names.emplace_back(IsaName(isa));
  return OneOf(names);
}

CLI::Validator InRange(double least, double most) {
  const auto check = [=](std::string& text) {
    double value = 0.0;
    if (CLI::detail::lexical_cast(text, value) && value >= least && value <= most)
      return std::string();
    return fmt::format("{} is not in the range from {} to {}", text, least, most);
  };
  return CLI::Validator(check, fmt::format("FLOAT in [{} - {}]", least, most));
}

std::vector<std::pair<std::string, std::string>> ListGiven(
    const std::vector<const CLI::Option*>& options) {
  std::vector<std::pair<std::string, std::string>> given;
  for (const CLI::Option* option : options) {
    if (!option->count()) continue;
    // A flag says nothing but that it is there.
    const bool is_flag = option->get_expected_max() == 0;
    const std::string value =
        is_flag ? "given" : fmt::format("{}", fmt::join(option->results(), ","));
    if (is_flag || value != option->get_default_str())
      given.emplace_back(option->get_name(), value);
  }
  return given;
}

void AddScene(CLI::App& app, ScenarioRequest& request, const char* scene_text) {
  auto* scene = app.add_option("--scene", request.scene, scene_text)->check(IsScene());
  AddInputFileOrName(app, "--character", request.character,
                     "A .glb or .gltf file, or 'builtin', 'scorpion'")
      ->excludes(scene)
      ->capture_default_str();
  auto* setup = AddInputFileOrName(app, "--setup", request.setup,
                                   "A fur setup: a .toml file, or the name of a built-in one")
                    ->excludes(scene);
  AddInputFile(app, "--groom", request.groom, "A baked groom instead of a setup; for --character")
      ->excludes(scene)
      ->excludes(setup);
  request.check_files_read = [&app](const std::vector<std::string>& files) {
    CheckFilesRead(app, files);
  };
  const std::string lights =
      fmt::format("Has every layer lit by [lights] of this .toml file, or by built-in ones: {}",
                  fmt::join(NamesOf(EmbeddedLights()), ", "));
  AddInputFileOrName(app, "--lights", request.lights, lights.c_str());
}

void AddGroomSeed(CLI::App& app, ScenarioRequest& request) {
  app.add_option("--seed", request.seed, "Another groom from the same setups")
      ->excludes(app.get_option("--groom"))
      ->capture_default_str();
}

void AddSource(CLI::App& app, ScenarioRequest& request) {
  AddScene(app, request);
  AddGroomSeed(app, request);
  AddWord(app, "--solver", "Of every layer that can have it, instead of its own",
          &LayerParams::solver, request.solver);
  AddWord(app, "--quality", "Of every layer with the modal solver, instead of its own",
          &LayerParams::quality, request.quality);
}

void AddLayerPlan(CLI::App& app, ScenarioRequest& request) {
  AddInputFile(
      app, "--plan", request.plan,
      "Layers as this file has them, which pelt fit --out wrote: solver and quality of each")
      ->excludes(app.get_option("--solver"))
      ->excludes(app.get_option("--quality"));
}

void AddClip(CLI::App& app, ScenarioRequest& request) {
  app.add_option("--clip", request.clip,
                 "The clip that is played, by name; of several characters, by those that have it")
      ->check([](const std::string& name) {
        return name.empty() ? std::string("the name is empty") : std::string();
      });
  app.add_flag("--once", request.once, "Clips stay at their ends instead of looping");
}

void CompleteSource(const CLI::App& app, ScenarioRequest& request) {
  RefuseUnless(app, request.solver.value_or(Solver::kModal) == Solver::kModal, {"--quality"},
               "the modal solver");
  if (!request.scene.empty() || !request.setup.empty() || !request.groom.empty()) return;
  if (request.character != "builtin") throw UsageError("--character needs --setup or --groom");
  request.scene = "monster";
}

void AddFrames(CLI::App& app, uint32_t& frames) {
  app.add_option("--frames", frames, "Frames to run; 0: the scene's own number")
      ->check(CLI::Range(0, 1'000'000))
      ->capture_default_str();
}

void AddIsa(CLI::App& app, const std::string& help, const std::function<void(Isa)>& set) {
  app.add_option_function<std::string>(
         "--isa", [set](const std::string& name) { set(*ParseIsa(name)); }, help)
      ->check(IsIsa());
}

void AddShards(CLI::App& app, Shard& shard, std::vector<std::string>& merge) {
  app.add_option_function<std::string>(
      "--shard",
      [&shard](const std::string& text) {
        try {
          shard =
              ParseShard(text, [](const char* name) -> const char* { return std::getenv(name); });
        } catch (const Error& error) {
          throw CLI::ValidationError(error.what());
        }
      },
      "Only this share of the cases: 0/3, 1/3 or 2/3 of three; env: as mpirun, Slurm or the CI "
      "numbers this process");
  auto* files = AddInputFile(app, "--merge", merge,
                             "What every shard printed with --json: one verdict of them all");
  for (CLI::Option* other : app.get_options())
    if (other != files && other->get_name() != "--json" && other != app.get_help_ptr())
      files->excludes(other);
}

void AddVelocities(CLI::App& app, bool& velocities) {
  app.add_flag("--velocities", velocities,
               "Poses with velocities, as their clips have them: exact roots between frames for "
               "layers with the modal solver");
}

void AddOrigins(CLI::App& app, bool& origins) {
  app.add_flag("--origins", origins,
               "Each character relative to a moving origin of its own: for worlds of many "
               "kilometres");
}

void AddPlanOptions(CLI::App& app, SceneOptions& options) {
  app.add_flag("!--unfused", options.plan.fuse, "One stage a pass");
  app.add_flag_function(
      "--index-buffer", [&options](int64_t) { options.vertex_order = VertexOrder::kIndexBuffer; },
      "Vertices in strand order with a sorted index buffer, not in draw order");
  AddVelocities(app, options.velocities);
  AddOrigins(app, options.origins);
  app.add_option("--sort-pieces", options.piecewise_sort_chunks,
                 "Layers of more chunks than this sort in pieces; 0: those that do not fit a local "
                 "store")
      ->capture_default_str();
}

void AddSkips(CLI::App& app, SkipSettings& skip, LodSettings& lod) {
  const std::pair<const char*, bool*> skips[] = {{"sleep", &skip.sleep}, {"unmoved", &skip.unmoved},
                                                 {"sort", &skip.sort},   {"wind", &skip.wind},
                                                 {"cull", &skip.cull},   {"light", &skip.light}};
  for (const auto& [name, value] : skips)
    app.add_flag(fmt::format("!--no-{}", name), *value,
                 fmt::format("Do not skip what '{}' finds redundant", name));
  auto* with_lod =
      app.add_flag("--lod", skip.lod, "Fewer strands for layers that are small on screen");
  app.add_option("--strand-budget", lod.strand_budget,
                 "With --lod: most strands in all; 0: no budget")
      ->needs(with_lod)
      ->capture_default_str();
  app.add_option(
         "--least-chains", lod.least_chains,
         "With --lod: least share of a layer's chains at mesh vertices that is simulated, 0 to 1; "
         "they thin with the strands, by halves")
      ->needs(with_lod)
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  app.add_option(
         "--fast-quality-px", lod.fast_quality_px,
         "Modal layers of quality 'fine' are simulated in 'fast' while its typical error on "
         "the screen (no bound) is at most this, px; 0: never")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
}

CLI::Option* AddFurBudget(CLI::App& app, LodSettings& lod) {
  auto* budget = app.add_option("--budget-us", lod.budget_us,
                                "Core time of the fur in view, us: what is over it by its costs is "
                                "taken from what is least seen; 0: no budget")
                     ->capture_default_str();
  app.add_option("--worst-px", lod.worst_px,
                 "With --budget-us: typical error on the screen up to which 'fine' is simulated in "
                 "'fast' for it, px; then, with --lod, strands go")
      ->needs(budget)
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  return budget;
}

void AddExecutor(CLI::App& app, ExecutorKind& executor, uint32_t& workers, uint64_t& order_seed) {
  app.add_option_function<std::string>(
         "--executor", [&executor](const std::string& name) { executor = ExecutorKind(name); },
         DescribeExecutors())
      ->check(OneOf(OfferedExecutors()));
  app.add_option("--workers", workers,
                 fmt::format("Threads for {}; 0: one for each core", ListOf(&Entry::HasWorkers)))
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  app.add_option("--order-seed", order_seed,
                 fmt::format("Order for {}; 0: backwards", ListOf(&Entry::HasSeed)))
      ->capture_default_str();
}

void CheckExecutor(const CLI::App& app, ExecutorKind executor) {
  RefuseUnless(app, executor->HasWorkers(), {"--workers"},
               "--executor " + ListOf(&Entry::HasWorkers));
  RefuseUnless(app, executor->HasSeed(), {"--order-seed"}, "--executor " + ListOf(&Entry::HasSeed));
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

void AddCamera(CLI::App& app, CameraChoice& choice) {
  app.add_option("--camera", choice.orbit,
                 "Where the camera stands, seen from what it looks at: yaw and elevation in "
                 "degrees, and how far off "
                 "as a share of the scene's own distance: 30,10,0.5. It stands still there")
      ->delimiter(',')
      ->expected(2, 3)
      ->allow_extra_args(false)
      ->type_name("YAW,ELEVATION[,SHARE]");
  app.add_option("--camera-target", choice.target_m, "What it looks at: x,y,z in m")
      ->delimiter(',')
      ->expected(3)
      ->allow_extra_args(false)
      ->check(InRange(-1e4, 1e4));
  app.add_flag("--turntable", choice.turntable,
               "The camera goes once round in the frames that are run");
}

void CheckCamera(const CameraChoice& choice) {
  if (choice.orbit.empty()) return;
  const auto refuse_outside = [](const char* what, double value, double least, double most) {
    if (!(value >= least && value <= most))
      throw UsageError(
          fmt::format("--camera: {} {} is not within {} and {}", what, value, least, most));
  };
  refuse_outside("yaw", choice.orbit[0], -360.0, 360.0);
  refuse_outside("elevation", choice.orbit[1], -85.0, 85.0);  // straight down has no up
  if (choice.orbit.size() > 2) refuse_outside("the share", choice.orbit[2], 0.01, 100.0);
}

void AddPaint(CLI::App& app, PaintAmounts& paint) {
  for (uint32_t c = 0; c < kPaintChannels; ++c)
    app.add_option(fmt::format("--{}", kPaintChannelNames[c]), paint[c],
                   "On all of every character from the first frame on, 0 to 1; has every layer lit "
                   "and painted")
        ->check(InRange(0.0, 1.0));
}

std::optional<WeatherCourse> WeatherOf(const CLI::App& app, const WeatherCourse& weather) {
  const bool given = app.count("--wetness") || app.count("--dirt");
  RefuseUnless(app, given, {"--wet-at"}, "--wetness and --dirt");
  if (!given) return std::nullopt;
  return weather;
}

void RefuseBeside(const CLI::App& app, const std::string& present,
                  std::initializer_list<const char*> ignored) {
  for (const char* option : ignored)
    if (app.count(present) && app.count(option))
      throw UsageError(fmt::format("{} has no effect with {}", option, present));
}

void RefuseAllBut(const CLI::App& app, const std::string& present,
                  const std::vector<std::string>& allowed) {
  for (const CLI::Option* option : app.get_options()) {
    const std::string name = option->get_name();
    if (app.count(present) && option->count() && name != present &&
        std::ranges::count(allowed, name) == 0)
      throw UsageError(fmt::format("{} has no effect with {}", name, present));
  }
}

void RefuseUnless(const CLI::App& app, bool has_effect, std::initializer_list<const char*> options,
                  const std::string& where) {
  for (const char* option : options)
    if (!has_effect && app.count(option))
      throw UsageError(fmt::format("{} has an effect only with {}", option, where));
}

}  // namespace pelt
