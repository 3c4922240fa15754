// The yardstick itself: the reference converges, the score sees what it should, and the input's own
// error is as published.
#include "bench/accuracy/error_metric.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "bench/accuracy/comparison/comparison.hpp"
#include "tests/accuracy/suite.hpp"

namespace pelt::accuracy {
namespace {

// Half the step moves no point by 1e-10 of the length: the two seconds that hold the start, the
// shake and the whip of a dash, stiffest and softest preset, both link counts.
TEST(Suite, ReferenceConverges) {
  for (const int links : {3, 4}) {
    SuiteOptions options;
    options.links = links;
    options.strands = 2;
    options.seconds = 2.0;
    options.presets = {kPresets[0], kPresets[3]};
    options.motions = {Motion::kHeadshake, Motion::kDash};
    const Suite coarse = SolveSuite(options);
    options.rate_scale = 2;
    const Suite fine = SolveSuite(options);
    for (size_t c = 0; c < coarse.cases.size(); ++c) {
      const SuiteCase& a = coarse.cases[c];
      if (!a.scored) continue;
      double worst = 0.0;
      for (size_t i = 0; i < a.exact.size(); ++i)
        worst = std::max(worst, Length(a.exact[i] - fine.cases[c].exact[i]));
      EXPECT_LT(worst / a.problem.material.TotalLength(), 1e-10)
          << kPresets[a.preset].name << " " << MotionName(options.motions[a.motion]) << ", "
          << links << " links";
    }
  }
}

TEST(Suite, FewCasesAreIllConditioned) {
  const Suite& suite = SharedSuite();
  ASSERT_EQ(suite.cases.size(), 4u * 4u * 6u);
  size_t scored = 0;
  for (const SuiteCase& c : suite.cases) scored += c.scored;
  EXPECT_GE(scored, 90u);
}

TEST(Suite, StrandsAreCurledAsAsked) {
  for (const Strand& strand : SeededStrands(4, 40, 9)) {
    EXPECT_NEAR(Length(strand.root), 0.1, 1e-15);
    for (int i = 1; i < 4; ++i) {
      const double degrees = std::acos(Dot(strand.rest[size_t(i)], strand.rest[size_t(i) - 1])) *
                             180.0 / 3.14159265358979323846;
      EXPECT_GT(degrees, 6.99);
      EXPECT_LT(degrees, 22.01);
    }
  }
}

// A solver that does nothing but carry its rest shape: the rigid strand of the metric would
// score 1.
class Rigid final : public StrandSolver {
 public:
  explicit Rigid(const SolverSetup& setup) : material_(setup.material) {}
  void Start(const FrameRows& frame, const float* const (*)[3]) override { frame_ = &frame; }
  void Step(const FrameRows& frame) override { frame_ = &frame; }
  void SetFrameTime(double) override {}
  void Points(int i, float* const (&rows)[3]) const override {
    for (uint32_t lane = 0; lane < frame_->lanes; ++lane)
      for (int k = 0; k < 3; ++k) {
        double sum = 0.0;
        for (int link = 0; link <= i; ++link)
          sum += material_.length[link] * double(frame_->rest[link][k][lane]);
        rows[k][lane] = float(sum);
      }
  }
  void Velocities(int, float* const (&rows)[3]) const override {
    for (int k = 0; k < 3; ++k) std::fill(rows[k], rows[k] + frame_->lanes, 0.0f);
  }

