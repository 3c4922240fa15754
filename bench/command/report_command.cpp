#include <fmt/format.h>

#include <algorithm>

#include "bench/command/commands.hpp"
#include "bench/command/progress.hpp"
#include "bench/consoles/console_report.hpp"
#include "bench/report/report_page.hpp"
#include "core/error.hpp"
#include "jobs/tick_clock.hpp"

namespace pelt {
namespace {

// A console's picture shows one frame; more frames than this only look for a slower one.
constexpr uint32_t kConsoleFrames = 60;

void AddModelledConsole(Console console, Scenario& scenario, ConsoleRequest request,
                        JsonText& json) {
  request.console = console;
  Progress progress(ConsoleName(console), request.frames);
  request.progress = [&](uint32_t done, uint32_t) { progress.Show(done); };
  try {
    ConsoleRun run(scenario, request);
    const ConsoleBudget budget = run.Run();
    AddConsoleFrame(json, budget, run.scene());
  } catch (const Error& error) {  // a page without that console is better than none
    AddRefusedConsole(json, MakeConsole(request).name, error.what());
  }
}

}  // namespace

void AddModelledConsoles(Scenario& scenario, uint32_t frames, const SkipSettings& skip,
                         const LodSettings& lod, JsonText& json) {
  for (const Console console : kAllConsoles)
    AddModelledConsole(console, scenario,
                       {.frames = std::min(frames, kConsoleFrames),
                        .warm_up = BudgetArgs{}.warm_up,
                        .skip = skip,
                        .lod = lod},
                       json);
}

ExitCode Report(const ReportArgs& args) {
  CheckRecords(args.run.options.executor);
  // Read first: a mistake in it should not be reported only after a long run.
  std::function<void(JsonText&)> add_accuracy;
  if (!args.accuracy.empty()) add_accuracy = ReadAccuracySection(args.accuracy);
  Scenario scenario = LoadForRun(args.run, stdout);
  RunOptions options = args.run.options;
  RunningScenario running(scenario, options.scene);
  ReportRecorder recorder(running.scene());
  options.observed_as = Recording::kAll;
  options.observe = [&](const FinishedFrame& frame) { recorder.Add(frame); };
  const TickScale tick_scale;
  RunReport report;
  {
    Progress progress("run", options.frames ? options.frames : scenario.default_frames);
    options.progress = [&](uint32_t done, uint32_t) { progress.Show(done); };
    report = RunFrames(scenario, running, options);
  }
  const auto add_consoles = [&](JsonText& json) {
    if (!args.consoles) return;
    AddModelledConsoles(scenario, options.frames ? options.frames : scenario.default_frames,
                        options.skip, options.lod, json);
  };
  WriteOutput("report", args.out,
              recorder.Page(report, tick_scale.NsPerTick(), add_consoles, add_accuracy));
  fmt::print("report of {} frames {}\n", report.frames, args.out.path());
  return kDone;
}

}  // namespace pelt
