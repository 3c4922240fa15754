// `pelt accuracy`: the whole benchmark of error against run time; the same of a scene's frames; the
// features; or one strand under a recorded root.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "bench/accuracy/recorded_run.hpp"
#include "bench/accuracy/report/accuracy_features.hpp"
#include "bench/accuracy/report/accuracy_report.hpp"
#include "bench/accuracy/report/accuracy_scene.hpp"
#include "bench/command/commands.hpp"
#include "bench/command/progress.hpp"
#include "core/error.hpp"
#include "core/groom/nearest_word.hpp"

namespace pelt {

using namespace accuracy;

namespace {

WorkPrecisionOptions OptionsOf(const AccuracyArgs& args) {
  WorkPrecisionOptions options;
  options.isa = args.isa;
  options.quick = args.quick;
  options.seed = args.seed;
  if (args.tuned) options.problems = Problems::kTuned;
  if (args.calibrated) options.coefficients = Coefficients::kCalibrated;
  if (args.quick) {
    options.rates = {60};
    options.shipped_rates = {30, 60};
    options.links = {3};
  }
  if (!args.rates.empty()) options.rates = options.shipped_rates = args.rates;
  if (!args.links.empty()) options.links = args.links;
  if (!args.presets.empty()) {
    options.presets.clear();
    for (const Preset& preset : kPresets)
      if (std::count(args.presets.begin(), args.presets.end(), preset.name))
        options.presets.push_back(preset);
  }
  for (auto* values : {&options.rates, &options.shipped_rates, &options.links}) {
    std::sort(values->begin(), values->end());
    values->erase(std::unique(values->begin(), values->end()), values->end());
  }
  return options;
}

ModelErrorOptions ModelOptionsOf(const WorkPrecisionOptions& options) {
  ModelErrorOptions model;
  model.presets = options.presets;
  model.seed = options.seed;
  model.isa = options.isa;
  model.timing = TableTiming(options.quick);
  if (options.quick) {
    model.families = {MotionFamily::kEveryday};
    model.problems = 1;
    model.seconds = 1.5;
  }
  return model;
}

std::function<void(size_t, size_t)> ShowOn(std::optional<Progress>& shown) {
  return [&shown](size_t done, size_t total) {
    if (!shown) shown.emplace("accuracy", total);
    shown->Show(done);
  };
}

void PrintTree(const AccuracyArgs& args, const ReportTree& tree) {
  tree.Print(false);
  if (args.json.empty()) return;
  WriteOutput("accuracy", args.json, tree.Json());
  fmt::print("json {}\n", args.json.path());
}

Scenario SceneOf(const AccuracyArgs& args) {
  RunArgs run;
  run.request = *args.scene;
  return LoadForRun(run, stdout);
}

ExitCode MeasureScene(const AccuracyArgs& args) {
  const auto begin = std::chrono::steady_clock::now();
  ScenePrecisionOptions options;
  options.frames = args.frames;
  options.isa = args.isa;
  options.quick = args.quick;
  options.contact = args.contact;
  options.planned = !args.scene->plan.empty();
  SceneReport report;
  {
    std::optional<Progress> shown;
    options.progress = ShowOn(shown);
    report.table = MeasureScenePrecision(SceneOf(args), options);
  }
  report.machine = DescribeMachine();
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  PrintTree(args, MakeSceneTree(report));
  return kDone;
}

ExitCode MeasureAllFeatures(const AccuracyArgs& args) {
  FeatureReport report = MeasureFeatureReport(args.isa, args.links, args.quick);
  report.machine = DescribeMachine();
  PrintTree(args, MakeFeatureTree(report));
  return kDone;
}

ExitCode MeasureAll(const AccuracyArgs& args) {
  AccuracyReport report;
  const auto begin = std::chrono::steady_clock::now();
  WorkPrecisionOptions options = OptionsOf(args);
  {
    std::optional<Progress> shown;
    options.progress = ShowOn(shown);
    report.table = MeasureWorkPrecision(options);
    report.table.options.progress = {};
  }
  report.cantilever = MeasureCantilever(args.isa);
  report.model_options = ModelOptionsOf(options);
  report.model_error = MeasureModelError(report.model_options);
  report.pendulum = MeasurePendulum(args.isa, args.quick);
  report.stability = MeasureStability(args.isa, args.quick);
  report.machine = DescribeMachine();
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  PrintTree(args, MakeAccuracyTree(report));
  return kDone;
}

NamedSolver SolverOf(const AccuracyArgs& args) {
  std::optional<NamedSolver> solver = FindSolver(args.solver);
  if (!solver)
    throw Error(fmt::format("--solver {}: no such solver; there are {}{}", args.solver,
                            SolverNames(), DidYouMean(args.solver, SolverStems())));
  solver->method.stiffness_scale = solver->core.stiffness_scale = args.stiffness_scale;
  return *std::move(solver);
}

ExitCode RunRecorded(const AccuracyArgs& args) {
  const std::vector<RootSample> samples = ReadRootsFile(args.roots);
  const StrandFile strand = ReadStrandFile(args.strand);
  NamedSolver solver = SolverOf(args);
  const int links = strand.material.links;
  if (!args.exact && !(strand.rod ? RunsParts(solver, links) : links <= kMostLinks))
    throw Error(fmt::format("--solver {} with {}: {}", solver.name, args.strand,
                            WhyNotLinks(solver, links)));
  solver.velocities = samples[0].rated && solver.family == Family::kModal;
  const PointTrack exact = RunExact(strand, samples);
  const PointTrack track = args.exact ? exact : RunSolver(strand, samples, solver, args.isa);
  if (track.links == 0)
    throw Error(fmt::format("{}: {} does not run such a strand", args.strand, solver.label));
  WriteOutput("points", args.out, PointsText(track));
  fmt::print("{} frames in {:.4g} s, {} links, {} points per frame: {}\n", samples.size() - 1,
             samples.back().seconds - samples.front().seconds, track.links, track.links + 1,
             args.out.path());
  if (args.exact) {
    fmt::print("the {}'s exact motion, the root between samples by {}\n",
               strand.rod ? "rod" : "chain",
               samples[0].rated ? "their velocities" : "cubic splines");
    return kDone;
  }
  const TrackError error = CompareTracks(samples, track, exact);
  fmt::print("{}{} ({} kernels): ", solver.label, solver.velocities ? ", with velocities" : "",
             IsaName(args.isa));
  if (!std::isfinite(error.share) && std::isfinite(error.worst))
    fmt::print("no secondary motion to compare\n");
  else
    fmt::print("{:.2f} % of the secondary motion differs from the {}'s, by {:.3g} mm at most\n",
               100.0 * error.share, strand.rod ? "rod" : "chain", 1e3 * error.worst);
  return kDone;
}

ExitCode WriteExample(const OutputPath& folder) {
  MakeFolder(folder);
  const std::pair<OutputPath, std::string> files[] = {
      {folder.Inside("roots.csv"), RootsText(ExampleRoots())},
      {folder.Inside("strand.toml"), ExampleStrand()}};
  for (const auto& [path, text] : files) CheckOutput("example", path);
  for (const auto& [path, text] : files) {
    WriteOutput("example", path, text);
    fmt::print("{}\n", path.path());
  }
  return kDone;
}

}  // namespace

ExitCode MeasureAccuracy(const AccuracyArgs& args) {
  if (!FindKernels(args.isa))
    throw Error(fmt::format("no {} kernels in this program or processor", IsaName(args.isa)));
  if (!args.write_example.empty()) return WriteExample(args.write_example);
  if (args.scene) return MeasureScene(args);
  if (args.features) return MeasureAllFeatures(args);
  return args.roots.empty() ? MeasureAll(args) : RunRecorded(args);
}

}  // namespace pelt
