// What a solver keeps and what it must not depend on: energy, frequency and decay, static shape.
//
// Each is a problem plus a function a solver is plugged into; each has an exact answer that does
// not depend on the frame rate.
#pragma once

#include <vector>

#include "bench/accuracy/reference_integrator.hpp"
#include "bench/accuracy/strand_solver.hpp"

namespace pelt::accuracy {

// ---- Energy ----------------------------------------------------------------------------------

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

// ---- Frequency and decay ---------------------------------------------------------------------

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

// ---- Static shape ----------------------------------------------------------------------------

// Where a clamped strand comes to rest after `seconds`: the tip's distance from its rest place over
// the exact equilibrium's, less 1. `jitter` > 0: each frame's time is 1/frames_per_second times a
// seeded factor in [1 / (1 + jitter), 1 + jitter].
double StaticShapeError(const SolverFactory& factory, const ChainMaterial& material,
                        const Strand& strand, double frames_per_second, double seconds = 8.0,
                        double jitter = 0.0);

}  // namespace pelt::accuracy
