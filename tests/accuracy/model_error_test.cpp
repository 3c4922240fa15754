// Models of a hair against the rod: the rod is one, its error falls with what a model can bend, and a layer's
// links are as far off by the solver as exactly.
#include "bench/accuracy/model_error.hpp"

#include <gtest/gtest.h>

#include "bench/accuracy/elastica.hpp"
#include "bench/accuracy/quantile.hpp"

namespace pelt::accuracy {
namespace {

// Lengths, frequencies and weights of every kind of strand.
constexpr MotionFamily kFamily = MotionFamily::kEveryday;
constexpr double kSeconds = 1.5;

using Track = std::vector<UnknownVectors>;

Track MoveExactly(const CurveStrand& strand, const Preset& preset, const RodProblem& problem,
                  int steps_per_second) {
  const CurveDynamics dynamics(strand, preset, problem.rest);
  CurveMotion motion(dynamics, problem.motion(0.0), 1.0 / steps_per_second);
  Track track;
  for (int step = 1; step <= int(kSeconds * steps_per_second); ++step) {
    motion.Step(problem.motion(double(step) / steps_per_second));
    if (step % (steps_per_second / 60) == 0) track.push_back(motion.directions());
  }
  return track;
}

// The same equation by a method that shares nothing with the step.
Track MoveByRungeKutta(const CurveStrand& strand, const Preset& preset, const RodProblem& problem,
                       int steps_per_second) {
  const CurveDynamics dynamics(strand, preset, problem.rest);
  const size_t n = dynamics.count();
  static constexpr double kAt[4] = {0.0, 0.5, 0.5, 1.0}, kShare[4] = {1.0, 2.0, 2.0, 1.0};
  const double h = 1.0 / steps_per_second;
  UnknownVectors d = dynamics.Equilibrium(problem.motion(0.0)), v{};
  Track track;
  for (int step = 0; step < int(kSeconds * steps_per_second); ++step) {
    UnknownVectors to = d, to_v = v, at = d, at_v = v, a{};
    for (int stage = 0; stage < 4; ++stage) {
      dynamics.Accelerate(problem.motion((step + kAt[stage]) * h), at, at_v, a);
      const double next = stage < 3 ? kAt[stage + 1] * h : 0.0, share = kShare[stage] * h / 6.0;
      for (size_t i = 0; i < n; ++i) {
        const Double3 speed = at_v[i];
        to[i] = to[i] + speed * share;
        to_v[i] = to_v[i] + a[i] * share;
        at[i] = d[i] + speed * next;
        at_v[i] = v[i] + a[i] * next;
      }
    }
    for (size_t i = 0; i < n; ++i) {
      d[i] = Unit(to[i]);
      v[i] = to_v[i] - d[i] * Dot(d[i], to_v[i]);
    }
    if ((step + 1) % (steps_per_second / 60) == 0) track.push_back(d);
  }
  return track;
}

double MostApart(const Track& a, const Track& b, size_t n) {
  double most = 0.0;
  for (size_t frame = 0; frame < a.size(); ++frame)
    for (size_t i = 0; i < n; ++i) most = std::max(most, Length(a[frame][i] - b[frame][i]));
  return most;
}

TEST(CurveMotion, IsThatOfARungeKuttaMethod) {
  for (const CurveStrand& strand : {NodesOfStrand("3 nodes", kThreeNodes), LinksOfStrand(3)})
    for (const Preset& preset : kPresets) {
      const RodProblem problem = DrawRodProblem(kFamily, 5, 1);
      const double apart =
          MostApart(MoveExactly(strand, preset, problem, 60 * 64),
                    MoveByRungeKutta(strand, preset, problem, 60 * 96), size_t(strand.count));
      EXPECT_LT(apart, 5e-4) << strand.name << ", " << preset.name;
    }
}

TEST(CurveMotion, HalfStepsChangeLittle) {
  const CurveStrand rod = RodOfStrand();
  for (const Preset& preset : kPresets) {
    const RodProblem problem = DrawRodProblem(kFamily, 5, 0);
    const double apart = MostApart(MoveExactly(rod, preset, problem, 60 * 32),
                                   MoveExactly(rod, preset, problem, 60 * 64), 10);
    EXPECT_LT(apart, 1e-3) << preset.name;
  }
}

// A strand that stands level and is heavier for its stiffness by gamma, against the exact elastica.
double TipOff(const CurveStrand& strand, double gamma) {
  const double frequency = kRodFrequency1 * std::sqrt(9.81 / gamma) / (2.0 * exact::kPi);
  const Preset preset{"level", 1.0, frequency, 1.0, 0.05};
  const RestCurve level{kZero3, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, 0.0};
  const CurveDynamics dynamics(strand, preset, level);
  const UnknownVectors d = dynamics.Equilibrium(StillPose());
  Double3 tip = {1.0, 0.0, 0.0};
  for (size_t i = 0; i < dynamics.count(); ++i)
    tip = tip + (d[i] - dynamics.rest()[i]) * strand.place[kComparedPoints - 1][i];
  const Sag sag = SolveElastica(gamma);
  return Length(tip - Double3{sag.reach, -sag.drop, 0.0});
}

TEST(CurveStrand, HangsAsTheElastica) {
  struct Row {
    CurveStrand strand;
    double at_30, at_100;  // share of the length
  };
  const Row rows[] = {{LinksOfStrand(3), 0.025, 0.062},
                      {NodesOfStrand("3 nodes", kThreeNodes), 0.004, 0.005},
                      {NodesOfStrand("4 nodes", kFourNodes), 0.002, 0.009},
                      {RodOfStrand(), 1e-4, 1e-3}};
  for (const Row& row : rows) {
    const double at_30 = TipOff(row.strand, 30.0), at_100 = TipOff(row.strand, 100.0);
    std::printf("%s: tip %.2f and %.2f %% of the length off at G 30 and 100\n",
                row.strand.name.c_str(), 100.0 * at_30, 100.0 * at_100);
    EXPECT_LT(at_30, row.at_30) << row.strand.name;
    EXPECT_LT(at_100, row.at_100) << row.strand.name;
  }
}

TEST(CurveStrand, TheRodSwingsAsAClampedRodDoes) {
  const CurveStrand rod = RodOfStrand();
  UnknownMatrix modes;
  UnknownRow squares;
  SolveModes(rod.count, rod.mass, rod.stiffness, modes, squares);
  for (size_t m = 0; m < 3; ++m)
    EXPECT_NEAR(std::sqrt(squares[m]), kRodFrequency[m] / kRodFrequency1, 1e-6);
}

const ModelErrorRow& Find(const ModelErrorTable& table, std::string_view model,
                          std::optional<ModalQuality> quality = {}) {
  for (const ModelErrorRow& row : table.rows)
    if (row.model == model && row.quality == quality) return row;
  throw std::runtime_error("no such row");
}

TEST(ModelError, NodesAreNearerToTheRodThanLinks) {
  ModelErrorOptions options;
  options.families = {kFamily};
  options.problems = 8;
  const ModelErrorTable table = MeasureModelError(options);
  const auto pooled = [&](std::string_view model) {
    const double error = PooledError(Find(table, model), options, table.posed[0]);
    std::printf("%s: %.1f %% off the rod\n", std::string(model).c_str(), 100.0 * error);
    return error;
  };
  EXPECT_GT(pooled("3 links"), 0.15);
  EXPECT_GT(pooled("4 links"), 0.08);
  EXPECT_LT(pooled("8 links"), 0.08);
  EXPECT_LT(pooled("3 nodes"), 0.08);
  EXPECT_LT(pooled("4 nodes"), 0.04);
  // Of stiff strands the stiff nodes are best.
  const size_t stiff = 3;
  const auto median = [&](std::string_view model) {
    return Quantile(Find(table, model).errors[stiff], 0.5);
  };
  EXPECT_GT(median("3 links"), 0.1);
  EXPECT_LT(median("3 stiff nodes"), 0.02);
  EXPECT_LT(median("3 stiff nodes"), 0.5 * median("3 nodes"));
}

// By the solver a chain is as far off the rod as exactly, and what the solver itself gets wrong.
TEST(ModelError, OfTheSolverIsThatOfItsLinks) {
  ModelErrorOptions options;
  options.families = {kFamily};
  options.presets = {kPresets[2]};
  options.problems = 4;
  options.seconds = kSeconds;
  options.isa = BestIsa();
  const ModelErrorTable table = MeasureModelError(options);
  for (const std::string_view links : {"3 links", "4 links", "8 links"})
    for (const ModalQuality quality :
         {ModalQuality::kFast, ModalQuality::kDefault, ModalQuality::kBest}) {
      const double exactly = Quantile(Find(table, links).errors[0], 0.5);
      const double moved = Quantile(Find(table, links, quality).errors[0], 0.5);
      std::printf("%s, quality %d: %.2f %% off the rod, exactly %.2f\n", links.data(), int(quality),
                  100.0 * moved, 100.0 * exactly);
      EXPECT_NEAR(moved, exactly, quality == ModalQuality::kFast ? 0.06 : 0.02);
    }
}

TEST(ModelError, IsOfItsSeed) {
  ModelErrorOptions options;
  options.families = {kFamily};
  options.presets = {kPresets[0]};
  options.problems = 1;
  options.seconds = 0.5;
  const double first = MeasureModelError(options).rows[0].errors[0][0];
  EXPECT_EQ(MeasureModelError(options).rows[0].errors[0][0], first);
  options.seed += 1;
  EXPECT_NE(MeasureModelError(options).rows[0].errors[0][0], first);
}

}  // namespace
}  // namespace pelt::accuracy
