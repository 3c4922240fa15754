#include "bench/command/modelled_consoles.hpp"

#include <algorithm>

#include "bench/command/commands.hpp"
#include "bench/command/progress.hpp"
#include "bench/consoles/console_report.hpp"
#include "core/error.hpp"

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

}  // namespace pelt
