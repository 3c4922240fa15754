// The verdict of one platform on a built-in scene, in two lines: what bench/run.sh says first. A program of its own, so
// that it needs a third of the build of `pelt`.
//   pelt_verdict SCENE host|ps3|xbox360
// Exit code 0: fits 8 ms; 1: does not; 2: no answer, others used the machine, or an error.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <exception>
#include <string>
#include <utility>
#include <vector>

#include "bench/consoles/console_budget.hpp"
#include "bench/report/machine_use.hpp"
#include "bench/report/run_report.hpp"
#include "core/error.hpp"

namespace pelt {
namespace {

constexpr double kTargetMs = 8.0;
constexpr uint32_t kFrames = 60, kWarmUp = 60;
constexpr size_t kDearest = 5;

using StageTimes = std::vector<std::pair<double, std::string_view>>;

int Print(std::string_view platform, double ms, Fit fit, const std::string& what,
          StageTimes stages) {
  double all = 0.0;
  for (const auto& [stage_ms, name] : stages) all += stage_ms;
  std::ranges::sort(stages, std::greater<>());
  stages.resize(std::min(stages.size(), kDearest));
  std::vector<std::string> dearest;
  for (const auto& [stage_ms, name] : stages)
    dearest.push_back(fmt::format("{} {:.0f} %", name, all > 0.0 ? 100.0 * stage_ms / all : 0.0));
  fmt::print("{:<8} {:6.2f} ms  {} {} ms; {}\n", platform, ms, FitName(fit), kTargetMs, what);
  fmt::print("         of its core time {}\n", fmt::join(dearest, ", "));
  return fit == Fit::kUnsure ? 2 : fit == Fit::kDoesNotFit;
}

// Its build has the solvers of one scene (core/kernels/frame_table.cpp).
void ExpectBuilt(const Plan& plan) {
  for (const Stage& stage : plan.stages)
    if (!stage.kernel.run)
      throw Error(fmt::format("{} is left out of this build; `pelt budget` has all kernels",
                              stage.kernel.name));
}

int JudgeHost(Scenario& scenario) {
  RunOptions options;
  options.frames = kFrames;
  options.warm_up = kWarmUp;
  options.digest = false;
  options.skip.lod = true;
  RunningScenario running(scenario, options.scene);
  ExpectBuilt(running.scene().plan());
  const RunReport report = RunFrames(scenario, running, options);
  StageTimes stages;
  for (const StageBudget& stage : report.budget.stages)
    stages.emplace_back(stage.core_ms.median, stage.name);
  const double ms = report.budget.wall_ms.p95;
  const auto disturbances = FindDisturbances(report.use, report.workers);
  return Print("host", ms, JudgeTime(ms, kTargetMs, !disturbances.empty()),
               disturbances.empty() ? fmt::format("{} workers, {}, measured", report.workers,
                                                  IsaName(options.scene.isa))
                                    : disturbances.front(),
               std::move(stages));
}

int JudgeConsole(Scenario& scenario, Console console) {
  ConsoleRequest request{.console = console, .frames = kFrames, .warm_up = kWarmUp};
  request.skip.lod = true;
  ConsoleRun run(scenario, request);
  ExpectBuilt(run.scene().plan());
  const ConsoleBudget budget = run.Run();
  if (budget.differs_at)
    throw Error(fmt::format("frame {} has another digest than the host's", *budget.differs_at));
  if (!budget.faults.empty()) throw Error("local store: " + budget.faults.front());
  StageTimes stages;
  for (size_t s = 0; s < budget.summary.stages.size(); ++s)
    stages.emplace_back(budget.summary.stages[s].core_ms, run.scene().plan().stages[s].kernel.name);
  return Print(ConsoleName(console), budget.VerdictMs(),
               JudgeTime(budget.VerdictMs(), kTargetMs, false),
               fmt::format("{} {}, modelled", budget.machine.units,
                           budget.machine.local_store_bytes ? "SPUs" : "threads"),
               std::move(stages));
}

int Judge(const std::string& scene, std::string_view platform) {
  Scenario scenario = LoadScenario(scene);
  if (platform == "host") return JudgeHost(scenario);
  for (const Console console : kAllConsoles)
    if (platform == ConsoleName(console)) return JudgeConsole(scenario, console);
  throw Error(fmt::format("no platform '{}'; there are host, ps3, xbox360", platform));
}

}  // namespace
}  // namespace pelt

int main(int argc, char** argv) {
  if (argc != 3) return fmt::print(stderr, "usage: pelt_verdict SCENE host|ps3|xbox360\n"), 2;
  try {
    return pelt::Judge(argv[1], argv[2]);
  } catch (const std::exception& error) {
    return fmt::print(stderr, "pelt_verdict {} {}: {}\n", argv[1], argv[2], error.what()), 2;
  }
}
