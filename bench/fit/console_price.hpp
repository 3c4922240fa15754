// What a scene's layers cost on a console, in the model (bench/consoles).
#pragma once

#include "bench/consoles/console_budget.hpp"
#include "bench/fit/fit_scene.hpp"

namespace pelt {

FitPlatform OnConsole(const ConsoleRequest& request);

}  // namespace pelt
