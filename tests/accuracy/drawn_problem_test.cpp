// Drawn problems: within their bounds, smooth, the same for the same seed, and fair.
#include "bench/accuracy/drawn_problem.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "bench/accuracy/error_metric.hpp"
#include "bench/accuracy/model_error.hpp"
#include "bench/accuracy/work_precision.hpp"

namespace pelt::accuracy {
namespace {

TEST(DrawnMotion, BeginsStillAndStaysWithinItsBounds) {
  for (int index = 0; index < 40; ++index) {
    const BodyMotion motion = DrawMotion(kDrawnSeed, index);
    EXPECT_LT(Length(motion(0.0).velocity), 2e-3) << index;
    double speed = 0.0, spin = 0.0;
    for (int f = 0; f <= 960; ++f) {
      const BodyPose pose = motion(f / 240.0);
      speed = std::max(speed, Length(pose.velocity));
      spin = std::max(spin, Length(SpinOf(pose)));
      EXPECT_NEAR(Dot(pose.axis[0], pose.axis[0]), 1.0, 1e-12);
    }
    EXPECT_GT(speed, 0.02) << index;
    EXPECT_LT(speed, 5.0) << index;
    EXPECT_GT(spin, 0.1) << index;
    EXPECT_LT(spin, 40.0) << index;
  }
}

// The reference needs exact derivatives.
TEST(DrawnMotion, DerivativesAreThoseOfThePoses) {
  constexpr double kStep = 1e-4;
  for (int index = 0; index < 8; ++index) {
    const BodyMotion motion = DrawMotion(7, index);
    for (double t = 0.3; t < 4.0; t += 0.37) {
      const BodyPose a = motion(t - kStep), b = motion(t), c = motion(t + kStep);
      EXPECT_LT(Length((c.position - a.position) * (0.5 / kStep) - b.velocity), 1e-4);
      EXPECT_LT(Length((c.velocity - a.velocity) * (0.5 / kStep) - b.acceleration), 1e-2);
      EXPECT_LT(Length((c.axis[2] - a.axis[2]) * (0.5 / kStep) - b.axis_rate[2]), 1e-4);
    }
  }
}

TEST(DrawnMotion, IsOfItsSeedAlone) {
  const auto place = [](uint64_t seed, int index) {
    return DrawMotion(seed, index)(1.7).Place({0.1, 0.0, 0.0});
  };
  EXPECT_EQ(Length(place(3, 2) - place(3, 2)), 0.0);
  EXPECT_GT(Length(place(3, 2) - place(3, 1)), 1e-3);
  EXPECT_GT(Length(place(3, 2) - place(4, 2)), 1e-3);
}

// Figures of one compiler's program are those of another's.
TEST(DrawnStrands, AreTheSameFromEveryCompiler) {
  const Double3 tip = DrawStrands(4, 1, 5, 0)[0].rest[3];
  EXPECT_NEAR(tip.x, -0.3359491028454124, 1e-12);
  EXPECT_NEAR(tip.y, -0.1110881576364384, 1e-12);
  const Double3 tangent = DrawRodProblem(MotionFamily::kEveryday, 5, 0).rest.TangentAt(1.0);
  EXPECT_NEAR(tangent.x, 0.8553959869467994, 1e-12);
  EXPECT_NEAR(tangent.y, -0.3792785577668916, 1e-12);
}

TEST(DrawnStrands, StandWithinTheirBounds) {
  constexpr double kDegrees = 180.0 / 3.14159265358979323846;
  double least_lean = 90.0, most_lean = 0.0;
  const std::vector<Strand> strands = DrawStrands(4, 200, 5, 0);
  for (const Strand& strand : strands) {
    const double away = Length(strand.root);
    EXPECT_GT(away, 0.049);
    EXPECT_LT(away, 0.151);
    const double lean =
        kDegrees * std::acos(std::min(1.0, Dot(strand.rest[0], strand.root * (1.0 / away))));
    least_lean = std::min(least_lean, lean);
    most_lean = std::max(most_lean, lean);
    for (size_t i = 1; i < 4; ++i) {
      const double bend = kDegrees * std::acos(Dot(strand.rest[i], strand.rest[i - 1]));
      EXPECT_GT(bend, 6.99);
      EXPECT_LT(bend, 22.01);
    }
  }
  EXPECT_LT(least_lean, 10.0);
  EXPECT_GT(most_lean, 60.0);
  EXPECT_LT(most_lean, 70.01);
  // A longer list begins with the shorter one.
  const std::vector<Strand> fewer = DrawStrands(4, 3, 5, 0);
  for (size_t s = 0; s < 3; ++s) EXPECT_EQ(Length(fewer[s].rest[3] - strands[s].rest[3]), 0.0);
}

Suite SmallSuite(uint64_t seed) {
  SuiteOptions options;
  options.strands = 3;
  options.seconds = 2.5;
  options.coefficients = Coefficients::kCalibrated;
  options.presets = ShippedPresets({kPresets[2]}, 3);
  options.drawn = {.seed = seed, .motions = 3};
  return SolveSuite(options);
}

TEST(DrawnSuite, CasesHaveTheirOwnMotionsAndLengths) {
  const Suite suite = SmallSuite(3);
  ASSERT_EQ(suite.cases.size(), 2u * 3u * 3u);
  for (const SuiteCase& c : suite.cases) {
    const double scale = c.problem.material.TotalLength() / suite.options.presets[c.preset].length;
    EXPECT_NEAR(scale, DrawLengthScale(3, int(c.motion)), 1e-12);
    const Double3 root = DrawMotion(3, int(c.motion))(2.0).Place(c.problem.strand.root);
    EXPECT_EQ(Length(c.problem.motion(2.0).Place(c.problem.strand.root) - root), 0.0);
  }
}

TEST(ShippedLayer, RowsAreOfEveryMaterialAndKnowledgeOfTheRoot) {
  const Suite suite = SmallSuite(3);
  const std::vector<ShippedRow> rows = MeasureShipped(suite, {30, 60}, BestIsa());
  ASSERT_EQ(rows.size(), 3u * 2u * 2u);
  for (size_t r = 0; r < rows.size(); ++r) {
    ASSERT_EQ(rows[r].scores.size(), 2u);
    for (const Score& score : rows[r].scores) {
      ASSERT_EQ(size_t(score.cases), score.errors.size());
      EXPECT_GE(score.cases, 7);
      EXPECT_LE(score.Median(), score.WorstCase());
      EXPECT_LE(score.error, score.WorstCase());
      EXPECT_LT(score.error, 0.3);
      EXPECT_LT(score.stretch, 1e-5);
    }
    // Velocities pay at 30 Hz.
    if (!rows[r].solver.velocities) continue;
    EXPECT_LT(rows[r].scores[0].Median(), rows[r - 1].scores[0].Median());
  }
}

TEST(Score, MedianAndWorstAreOfTheCases) {
  Score score;
  EXPECT_EQ(score.Median(), 0.0);
  EXPECT_EQ(score.WorstCase(), 0.0);
  score.errors = {0.3, 0.1, 0.2};
  EXPECT_EQ(score.Median(), 0.2);
  EXPECT_EQ(score.WorstCase(), 0.3);
  score.errors.push_back(0.4);
  EXPECT_EQ(score.Median(), 0.25);
}

}  // namespace
}  // namespace pelt::accuracy