 private:
  ChainMaterial material_;
  const FrameRows* frame_ = nullptr;
};

TEST(Score, ASolverThatOnlyCarriesTheStrandIsNoBetterThanNone) {
  // Stiff hair hangs nearly in its rest shape.
  const Score score = ScoreSolver(
      SharedSuite(), 3, [](const SolverSetup& setup) { return std::make_unique<Rigid>(setup); },
      60);
  EXPECT_EQ(score.cases, 24);
  EXPECT_GT(score.error, 0.95);
  EXPECT_LT(score.stretch, 1e-6);
  EXPECT_TRUE(score.finite);
}

TEST(Score, ASolverThatCannotRunCountsNoCases) {
  const Score score = ScoreSolver(
      SharedSuite(), 3, [](const SolverSetup&) { return std::unique_ptr<StrandSolver>(); }, 60);
  EXPECT_EQ(score.cases, 0);
}

// Curl carried by the root frame or by the parent link: published are 5 to 35 % of the secondary
// motion at 10 to 30 degrees per joint, of other strands and motions; with a curl that also turns out
// of its plane it is more. (That both models are right to nine digits: FixedValues.)
TEST(Suite, CurlModelsDifferMoreWithMoreCurl) {
  double last = 0.03;
  for (const double degrees : {10.0, 20.0, 30.0}) {
    SuiteOptions options;
    options.strands = 3;
    options.seconds = 2.0;
    options.presets = {kPresets[2]};
    options.motions = {Motion::kHeadshake};
    options.degrees = {degrees, degrees};
    options.curl = CurlModel::kParent;
    const Suite parent = SolveSuite(options);
    options.curl = CurlModel::kRoot;
    const double distance = SuiteDistance(parent, SolveSuite(options), 0);
    std::printf("curl of %.0f degrees: the models differ by %.1f %%\n", degrees, 100.0 * distance);
    EXPECT_GT(distance, last);
    EXPECT_LT(distance, 0.6);
    last = distance;
  }
}

// Soft hair that curls by 30 degrees turns right round and model F loses its way: such a case must
// not be scored, regardless of the result.
TEST(Suite, AMotionThatIsNotFiniteIsNotScored) {
  SuiteOptions options;
  options.presets = {kPresets[0]};
  options.motions = {Motion::kDash, Motion::kWalk};
  options.degrees = {30.0, 30.0};
  options.curl = CurlModel::kParent;
  int dropped = 0;
  for (const SuiteCase& c : SolveSuite(options).cases) {
    bool finite = true;
    for (const Double3& point : c.exact) finite = finite && IsFinite(point);
    EXPECT_TRUE(finite || !c.scored);
    dropped += !c.scored;
  }
  EXPECT_GT(dropped, 0);
}

TEST(InputError, IsAsPublished) {
  const Suite& suite = SharedSuite();
  // Per cent at 60 Hz: cubic 0.1-0.5, straight lines 1.5-8 (ours span a little more: other
  // strands).
  double low_cubic = 1e9, high_cubic = 0.0, low_line = 1e9, high_line = 0.0;
  for (size_t preset = 0; preset < 4; ++preset) {
    const double cubic = 100.0 * InputError(suite, preset, 60, RootCourse::kCubic);
    const double line = 100.0 * InputError(suite, preset, 60, RootCourse::kLine);
    std::printf("input error at 60 Hz, %s: cubic %.3f %%, straight %.2f %%\n",
                kPresets[preset].name.data(), cubic, line);
    low_cubic = std::min(low_cubic, cubic);
    high_cubic = std::max(high_cubic, cubic);
    low_line = std::min(low_line, line);
    high_line = std::max(high_line, line);
  }
  EXPECT_NEAR(low_cubic, 0.1, 0.03);
  EXPECT_NEAR(high_cubic, 0.5, 0.1);
  EXPECT_NEAR(low_line, 1.5, 0.5);
  EXPECT_NEAR(high_line, 8.0, 2.5);
}

// Velocities with the poses: per cent, causal cubic and Hermite, at 15, 30 and 60 Hz. Of stiff
// chains published are 118 to 5.9, 9.2 to 0.63 and 0.64 to 0.04. Under wind alone the root stands
// still: what is left there is the wind's.
TEST(InputError, VelocitiesLeaveASmallPartOfIt) {
  static constexpr int kRates[] = {15, 30, 60};
  static constexpr double kMostStiff[] = {10.0, 0.8, 0.05};
  for (const Coefficients coefficients : {Coefficients::kUniform, Coefficients::kCalibrated}) {
    SuiteOptions options;
    options.coefficients = coefficients;
    options.motions = {Motion::kWalk, Motion::kHeadshake, Motion::kDash};
    const Suite suite = SolveSuite(options);
    for (size_t preset = 0; preset < 4; ++preset) {
      std::printf("input error, %s masses, %s:",
                  coefficients == Coefficients::kUniform ? "even" : "calibrated",
                  kPresets[preset].name.data());
      for (size_t r = 0; r < 3; ++r) {
        const double cubic = 100.0 * InputError(suite, preset, kRates[r], RootCourse::kCubic);
        const double hermite = 100.0 * InputError(suite, preset, kRates[r], RootCourse::kHermite);
        std::printf(" %d Hz %.3g -> %.3g %%", kRates[r], cubic, hermite);
        EXPECT_LT(hermite, (r == 0 ? 0.5 : 0.15) * cubic);
        if (preset == 3) {
          EXPECT_LT(hermite, kMostStiff[r]);
        }
      }
      std::printf("\n");
    }
  }
}

}  // namespace
}  // namespace pelt::accuracy
