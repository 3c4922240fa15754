// The work-precision table: what each solver costs per strand, and which part of the secondary motion
// it gets wrong, on every preset, frame rate and kind of chain.
//
// Errors depend on nothing but the arithmetic, which is the same on every instruction set: their
// digest is compared between machines. Times are this machine's; they are medians of
// slices taken in turn (solver_timing.hpp) at 60 frames per second on the preset's own material, and stated over the
// time of our own PBD with 4 iterations in the same rounds.
//
// Solvers whose stiffness is not the material's (position-based ones, follow-the-leader) are tuned
// on the very cases they are scored on, for each preset and rate anew: the best they could do.
#pragma once

#include <functional>
#include <vector>

#include "bench/accuracy/error_metric.hpp"
#include "bench/accuracy/named_solver.hpp"

namespace pelt::accuracy {

// kDrawn uses the calibrated coefficients of layers, regardless of the options.
enum class Problems : uint8_t { kDrawn, kTuned };

struct WorkPrecisionOptions {
  Problems problems = Problems::kDrawn;
  uint64_t seed = kDrawnSeed;
  std::vector<int> links{3, 4};
  std::vector<int> rates{15, 30, 60, 120};  // frames per second, divisors of kKeptRate
  std::vector<int> shipped_rates{15, 30, 60, 120, 240};
  std::vector<Preset> presets{std::begin(kPresets), std::end(kPresets)};
  Coefficients coefficients = Coefficients::kUniform;
  Isa isa = BestIsa();
  bool quick = false;  // fewer solvers, strands, motions and rounds
  bool timed = true;
  std::function<void(size_t done, size_t total)> progress;
};

// One solver on one preset and kind of chain.
struct WorkPrecisionRow {
  NamedSolver solver;
  double ns = 0.0;                     // per strand and frame, the median of slices; 0: not timed
  double low_ns = 0.0, high_ns = 0.0;  // their quartiles
  double ratio = 0.0;                  // of our own PBD's with 4 iterations
  std::vector<Score> scores;           // [rate]
  std::vector<double> scales;          // [rate], of the stiffness; 0: none came out finite

  bool Finite(size_t rate) const { return scores[rate].finite && scales[rate] > 0.0; }
};

struct WorkPrecisionPanel {
  int links;
  size_t preset;                     // of the options'
  std::vector<double> input_errors;  // [rate]: what is left to the exact solver, 1 = 100 %
  std::vector<WorkPrecisionRow> rows;

  // Nothing as cheap is more exact.
  bool IsParetoOptimal(const WorkPrecisionRow& row, size_t rate) const;
};

// What time steps alone cost the modal solver: on chains of links, at every frame rate, on drawn problems
// (drawn_problem.hpp).

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

struct ShippedPanel {
  int links;
  std::vector<Preset> presets;
  int strands = 0, motions = 0;  // for each preset: strands a motion
  std::vector<ShippedRow> rows;
};

// Rows of quality `fine` first, without and with velocities, then the other qualities.
std::vector<ShippedRow> MeasureShipped(const Suite& suite, const std::vector<int>& rates, Isa isa);

struct WorkPrecision {
  WorkPrecisionOptions options;
  std::vector<ShippedPanel> shipped;       // [links]; of drawn problems alone
  std::vector<WorkPrecisionPanel> panels;  // links after links, preset after preset
  int rounds = 0, timed_strands = 0, timed_frames = 0;
  uint64_t error_digest = 0;    // of the panels: every error, worst distance and stretch
  uint64_t shipped_digest = 0;  // the same of what is shipped
};

WorkPrecision MeasureWorkPrecision(const WorkPrecisionOptions& options);

// The place of the rate nearest 60.
size_t MiddleRate(const std::vector<int>& rates);

}  // namespace pelt::accuracy
