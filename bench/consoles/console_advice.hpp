// What would make a scene fit a console's milliseconds: fewer strands, moving less data, other
// chunks, or what binds where none of it helps.
//
// Invariant: a figure of strands or of a change (what_if.hpp) is the 95th percentile of a run of
// the model with it, over the frames of the budget: asking for the same run gives the same figure.
#pragma once

#include <string>
#include <vector>

#include "bench/consoles/console_budget.hpp"

namespace pelt {

// A line each; none when it fits.
std::vector<std::string> Advise(ConsoleRun& run, const ConsoleBudget& budget, double target_ms);

}  // namespace pelt
