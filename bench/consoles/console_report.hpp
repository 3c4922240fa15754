// What is said of the consoles' models: a budget as a report tree and as a frame of the report page, a modelled frame
// as a timeline for viewers, and the measured kernels beside the ranges of their prices.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "bench/consoles/console_budget.hpp"
#include "bench/report/json_text.hpp"
#include "jobs/scene.hpp"
#include "platform_sim/kernel_rows.hpp"
#include "traces/chrome_trace.hpp"

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

// A modelled frame as a timeline for viewers: a track for the frame and its passes, and three for
// each unit: what it does, and its transfers in and out.
//
// Invariant: times are the console's own, from the frame's begin. What runs on the host meanwhile
// does not appear.

// "SPU 3", or "core 1 thread 0".
std::string UnitName(const ConsoleMachine& machine, uint32_t unit);

// Adds the tracks of a frame of `scene` that was run with its timelines kept. Tracks bear the
// machine's name, so that two consoles stand side by side in one trace.
void AddConsoleTracks(const FurScene& scene, const ConsoleMachine& machine,
                      const ModelledFrame& frame, Timeline& timeline);

// The measured kernels beside the ranges of their prices.
void AddKernelRows(std::span<const KernelRow> rows, ReportTree& tree);
// Whether every measurement lies in the range of its price.
bool AllPass(std::span<const KernelRow> rows);
// "0.60 of the way from the best schedule to the order as written (a compiler's kernels: 0.28 to 0.92)"
std::string DescribePlace(double code_order);

}  // namespace pelt
