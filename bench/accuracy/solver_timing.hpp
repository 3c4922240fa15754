// What a solver costs: nanoseconds per strand and frame on one core, for batches as large as a
// character's.
//
// Solvers that are compared are timed in turn: a round runs each of them over the same frames, each
// frame one slice of time, so that what a busy machine does to one solver it does to all.
// The median of a solver's slices counts, and how far their quartiles lie apart says what it is
// worth. (The fastest slice would favour those that run shortly: they find a quiet moment sooner.)
// Only StrandSolver::Step is timed, which reads the frame's rows and the solver's own state;
// in a turn that state comes from the second or third level of cache, as it does in a frame.
#pragma once

#include <span>

#include "bench/accuracy/solver_run.hpp"
#include "bench/accuracy/strand_solver.hpp"

namespace pelt::accuracy {

struct TimingOptions {
  uint32_t strands = 8192;
  int frames = 60;  // one after the other
  int repeats = 5;  // rounds
  int frames_per_second = 60;
  double (*now)() = nullptr;  // s, never backwards; null: std::chrono::steady_clock
};
// Of a table of many solvers.
TimingOptions TableTiming(bool quick);

// What is simulated while the clock runs: a few strands, many times over (what a lane holds does
// not change what it costs).
struct TimedProblem {
  ChainMaterial material;
  std::vector<Strand> strands;
  std::vector<LinkDirections> start;
  BodyMotion motion;
  double begin = 0.0;  // s of the motion
};
// Curled strands in the middle of the headshake, as if the body had come there at once.
TimedProblem HeadshakeProblem(const ChainMaterial& material);

struct SolverTime {
  // Per strand and frame; 0 where the solver cannot run the material.
  double ns = 0.0, low_ns = 0.0, high_ns = 0.0;  // median and quartiles of the slices
  std::vector<double> slices;                    // ns, round after round, frame after frame
  uint64_t digest = 0;                           // of the points after the last frame
};
// The median over the slices of a's time over b's; 0 where one of them did not run.
double TimeRatio(const SolverTime& a, const SolverTime& b);
// Each on a problem of its own; one that they share is the same object.
struct TimedSolver {
  SolverFactory factory;
  const TimedProblem* problem;
};
std::vector<SolverTime> TimeInTurn(std::span<const TimedSolver> solvers,
                                   const TimingOptions& options);
std::vector<SolverTime> TimeInTurn(std::span<const SolverFactory> factories,
                                   const TimedProblem& problem, const TimingOptions& options);

// One solver alone. `digest`, if given: a hash of the points after the last frame.
double NanosecondsPerStrand(const SolverFactory& factory, const ChainMaterial& material,
                            const TimingOptions& options, uint64_t* digest = nullptr);

}  // namespace pelt::accuracy
