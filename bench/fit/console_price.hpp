// What a scene's layers cost on a console, in the model (bench/consoles).
#pragma once

#include "bench/consoles/console_budget.hpp"
#include "bench/fit/fit_scene.hpp"

namespace pelt {

FitPlatform OnConsole(const ConsoleRequest& request);

// LodSettings::costs: what the scene's layers take there in the solver and quality that they have, and in `fast`.
FurCosts FurCostsOnConsole(const Scenario& scenario, ConsoleRequest request);

}  // namespace pelt
