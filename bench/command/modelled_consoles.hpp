// A scene's frames as the consoles would run them, for the pages that show it.
#pragma once

#include "bench/report/json_text.hpp"
#include "bench/scenarios/scenarios.hpp"

namespace pelt {

// An object of AddConsoleFrame (bench/consoles/console_report.hpp) for each console, into an array: its slowest of at
// most 60 frames. One that cannot run the scene says why.
void AddModelledConsoles(Scenario& scenario, uint32_t frames, const SkipSettings& skip,
                         const LodSettings& lod, JsonText& json);

}  // namespace pelt
