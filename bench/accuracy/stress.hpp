// The stress table: problems no solver should come out of with a NaN, a stretched hair or a strand
// that never settles.
//
// Every problem disturbs strands for a while and then leaves them alone. A solver is asked for: any
// value that is not finite, the worst stretch on the way, strands that still move at the end or
// that rest where forces do not balance, and how long the strands took to come back.
//
// Invariant: problems are seeded, so a row can be run again alone.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "bench/accuracy/chain_problem.hpp"
#include "bench/accuracy/strand_solver.hpp"

namespace pelt::accuracy {

struct StressProblem {
  std::string name;
  ChainMaterial material;
  std::vector<Strand> strands;
  std::vector<std::array<Double3, kMaxLinks>> start;
  std::function<BodyPose(double t, size_t strand)> pose;
  bool same_pose;    // for all strands
  double calm_from;  // s: nothing is disturbed from then on
  double seconds;    // of the whole run
  int frames_per_second;
};

struct StressOptions {
  int links = 3;
  int random_starts = 2000;  // over all presets
  uint64_t seed = 1;
  std::vector<int> frame_rates{15, 24, 30, 60, 120, 240};  // of the violent motion
  bool calibrated = false;                                 // also strands as layers have them
};

// All rows: random starts with root jumps (one row a preset, three of short limp strands), a
// teleport of 5 m with half a turn in one frame, the violent motion at every rate, 2 cm of white
// noise on the root, a first mode of 1,000 Hz, stiffness ratio 1e6, mass ratio 1e4 both ways, a
// folded start; with `calibrated`, also strands with the calibrated coefficients of layers let go
// in their rest shape, straight ones too, with and without bending damping.
std::vector<StressProblem> StressProblems(const StressOptions& options);

struct StressResult {
  bool ran = true;             // the solver takes the material
  int non_finite = 0;          // strands with a value that is not finite at any time
  double worst_stretch = 0.0;  // largest |link| / l - 1 of what is drawn, of finite values
  int unsettled = 0;  // strands a point of which moves by more than 1e-4 L/frame at the end
  int stuck = 0;  // settled, but a link is off balance by more than 0.1; methods whose static shape
                  // is not the material's (PBD, follow-the-leader) are so by design
  double worst_off_balance = 0.0;  // at the end: a link's tangential force over its weight and
                                   // stiffness, about the angle it is off by, rad
  double recovery_seconds = 0.0;  // from calm until all strands stay within 1 % L of where they end
};

// What a solver that promises to stay finite, unstretched and to settle broke; empty: nothing.
// A part may be 1e-5 longer than it should be; places 5 m away, as floats, add to that.
inline constexpr double kMostPromisedStretch = 1.5e-4;
std::vector<std::string> BrokenPromises(const StressResult& result);

// `links`: the solver moves the material's links, so that the balance of their forces shows which strands are stuck.
StressResult RunStress(const StressProblem& problem, const SolverFactory& factory,
                       bool links = true);

}  // namespace pelt::accuracy
