// What would make a scene fit a console's milliseconds: fewer strands, other chunks, or what binds
// where none of it helps.
//
// Invariant: a figure of strands is the 95th percentile of a run of the model with them, over the
// frames of the budget: asking for the same run gives the same figure.
#pragma once

#include <string>
#include <vector>

#include "bench/consoles/console_budget.hpp"

namespace pelt {

// A line each; none when it fits.
std::vector<std::string> Advise(ConsoleRun& run, const ConsoleBudget& budget, double target_ms);

}  // namespace pelt
