// What solvers and whole scenes survive: the tables of `pelt stress`.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "bench/accuracy/chain_problem.hpp"
#include "bench/accuracy/strand_solver.hpp"
#include "core/isa.hpp"

namespace pelt::accuracy {

// ---- Solvers ---------------------------------------------------------------------------------

// The stress table: problems no solver should come out of with a NaN, a stretched hair or a strand
// that never settles.
//
// Every problem disturbs strands for a while and then leaves them alone. A solver is asked for: any
// value that is not finite, the worst stretch on the way, strands that still move at the end or
// that rest where forces do not balance, and how long the strands took to come back.
//
// Invariant: problems are seeded, so a row can be run again alone.

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

// ---- Scenes ----------------------------------------------------------------------------------

// Hitches, characters of any size and size that changes, places far from the world's origin, obstacles that go through
// the fur. Defined in pelt_scene_precision, which has scenes.
//
// Every row runs the scene `tiny` with the modal solver beside the same scene as it should have
// been (the hitch stepped through at 60 Hz, the character at home, or grown from the start), lets
// both come to rest, and says how far apart they were.
//
// Invariant: rows are deterministic; bounds are checked, not fitted (BrokenPromises).

struct SceneStressResult {
  std::string name;
  uint64_t strands = 0;
  uint64_t non_finite = 0;     // values of points, over all frames
  double worst_stretch = 0.0;  // of a link over its length, less 1
  uint64_t unsettled = 0;  // strands that move by over 1e-4 of their length per frame at the end
  // From the scene as it should have been, RMS over all points of the half second from the
  // disturbance on, shares of the strands' lengths; of strands that lie on their groom likewise.
  std::optional<double> apart, rigid_apart;
  // When both have come to rest, what 99 % of the points are within: some strands stand on edges, and
  // fall either way.
  std::optional<double> apart_at_end;
  // What is promised; none: shown for comparison.
  std::optional<double> most_apart, most_at_end;
  bool promised = true;
  friend bool operator==(const SceneStressResult&, const SceneStressResult&) = default;
};

// Empty: nothing is.
std::vector<std::string> BrokenPromises(const SceneStressResult& result);
inline constexpr double kMostSceneStretch = 1e-4;  // points are floats a metre from their origin
// Of a scene's strands, five seconds after it came to rest: a few of its longest swing on, of tiny as
// it is 3.
inline constexpr double kMostUnsettled = 0.03;

std::vector<SceneStressResult> RunSceneStress(Isa isa);

}  // namespace pelt::accuracy
