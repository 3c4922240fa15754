// Problems with published or agreed reference values: exact positions to nine or ten digits (two
// independent codes), metres and seconds.
//
// The pendulum challenge is Matthias Mueller's (public; 3 free points, 60 Hz). The others are this
// project's: a release from horizontal, a chain without stiffness on a moving root, and a curled
// strand on a shaking head in both curl models.
#pragma once

#include <string_view>
#include <vector>

#include "bench/accuracy/reference_integrator.hpp"
#include "bench/accuracy/strand_solver.hpp"

namespace pelt::accuracy {

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

}  // namespace pelt::accuracy
