// Problems with one right answer each, and the figures beside the work-precision table: what the solvers that are
// worth comparing on them make of them.
#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "bench/accuracy/named_solver.hpp"
#include "bench/accuracy/strand_solver.hpp"

namespace pelt::accuracy {

// ---- Cantilever ------------------------------------------------------------------------------

// The clamped rod under its own weight, exactly (planar heavy elastica), by shooting; and how far a
// chain's own equilibrium is from it.
//
//     theta'' = -Gamma (1 - s) cos(theta),   theta(0) = clamp angle,   theta'(1) = 0
//
// s: distance along the rod over its length; theta: angle below the horizontal; Gamma = w L^3 / B
// (w: weight per length). This is the cantilever test of Romero et al., "Physical validation of
// simulators in Computer Graphics", SIGGRAPH 2021.

struct Sag {
  double drop;   // H: the tip's height below the clamp over the length
  double reach;  // W: its horizontal distance over the length
};

// `clamp_angle`: of the clamped end below the horizontal, rad, in (-pi/2, pi/2). Relative error
// below 1e-11. The hanging branch: of several equilibria, the one reached from Gamma = 0.
Sag SolveElastica(double gamma, double clamp_angle = 0.0);

// The same of a chain of the material (calibrated or not) with Gamma set by gravity.
Sag SolveChainSag(ChainMaterial material, double gamma, double bending_stiffness, double density,
                  double clamp_angle = 0.0);

// f1 and f2 of a clamped rod, over sqrt(B / (rho L^4)), rad.
inline constexpr double kRodFrequency[3] = {3.5160153, 22.034492, 61.697214};

// How far 3, 4 or 8 calibrated links are from the continuous rod (without a solver), and how far a solver comes to
// rest from its own chain's equilibrium.
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

// ---- Fixed problems --------------------------------------------------------------------------

// Problems with published or agreed reference values: exact positions to nine or ten digits (two
// independent codes), metres and seconds.
//
// The pendulum challenge is Matthias Mueller's (public; 3 free points, 60 Hz). The others are this
// project's: a release from horizontal, a chain without stiffness on a moving root, and a curled
// strand on a shaking head in both curl models.

struct FixedValue {
  double seconds;
  Double3 position;  // of the tip, world
};

struct FixedProblem {
  std::string_view name;
  ChainProblem problem;
  double digits;  // the last digit given, m
  std::vector<FixedValue> tip;
};

FixedProblem PendulumChallenge();
// Pendulum challenge, releases, hanging chain, headshakes.
std::vector<FixedProblem> FixedProblems();

// A solver's tip at time `seconds`, a whole number of frames; NaN where it cannot run the problem.
Double3 SolveFixed(const FixedProblem& fixed, const SolverFactory& factory, int frames_per_second,
                   double seconds);

// The pendulum challenge: distance from the exact third point, and the time for it.
struct PendulumRow {
  NamedSolver solver;
  double miss;   // m, at 1 s
  double ns;     // per strand and frame, in turn with the others
  double ratio;  // of 50-substep XPBD's
};
std::vector<PendulumRow> MeasurePendulum(Isa isa, bool quick);

// ---- Stability -------------------------------------------------------------------------------

// What a solver keeps and what it must not depend on: energy, frequency and decay, static shape. Each is a problem plus
// a function a solver is plugged into; each has an exact answer that does not depend on the frame rate.

// Kinetic, bending and gravity energy of points relative to a root that stands still, J. Stretch
// counts as bending: nothing stores it.
double EnergyOf(const ChainMaterial& material, const Strand& strand, const Double3* points,
                const Double3* velocities);

// The share of its energy above rest that an undamped strand of 6 cm still has some seconds after
// it was let go (mean of the last half second): 1 for the exact motion, below 0 where the solver
// comes to rest below the chain's own equilibrium. Without stiffness (`frequency` 0) it is let go
// straight, 30 degrees from hanging; with a first bending mode of `frequency`, Hz, 20 degrees above
// its horizontal rest shape. NaN where the solver cannot run the material.
double EnergyKept(const SolverFactory& factory, int links, double frequency, int frames_per_second,
                  double seconds = 5.0);

// A mode's small motion, let go at rest, is the same from frame to frame: y(k+2) = sum y(k+1) -
// product y(k), and y(1) = first y(0), with s = (c + beta omega^2)/2, w^2 = omega^2 - s^2,
//
//     sum = 2 exp(-s h) cos(w h), product = exp(-2 s h), first = exp(-s h) (cos(w h) + s/w sin(w
//     h))
//
// (cosh and sinh where overdamped). Compared so, a mode faster than the frames is measured as well
// as a slow one.
struct ModeResponse {
  double omega;  // rad/s
  double exact_first, exact_sum, exact_product;
  double first, sum, product;  // of the solver; sum and product by least squares
  bool gone;                   // died away within two frames: sum and product are unknown
};
// Without gravity; `amplitude` in rad.
std::vector<ModeResponse> MeasureModes(const SolverFactory& factory, const ChainMaterial& material,
                                       double frame_seconds, double amplitude = 1e-3);
// Frequency (1/s) and decay (rad/s) of a measured mode, where they can be found from `sum` and
// `product` (w h < pi).
struct ModeRate {
  double frequency, decay;
};
ModeRate RateOf(double sum, double product, double frame_seconds);

// Where a clamped strand comes to rest after `seconds`: the tip's distance from its rest place over
// the exact equilibrium's, less 1. `jitter` > 0: each frame's time is 1/frames_per_second times a
// seeded factor in [1 / (1 + jitter), 1 + jitter].
double StaticShapeError(const SolverFactory& factory, const ChainMaterial& material,
                        const Strand& strand, double frames_per_second, double seconds = 8.0,
                        double jitter = 0.0);

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
