// A console's budget as a report tree and as a frame of the report page.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bench/consoles/console_budget.hpp"
#include "bench/report/json_text.hpp"

namespace pelt {

// "fits 5 ms", "fits 8 ms, not 5 ms", "does not fit 8 ms": against the lines of the originals.
std::string DescribeFit(double ms);

// The ends of the range that the frame lies in: "p95 2.10 ms with the best schedules, 4.00 ms as
// written".
std::string DescribeRange(const ConsoleBudget& budget);

// Stages, passes, critical path, bytes by name, local stores, digests.
void AddConsole(const ConsoleBudget& budget, const FurScene& scene, ReportTree& tree);

// The slowest frame with every unit's slices: an element of the page's `consoles`.
void AddConsoleFrame(JsonText& json, const ConsoleBudget& budget, const FurScene& scene);
// In its place, where the scene does not fit the console: with why instead of pictures.
void AddRefusedConsole(JsonText& json, std::string_view name, std::string_view why);

}  // namespace pelt
