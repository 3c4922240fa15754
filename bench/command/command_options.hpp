// What the subcommands of `pelt` have in common: how one is declared, the groups of options that several take, and
// options that name files.
//
// A subcommand is one function that declares its options and returns what is to be done with them,
// so that everything about it stands in one place and `main` knows none of it.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bench/command/commands.hpp"
#include "bench/command/output_path.hpp"

namespace pelt {

struct Subcommand {
  CLI::App* app;
  // Called once the arguments are parsed; throws CLI::ParseError for those that do not go together.
  std::function<void()> complete;
  std::function<ExitCode()> run;
};

// What makes a groom (bake_options.cpp).
Subcommand SetUpBake(CLI::App& root);
Subcommand SetUpShow(CLI::App& root);
// Of a listing or a scene on a console's core (console_options.cpp).
Subcommand SetUpTiming(CLI::App& root);
Subcommand SetUpBudget(CLI::App& root);
// Of what a scene's layers get (fit_options.cpp).
Subcommand SetUpFit(CLI::App& root);
Subcommand SetUpCalibrate(CLI::App& root);
// Two runs compared with each other (compare_options.cpp).
Subcommand SetUpCompare(CLI::App& root);
// A page of a scene (view_options.cpp).
Subcommand SetUpView(CLI::App& root);
// Of strand solvers (accuracy_options.cpp).
Subcommand SetUpAccuracy(CLI::App& root);
Subcommand SetUpStress(CLI::App& root);

// One of these words; says which was meant where it is mistyped.
CLI::Validator OneOf(std::vector<std::string> words);
// A built-in scene's name.
CLI::Validator IsScene();
// An instruction set's name, or several.
CLI::Validator IsIsa();
// As CLI::Range, but for "nan", which it lets through.
CLI::Validator InRange(double least, double most);

// Those of `options` that were given, and not what they are anyway: names, and values as text.
std::vector<std::pair<std::string, std::string>> ListGiven(
    const std::vector<const CLI::Option*>& options);

// A scene or files.
void AddScene(CLI::App& app, ScenarioRequest& request, const char* scene_text = "A built-in scene");
// That its grooms are drawn from.
void AddGroomSeed(CLI::App& app, ScenarioRequest& request);
// Both, and a solver and quality for all of its layers.
void AddSource(CLI::App& app, ScenarioRequest& request);
// For those that run a scene as `pelt fit` chose it.
void AddLayerPlan(CLI::App& app, ScenarioRequest& request);
// For those that play clips.
void AddClip(CLI::App& app, ScenarioRequest& request);
// The scene is the monster unless something else is named.
void CompleteSource(const CLI::App& app, ScenarioRequest& request);

void AddFrames(CLI::App& app, uint32_t& frames);
void AddIsa(CLI::App& app, const std::string& help, const std::function<void(Isa)>& set);
// --shard and --merge, for subcommands that go through a list of cases. Declared last: a merge
// takes no other option but --json.
void AddShards(CLI::App& app, Shard& shard, std::vector<std::string>& merge);
void AddVelocities(CLI::App& app, bool& velocities);
void AddOrigins(CLI::App& app, bool& origins);
void AddPlanOptions(CLI::App& app, SceneOptions& options);
void AddSkips(CLI::App& app, SkipSettings& skip, LodSettings& lod);
// Of LodSettings::budget_us, whose costs are the command's matter; --budget-us.
CLI::Option* AddFurBudget(CLI::App& app, LodSettings& lod);
void AddExecutor(CLI::App& app, ExecutorKind& executor, uint32_t& workers, uint64_t& order_seed);
// Refuses an option that the executor has no use for.
void CheckExecutor(const CLI::App& app, ExecutorKind executor);
void AddTimeAndWeather(CLI::App& app, double& fps, WeatherCourse& weather);
void AddCamera(CLI::App& app, CameraChoice& choice);
void CheckCamera(const CameraChoice& choice);
// Of picture_options.cpp.
void AddPictures(CLI::App& app, PictureArgs& args);
// Refuses what has no effect.
void CompletePictures(const CLI::App& app, const PictureArgs& args);
void AddPaint(CLI::App& app, PaintAmounts& paint);
// The weather that was asked for, if any was.
std::optional<WeatherCourse> WeatherOf(const CLI::App& app, const WeatherCourse& weather);

// Throws when an option was given beside `present`, with which it would be ignored.
void RefuseBeside(const CLI::App& app, const std::string& present,
                  std::initializer_list<const char*> ignored);
// Throws when one was given beside `present` that is none of `allowed`.
void RefuseAllBut(const CLI::App& app, const std::string& present,
                  const std::vector<std::string>& allowed);
// Throws when one was given though it has an effect only where `where` says: "the ppe".
void RefuseUnless(const CLI::App& app, bool has_effect, std::initializer_list<const char*> options,
                  const std::string& where);

// Options that name files. An option says here whether its file is read or written, and all that must hold between the
// files of a command line follows from that: no output is also an input or another output, every output can be written,
// and all of it is known before the work begins.
//
// Breaks if ignored: an output declared in another way cannot be written (output_path.hpp).

CLI::Option* AddInputFile(CLI::App& app, const char* name, std::string& target, const char* help);
CLI::Option* AddInputFile(CLI::App& app, const char* name, std::vector<std::string>& target,
                          const char* help);
// Also the name of something built in (IsBuiltInName).
CLI::Option* AddInputFileOrName(CLI::App& app, const char* name, std::string& target,
                                const char* help);
// `extension`: the only one a file may have; empty: any.
CLI::Option* AddOutputFile(CLI::App& app, const char* name, OutputPath& target, const char* help,
                           std::string_view extension = {});
// Files in it are the command's own to check (CheckOutput).
CLI::Option* AddOutputFolder(CLI::App& app, const char* name, OutputPath& target, const char* help);

// Of the parsed options of `app`. Throws CLI::ParseError for files that do not go together, Error
// for an output that cannot be written.
void CheckFiles(const CLI::App& app);
// The same for files that were found to be read later: the maps of a setup, the buffers of a model.
void CheckFilesRead(const CLI::App& app, std::span<const std::string> read);

}  // namespace pelt
