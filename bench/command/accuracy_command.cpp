// `pelt accuracy`: the whole benchmark of error against run time; the same of a scene's frames; the
// features. And what a report shows of it.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "bench/accuracy/report/accuracy_report.hpp"
#include "bench/command/accuracy_args.hpp"
#include "bench/command/commands.hpp"
#include "bench/command/progress.hpp"
#include "core/error.hpp"
#include "core/file_bytes.hpp"

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

}  // namespace

ExitCode MeasureAccuracy(const AccuracyArgs& args) {
  if (!FindKernels(args.isa))
    throw Error(fmt::format("no {} kernels in this program or processor", IsaName(args.isa)));
  if (args.scene) return MeasureScene(args);
  if (args.features) return MeasureAllFeatures(args);
  return MeasureAll(args);
}

std::function<void(JsonText&)> ReadAccuracySection(const std::string& path) {
  const auto add = [bytes = ReadFileBytes("accuracy", path, kAccuracyBytesLimit).OrThrow(),
                    path](JsonText& json) { AddAccuracySection(json, AsText(bytes), path); };
  JsonText tried;
  add(tried);
  return add;
}

}  // namespace pelt
