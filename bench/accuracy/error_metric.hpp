// The score of a solver: how much of the secondary motion it gets wrong.
//
//     error = RMS(x - exact) / RMS(exact - rigid)
//
// over the points and frames of a case; rigid is the strand carried by the body in the shape it
// hangs still in. 1 is no better than no simulation. The score of a preset is the RMS of its cases'
// errors. Points are compared relative to the root.
//
// Only well-conditioned cases count: the exact motion is solved again from directions moved by
// 1e-7, and the case is scored if no point is ever further off than kMostGrowth times 1e-7 of the
// length. Under drawn motions, which begin at any time, the directions are moved again every quarter
// second, from the exact ones. Beyond that, an error says more about the case than about the solver.
//
// What is left when the solver is exact is the input's: the root is known at frame times only.
// InputError measures it.
#pragma once

#include <optional>
#include <vector>

#include "bench/accuracy/drawn_problem.hpp"
#include "bench/accuracy/reference_integrator.hpp"
#include "bench/accuracy/strand_solver.hpp"

namespace pelt::accuracy {

inline constexpr double kMostGrowth = 2.0;
// Frames a second at which exact motions are kept: every rate that divides it can be scored.
inline constexpr int kKeptRate = 240;

struct SuiteOptions {
  int links = 3;
  int strands = 6;
  uint64_t seed = 1;
  double seconds = kMotionSeconds;
  CurlModel curl = CurlModel::kRoot;
  Coefficients coefficients = Coefficients::kUniform;
  CurlRange degrees;  // of rest curl, a joint
  std::vector<Preset> presets{std::begin(kPresets), std::end(kPresets)};
  std::vector<Motion> motions{Motion::kWalk, Motion::kHeadshake, Motion::kDash, Motion::kWind};
  std::optional<DrawnOptions> drawn;  // motions, strands (so many each) and lengths; not the above
  int rate_scale =
      1;  // reference steps over ReferenceRate's: 2 to see what the reference is good to
};

struct SuiteCase {
  size_t preset;
  size_t motion;  // place in the options' list, or number of the drawn one
  ChainProblem problem;
  double growth;  // of the perturbation
  bool scored;
  std::vector<Double3> exact, rigid;  // relative to the root, [frame * links + point], m
};

struct Suite {
  SuiteOptions options;
  std::vector<SuiteCase> cases;  // preset after preset, motion after motion
};

// Solves every case exactly: about 2 s of one core for the default options.
Suite SolveSuite(const SuiteOptions& options);

// How far the motions of one suite are from those of another with the same cases (another curl
// model), as a solver's error would be counted: over the cases both score.
double SuiteDistance(const Suite& suite, const Suite& other, size_t preset);

struct Score {
  double error = 0.0;    // 1 = 100 %
  double worst = 0.0;    // largest distance of a point from the exact one, over the length
  double stretch = 0.0;  // largest | |link| / l - 1 |
  bool finite = true;
  int cases = 0;               // that counted
  std::vector<double> errors;  // of each of them; `error` is their RMS

  double Median() const;
  double WorstCase() const;
};

// Of the cases of a preset; of one motion, if given.
Score ScoreSolver(const Suite& suite, size_t preset, const SolverFactory& factory,
                  int frames_per_second);
Score ScoreSolver(const Suite& suite, size_t preset, Motion motion, const SolverFactory& factory,
                  int frames_per_second);

// What is known of the root, and so of its way through a frame.
enum class RootCourse : uint8_t {
  kLine = 1,  // a polynomial of this degree through the frame's end and the samples before it
  kQuadratic = 2,
  kCubic = 3,
  kHermite,  // the cubic with the poses and their velocities at both ends of the frame
};

// The error of the exact motion under a root that is only known at frame times.
double InputError(const Suite& suite, size_t preset, int frames_per_second, RootCourse course);

}  // namespace pelt::accuracy
