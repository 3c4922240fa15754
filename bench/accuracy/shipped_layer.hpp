// What time steps alone cost the modal solver: on chains of links, at every frame rate, on drawn problems
// (drawn_problem.hpp).
#pragma once

#include <vector>

#include "bench/accuracy/error_metric.hpp"
#include "bench/accuracy/named_solver.hpp"

namespace pelt::accuracy {

// A layer whose setup says nothing about its material.
inline constexpr std::string_view kDefaultLayer = "default layer";
Preset DefaultLayer(int links);
// Those that are asked for, and the default layer.
std::vector<Preset> ShippedPresets(std::vector<Preset> presets, int links);

// One material, quality and knowledge of the root.
struct ShippedRow {
  size_t preset;  // of the suite's
  NamedSolver solver;
  std::vector<Score> scores;  // [rate]
};

// Rows of quality `fine` first, without and with velocities, then the other qualities.
std::vector<ShippedRow> MeasureShipped(const Suite& suite, const std::vector<int>& rates, Isa isa);

}  // namespace pelt::accuracy
