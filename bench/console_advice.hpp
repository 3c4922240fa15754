// What would make a scene fit a console's milliseconds: fewer strands (found by running the model
// with less), other chunks, or what binds where none of it helps.
#pragma once

#include <string>
#include <vector>

#include "bench/console_budget.hpp"

namespace pelt {

// A line each; none when it fits.
std::vector<std::string> Advise(ConsoleRun& run, const ConsoleBudget& budget, double target_ms);

}  // namespace pelt
