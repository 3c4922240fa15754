// The comparison solvers against the errors published for them, against each other's limits, and
// every instruction set against the reference, bit for bit.
#include "bench/accuracy/comparison/comparison.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "bench/accuracy/named_solver.hpp"
#include "bench/accuracy/solver_checks.hpp"
#include "bench/accuracy/solver_run.hpp"
#include "bench/accuracy/solver_timing.hpp"
#include "tests/accuracy/suite.hpp"

namespace pelt::accuracy {
namespace {

constexpr MethodSettings kLeader = {Method::kFollowTheLeader, 1, 1};
constexpr MethodSettings kPbd4 = {Method::kPbd, 1, 4};
constexpr MethodSettings kXpbd8 = {Method::kXpbd, 8, 1};
constexpr MethodSettings kXpbd64 = {Method::kXpbd, 64, 1};
constexpr MethodSettings kEuler = {Method::kImplicitEuler, 1, 6};
constexpr MethodSettings kTrapezoid2 = {Method::kTrapezoid, 2, 2};

SolverFactory Fixed(const MethodSettings& settings) {
  return ComparisonFactory(BestIsa(), settings);
}

// Prints a method's row beside the published one; they may differ by the strands drawn.
void CompareRow(const char* name, const double (&published)[4], double ratio,
                const std::function<Score(size_t preset)>& score_of, double low_stretch,
                double high_stretch) {
  std::printf("%-24s", name);
  for (size_t preset = 0; preset < 4; ++preset) {
    const Score score = score_of(preset);
    std::printf(" | %s %5.2f %% (%5.2f %%) stretch %.0e", kPresets[preset].name.data(),
                100.0 * score.error, published[preset], score.stretch);
    EXPECT_TRUE(score.finite);
    EXPECT_LT(100.0 * score.error, published[preset] * ratio) << name << " preset " << preset;
    EXPECT_GT(100.0 * score.error, published[preset] / ratio) << name << " preset " << preset;
    EXPECT_GE(score.stretch, low_stretch);
    EXPECT_LE(score.stretch, high_stretch);
  }
  std::printf("\n");
}

// 60 Hz; error for dangly, soft, medium and stiff fur, per cent.
TEST(Comparison, ErrorsAreAsPublished) {
  const Suite& suite = SharedSuite();
  const auto plain = [&](const MethodSettings& settings) {
    return [&suite, settings](size_t preset) {
      return ScoreSolver(suite, preset, Fixed(settings), 60);
    };
  };
  const auto tuned = [&](std::string_view name) {
    return [&suite, solver = *FindSolver(name)](size_t preset) {
      return ScoreNamed(solver, BestIsa(), suite, preset, 60).score;
    };
  };
  CompareRow("follow-the-leader, tuned", {46, 89, 51, 33}, 1.3, tuned("dftl-1"), 0.0, 1e-6);
  CompareRow("PBD, 4 iterations, tuned", {39, 66, 44, 46}, 1.3, tuned("textbook-pbd-4"), 0.02,
             0.25);
  CompareRow("XPBD, 8 substeps", {12, 32, 37, 98}, 1.3, plain(kXpbd8), 0.01, 0.07);
  CompareRow("XPBD, 64 substeps", {3.1, 8.6, 3.9, 8.4}, 1.3, plain(kXpbd64), 1e-4, 2e-3);
  CompareRow("implicit Euler", {36, 57, 40, 23}, 1.15, plain(kEuler), 0.0, 1e-6);
  CompareRow("trapezoid, 2 substeps", {0.8, 2.8, 1.6, 1.1}, 1.3, plain(kTrapezoid2), 0.0, 1e-6);
}

// Nothing was published for ours: they stand near PBD's rows, and are printed. Verlet, which pulls
// towards the groom, has soft fur worse than no simulation.
TEST(Comparison, OurOwnPositionBasedSolversAreAsGoodAsPbd) {
  const Suite& suite = SharedSuite();
  const auto check = [&](const char* name, double most_error, double most_stretch) {
    std::printf("Pelt's %s, tuned", name);
    for (size_t preset = 0; preset < 4; ++preset) {
      const TunedSolver tuned = ScoreNamed(*FindSolver(name), BestIsa(), suite, preset, 60);
      std::printf(" | %s %.1f %% stretch %.0e", kPresets[preset].name.data(),
                  100.0 * tuned.score.error, tuned.score.stretch);
      EXPECT_GT(tuned.scale, 0.0);
      EXPECT_LT(tuned.score.error, most_error);
      EXPECT_LT(tuned.score.stretch, most_stretch);
    }
    std::printf("\n");
  };
  check("pbd-1", 1.2, 0.5);
  check("pbd-4", 1.0, 0.03);
  check("pbd-16", 1.0, 0.01);
  check("verlet-4", 1.2, 0.05);
}

// Every method that has a limit goes to the exact motion: error falls with the order of the method.
TEST(Comparison, ErrorsFallWithTheStep) {
  const Suite& suite = SharedSuite();
  const auto error = [&](Method method, int substeps, int iterations) {
    return ScoreSolver(suite, 2, Fixed({method, substeps, iterations}), 120).error;
  };
  EXPECT_GT(error(Method::kImplicitEuler, 4, 6) / error(Method::kImplicitEuler, 16, 6), 3.0);
  EXPECT_GT(error(Method::kTrapezoid, 1, 3) / error(Method::kTrapezoid, 2, 3), 3.2);
  EXPECT_GT(error(Method::kXpbd, 8, 1) / error(Method::kXpbd, 32, 1), 4.0);
}

// The line that users draw between two poses of the root is the smaller part of XPBD's error.
TEST(Comparison, ACubicRootTakesSomeOfTheErrorOfXpbd) {
  const Suite& suite = SharedSuite();
  const auto error = [&](Method method, int substeps, size_t preset) {
    return ScoreSolver(suite, preset, Fixed({method, substeps, 1}), 60).error;
  };
  for (size_t preset = 0; preset < 4; ++preset) {
    const double line = error(Method::kXpbd, 64, preset),
                 cubic = error(Method::kXpbdCubic, 64, preset);
    std::printf("XPBD, 64 substeps, %s: %.2f %%, root on a cubic %.2f %%\n",
                kPresets[preset].name.data(), 100.0 * line, 100.0 * cubic);
    EXPECT_LT(cubic, line);
  }
}

TEST(Comparison, PendulumChallenge) {
  const FixedProblem pendulum = PendulumChallenge();
  const auto miss = [&](const MethodSettings& settings) {
    return 1e3 * Length(SolveFixed(pendulum, Fixed(settings), 60, 1.0) - pendulum.tip[3].position);
  };
  const double xpbd = miss({Method::kXpbd, 50, 1}), trapezoid = miss({Method::kTrapezoid, 8, 3});
  std::printf(
      "pendulum challenge at 1 s: XPBD, 50 substeps, misses by %.1f mm (116 published); "
      "trapezoid, 8 substeps, by %.2f mm\n",
      xpbd, trapezoid);
  EXPECT_NEAR(xpbd, 116.0, 5.0);
  EXPECT_LT(trapezoid, 1.5);
}

const MethodSettings kAll[] = {kLeader,
                               kPbd4,
                               {.method = Method::kPbd, .iterations = 2, .one_sided = true},
                               {Method::kXpbd, 8, 2},
                               {Method::kXpbdCubic, 8, 1},
                               kEuler,
                               kTrapezoid2};

TEST(Comparison, EveryInstructionSetGivesTheSameBits) {
  for (const int links : {3, 4})
    for (const MethodSettings& settings : kAll) {
      const ChainMaterial material = MakeMaterial(kPresets[1], links);
      const TimingOptions options = {.strands = 64, .frames = 20, .repeats = 1};
      uint64_t expected = 0;
      ASSERT_GT(NanosecondsPerStrand(ComparisonFactory(Isa::kReference, settings), material,
                                     options, &expected),
                0.0);
      for (const Isa isa : kAllIsas) {
        uint64_t digest = expected;
        NanosecondsPerStrand(ComparisonFactory(isa, settings), material, options, &digest);
        EXPECT_EQ(digest, expected) << MethodLabel(settings) << " on " << IsaName(isa);
      }
    }
}

TEST(Comparison, UnknownMaterialsAndSettingsAreRefused) {
  SolverSetup setup{MakeMaterial(kPresets[0], 3)};
  EXPECT_NE(MakeComparison(BestIsa(), kXpbd8, setup), nullptr);
  EXPECT_EQ(MakeComparison(BestIsa(), {Method::kXpbd, 65, 1}, setup), nullptr);
  setup.material.links = 2;
  EXPECT_EQ(MakeComparison(BestIsa(), kXpbd8, setup), nullptr);
  EXPECT_EQ(MakeCoreSolver(BestIsa(), {}, setup), nullptr);
}

// A strand in a batch of many moves as it does alone, padded lanes and second chunk included.
TEST(Comparison, StrandsDoNotSeeEachOther) {
  const ChainMaterial material = MakeMaterial(kPresets[2], 3);
  const std::vector<Strand> strands = SeededStrands(3, 150, 4);
  std::vector<LinkDirections> start;
  for (const Strand& strand : strands) start.push_back(FindEquilibrium(material, strand));
  std::vector<SolverFactory> factories = {CoreFactory(BestIsa(), {})};
  for (const MethodSettings& settings : kAll) factories.push_back(Fixed(settings));
  for (const SolverFactory& factory : factories) {
    const BodyPose first = PoseOf(Motion::kWalk, 0.0);
    SolverRun all(factory, material, 1.0 / 60, strands, start, first);
    SolverRun alone(factory, material, 1.0 / 60, {strands[147]}, std::span(&start[147], 1), first);
    for (int f = 1; f <= 60; ++f) {
      all.Step(PoseOf(Motion::kWalk, f / 60.0));
      alone.Step(PoseOf(Motion::kWalk, f / 60.0));
    }
    for (int i = 0; i < 3; ++i) EXPECT_EQ(Length(all.Point(147, i) - alone.Point(0, i)), 0.0);
  }
}

}  // namespace
}  // namespace pelt::accuracy
