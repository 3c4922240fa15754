// The figures beside the work-precision table: problems with one right answer each, for the solvers
// that are worth comparing on them.
//
//  - cantilever: how far 3, 4 or 8 calibrated links are from the continuous rod (without a solver),
//    and how far a solver comes to rest from its own chain's equilibrium;
//  - the pendulum challenge: distance from the exact third point at 1 s, and the time for it;
//  - energy kept by an undamped strand; static shape over frame rates; frequency and decay of small
//    motion.
#pragma once

#include <array>
#include <vector>

#include "bench/accuracy/named_solver.hpp"

namespace pelt::accuracy {

struct CantileverRow {
  int links;
  double sag_error;        // largest | (H/W) / exact - 1 | for Gamma up to kMostGamma
  double worst_gamma;      // where
  double naive_sag_error;  // of equal masses and springs, for comparison
  double frequency[2];     // f1, f2 over the rod's
  // Tip of a layer's strand of as many parts, at rest, from the rod's, over the length, [quality].
  double strand_miss[3];
};
inline constexpr double kMostGamma = 30.0;
std::vector<CantileverRow> MeasureCantilever(Isa isa);

struct PendulumRow {
  NamedSolver solver;
  double miss;   // m, at 1 s
  double ns;     // per strand and frame, in turn with the others
  double ratio;  // of 50-substep XPBD's
};
std::vector<PendulumRow> MeasurePendulum(Isa isa, bool quick);

inline constexpr double kEnergyFrequencies[3] = {0.0, 2.0, 5.0};  // Hz; 0: a free chain
inline constexpr std::array<int, 5> kStaticRates = {15, 30, 60, 120, 240};
// The medium preset, 3 links.
struct StabilityRow {
  NamedSolver solver;
  double energy[3];                     // share kept after 5 s
  double shape[kStaticRates.size()];    // StaticShapeError at each rate
  double mixed_shape;                   // frame times from 1/240 to 1/15 s at random
  double frequency_error, decay_error;  // of the first mode at 60 frames per second, relative
  double worst_mode;                    // of any mode's recurrence at 15, 60 and 240
};
std::vector<StabilityRow> MeasureStability(Isa isa, bool quick);

}  // namespace pelt::accuracy
