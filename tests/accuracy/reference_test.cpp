// The exact motion against values that independent codes agree on, and against itself.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "bench/accuracy/dop853.hpp"
#include "bench/accuracy/reference_integrator.hpp"
#include "bench/accuracy/solver_checks.hpp"

namespace pelt::accuracy {
namespace {

using namespace dop853;

// Those of trees up to order four, one of order five, and of quadrature up to order eight.
TEST(Dop853, CoefficientsMeetTheOrderConditions) {
  for (int power = 0; power < 8; ++power) {
    double sum = 0.0;
    for (int i = 0; i < kStages; ++i) sum += kB[i] * std::pow(kC[i], power);
    EXPECT_NEAR(sum, 1.0 / (power + 1), 3e-15) << "c^" << power;
  }
  double bac = 0.0, bcac = 0.0, bac2 = 0.0, baac = 0.0, bac3 = 0.0;
  for (int i = 0; i < kStages; ++i) {
    double row = 0.0, ac = 0.0, ac2 = 0.0, ac3 = 0.0, aac = 0.0;
    for (int j = 0; j < i; ++j) {
      row += kA[i][j];
      ac += kA[i][j] * kC[j];
      ac2 += kA[i][j] * kC[j] * kC[j];
      ac3 += kA[i][j] * kC[j] * kC[j] * kC[j];
      double inner = 0.0;
      for (int k = 0; k < j; ++k) inner += kA[j][k] * kC[k];
      aac += kA[i][j] * inner;
    }
    EXPECT_NEAR(row, kC[i], 1e-14) << "stage " << i;
    bac += kB[i] * ac;
    bcac += kB[i] * kC[i] * ac;
    bac2 += kB[i] * ac2;
    baac += kB[i] * aac;
    bac3 += kB[i] * ac3;
  }
  EXPECT_NEAR(bac, 1.0 / 6, 1e-14);
  EXPECT_NEAR(bcac, 1.0 / 8, 1e-14);
  EXPECT_NEAR(bac2, 1.0 / 12, 1e-14);
  EXPECT_NEAR(baac, 1.0 / 24, 1e-14);
  EXPECT_NEAR(bac3, 1.0 / 20, 1e-14);
}

// y'' = cos 3t - y^3: nonlinear and driven, so that a wrong coefficient cannot hide; halving the
// step must divide the error by about 2^8.
TEST(Dop853, ErrorFallsWithTheEighthPower) {
  const auto solve = [](int steps) {
    std::array<double, 2> y = {1.0, 0.5};
    const double h = 4.0 / steps;
    for (int i = 0; i < steps; ++i)
      Step<2>(
          [](double t, const std::array<double, 2>& at, std::array<double, 2>& slope) {
            slope = {at[1], -at[0] * at[0] * at[0] + std::cos(3.0 * t)};
          },
          i * h, h, y);
    return y[0];
  };
  const double exact = solve(640);
  const double coarse = std::abs(solve(20) - exact), fine = std::abs(solve(40) - exact);
  EXPECT_GT(std::log2(coarse / fine), 7.3);
  EXPECT_LT(fine, 1e-9);
}

TEST(Motion, DerivativesAreThoseOfThePose) {
  const Double3 q = {0.03, -0.05, 0.08};
  for (const Motion motion : {Motion::kWalk, Motion::kHeadshake, Motion::kDash, Motion::kViolent}) {
    for (double t = 0.35; t < 4.0; t += 0.31) {
      constexpr double kStep = 1e-5;
      const BodyPose before = PoseOf(motion, t - kStep), now = PoseOf(motion, t),
                     after = PoseOf(motion, t + kStep);
      const Double3 rate = (after.Place(q) - before.Place(q)) * (0.5 / kStep);
      const Double3 bend = (after.PlaceRate(q) - before.PlaceRate(q)) * (0.5 / kStep);
      // Central differences are off by a sixth of the third derivative times the step squared.
      EXPECT_LT(Length(rate - now.PlaceRate(q)), 1e-6) << MotionName(motion) << " at " << t;
      EXPECT_LT(Length(bend - now.PlaceBend(q)), 1e-4) << MotionName(motion) << " at " << t;
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(Length(now.axis[k]), 1.0, 1e-14);
    }
  }
  EXPECT_NEAR(
      PoseOf(Motion::kWalk, 3.5).position.x - 0.03 * std::sin(2 * std::numbers::pi * 1.8 * 3.5),
      0.8 * 3.0, 1e-12);
  EXPECT_NEAR(Length(PoseOf(Motion::kWind, 1.3).wind), 4.7, 1.5);
}

TEST(Reference, FixedValuesToTheLastPrintedDigit) {
  for (const FixedProblem& fixed : FixedProblems()) {
    const int tip = fixed.problem.material.links - 1;
    for (const FixedValue& value : fixed.tip) {
      const Double3 x = ReferencePoint(fixed.problem, tip, value.seconds, 1920);
      EXPECT_LT(Length(x - value.position), fixed.digits)
          << fixed.name << " at " << value.seconds << " s";
    }
  }
}

// The check can fail: a stiffness off by a millionth, or a missing centrifugal part, is seen.
TEST(Reference, AMillionthOfStiffnessShows) {
  FixedProblem fixed = FixedProblems()[1];
  fixed.problem.material.stiffness[1] *= 1.000001;
  const Double3 x = ReferencePoint(fixed.problem, 2, 0.2, 1920);
  EXPECT_GT(Length(x - fixed.tip[2].position), 3.0 * fixed.digits);
}

TEST(Reference, KeepsLengthsAndEnergy) {
  ChainProblem problem = PendulumChallenge().problem;
  ReferenceIntegrator integrator(std::span(&problem, 1), 1920);
  const ChainDynamics dynamics(problem.material, problem.strand);
  const double start = dynamics.Energy(StillPose(), integrator.state(0));
  for (int s = 0; s < 2 * 1920; ++s) integrator.Step();
  EXPECT_NEAR(dynamics.Energy(StillPose(), integrator.state(0)), start, 1e-9);
  for (int i = 0; i < 3; ++i) {
    const ChainState& state = integrator.state(0);
    EXPECT_NEAR(Length(state.direction[size_t(i)]), 1.0, 3e-16);
    EXPECT_NEAR(Dot(state.direction[size_t(i)], state.rate[size_t(i)]), 0.0, 1e-13);
  }
}

TEST(Reference, EquilibriumIsWhereAReleaseEnds) {
  for (const int links : {3, 4})
    for (const CurlModel curl : {CurlModel::kRoot, CurlModel::kParent}) {
      ChainProblem problem;
      problem.material = MakeMaterial(kPresets[2], links);
      problem.material.curl = curl;
      problem.material.drag = 40.0;
      problem.strand = SeededStrands(links, 6, 3)[2];
      problem.start = problem.strand.rest;
      ReferenceIntegrator integrator(std::span(&problem, 1), 1920);
      for (int s = 0; s < 3 * 1920; ++s) integrator.Step();
      const auto balance = FindEquilibrium(problem.material, problem.strand);
      for (int i = 0; i < links; ++i)
        EXPECT_LT(Length(integrator.state(0).direction[size_t(i)] - balance[size_t(i)]), 1e-10);
    }
}

// Small motions about a straight rest shape without gravity are the linear modes.
TEST(Reference, SmallMotionsHaveTheModesFrequencyAndDecay) {
  ChainProblem problem;
  problem.material = MakeMaterial(kPresets[1], 4);
  problem.material.gravity = kZero3;
  for (Double3& rest : problem.strand.rest) rest = {1.0, 0.0, 0.0};
  const ChainMatrices x = MatricesOf(problem.material);
  for (int m = 0; m < 4; ++m) {
    for (int i = 0; i < 4; ++i) problem.start[size_t(i)] = Unit({1.0, 1e-5 * x.mode[i][m], 0.0});
    ReferenceIntegrator integrator(std::span(&problem, 1), 1920);
    const double t = 0.125;
    for (int s = 0; s < int(t * 1920); ++s) integrator.Step();
    const double decay =
        0.5 * (problem.material.drag + problem.material.bending_damping * x.omega[m] * x.omega[m]);
    const double w = std::sqrt(x.omega[m] * x.omega[m] - decay * decay);
    const double share = std::exp(-decay * t) * (std::cos(w * t) + decay / w * std::sin(w * t));
    double largest = 0.0;
    for (int i = 0; i < 4; ++i) largest = std::max(largest, std::abs(x.mode[i][m]));
    for (int i = 0; i < 4; ++i)
      EXPECT_NEAR(integrator.state(0).direction[size_t(i)].y, 1e-5 * share * x.mode[i][m],
                  1e-5 * largest * 1e-6)
          << "mode " << m;
  }
}

}  // namespace
}  // namespace pelt::accuracy
