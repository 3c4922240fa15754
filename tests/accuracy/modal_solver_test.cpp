// Pelt's modal kernel under the yardstick, on chains of links: error, energy, frequencies, static shape and the
// pendulum, which is its time step alone; and the stress table, on strands as layers have them. On the widest vectors
// there are (the kernels' own tests show that all give the same bits).
#include "bench/accuracy/modal_solver.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "bench/accuracy/solver_checks.hpp"
#include "bench/accuracy/stress.hpp"
#include "tests/accuracy/suite.hpp"

namespace pelt::accuracy {
namespace {

constexpr ModalQuality kQualities[] = {ModalQuality::kFast, ModalQuality::kFine,
                                       ModalQuality::kBest};
constexpr const char* kNames[] = {"fast", "fine", "best"};

SolverFactory Modal(ModalQuality quality) {
  return ModalFactory(ModalKernelsOf(BestIsa()), quality);
}

TEST(Modal, ErrorOfTheSecondaryMotion) {
  // Per cent at 60 Hz, dangly, soft, medium, stiff. Most of the best tier's last is the input's.
  static constexpr double kMost[3][4] = {
      {3.0, 8.0, 3.0, 3.0}, {0.5, 1.0, 0.4, 0.7}, {0.4, 0.5, 0.4, 0.7}};
  for (size_t q = 0; q < 3; ++q) {
    std::printf("modal, %-8s", kNames[q]);
    for (size_t preset = 0; preset < 4; ++preset) {
      const Score score = ScoreSolver(SharedSuite(), preset, Modal(kQualities[q]), 60);
      std::printf(" | %s %.2f %% stretch %.0e", kPresets[preset].name.data(), 100.0 * score.error,
                  score.stretch);
      EXPECT_TRUE(score.finite);
      EXPECT_LT(100.0 * score.error, kMost[q][preset]) << kNames[q] << ", preset " << preset;
      EXPECT_LT(score.stretch, 3e-5);
      EXPECT_GT(score.cases, 20);
    }
    std::printf("\n");
  }
}

// Velocities with the poses, default tier: per cent, dangly, soft, medium, stiff; 3 links, and the
// calibrated chains of layers.
TEST(Modal, VelocitiesMakeItExactAtLowRates) {
  struct Rate {
    int hz;
    double most[4], most_calibrated[4];
  };
  static constexpr Rate kRates[] = {{15, {2, 5, 3, 7}, {4, 6, 5, 8}},
                                    {30, {1.5, 4, 1.5, 1.5}, {2.5, 2.5, 1, 1.2}},
                                    {60, {0.6, 1.5, 0.5, 0.3}, {2.6, 1.8, 0.6, 0.5}}};
  const auto factory = [](bool velocities) {
    return ModalFactory(ModalKernelsOf(BestIsa()), ModalQuality::kFine, {.velocities = velocities});
  };
  SuiteOptions options;
  options.coefficients = Coefficients::kCalibrated;
  const Suite calibrated = SolveSuite(options);
  for (const bool even : {true, false})
    for (const Rate& rate : kRates) {
      std::printf("%s masses, %d Hz:", even ? "even" : "calibrated", rate.hz);
      for (size_t preset = 0; preset < 4; ++preset) {
        const Suite& suite = even ? SharedSuite() : calibrated;
        const Score without = ScoreSolver(suite, preset, factory(false), rate.hz);
        const Score with = ScoreSolver(suite, preset, factory(true), rate.hz);
        std::printf(" %s %.2f -> %.2f %%", kPresets[preset].name.data(), 100.0 * without.error,
                    100.0 * with.error);
        EXPECT_LT(100.0 * with.error, (even ? rate.most : rate.most_calibrated)[preset]);
        EXPECT_LT(with.stretch, 3e-5);
      }
      std::printf("\n");
    }
}

// 4 links, and the calibrated chains of layers: few cases.
TEST(Modal, ErrorOnOtherChains) {
  struct Chain {
    int links;
    Coefficients coefficients;
    double most[3][4];  // per cent
  };
  static constexpr Chain kChains[] = {
      {4, Coefficients::kUniform, {{4, 14, 4, 4}, {1, 4, 1, 1.2}, {0.5, 1, 0.6, 1.2}}},
      {3, Coefficients::kCalibrated, {{8, 22, 5, 4}, {3, 4, 1.3, 1.4}, {1, 1.2, 1.2, 1.4}}},
      {4, Coefficients::kCalibrated, {{8, 26, 5, 4}, {3, 5, 1.3, 1.4}, {1, 1.5, 1.2, 1.4}}}};
  for (const Chain& chain : kChains) {
    SuiteOptions options;
    options.links = chain.links;
    options.coefficients = chain.coefficients;
    options.strands = 3;
    options.seconds = 2.5;
    options.motions = {Motion::kWalk, Motion::kHeadshake};
    const Suite suite = SolveSuite(options);
    for (size_t q = 0; q < 3; ++q) {
      std::printf("%d links, %s, modal, %-8s", chain.links,
                  chain.coefficients == Coefficients::kUniform ? "even" : "calibrated", kNames[q]);
      for (size_t preset = 0; preset < 4; ++preset) {
        const Score score = ScoreSolver(suite, preset, Modal(kQualities[q]), 60);
        std::printf(" %.2f %%", 100.0 * score.error);
        EXPECT_LT(100.0 * score.error, chain.most[q][preset]) << kNames[q] << ", " << preset;
      }
      std::printf("\n");
    }
  }
}

TEST(Modal, PendulumChallengeWithinAMillimetre) {
  const FixedProblem pendulum = PendulumChallenge();
  const double miss =
      Length(SolveFixed(pendulum, Modal(ModalQuality::kBest), 60, 1.0) - pendulum.tip[3].position);
  std::printf("modal, best, misses the pendulum by %.2f mm\n", 1e3 * miss);
  EXPECT_LT(miss, 1e-3);
}

TEST(Modal, EnergyFrequenciesAndStaticShape) {
  const ChainMaterial medium = MakeMaterial(kPresets[2], 3);
  const Strand strand = SeededStrands(3, 6, 1)[3];
  for (size_t q = 0; q < 3; ++q) {
    const SolverFactory solver = Modal(kQualities[q]);
    for (const double frequency : {0.0, 2.0}) {
      const double kept = EnergyKept(solver, 3, frequency, 60);
      EXPECT_GT(kept, 0.85) << kNames[q];
      EXPECT_LT(kept, 1.05) << kNames[q];
    }
    for (const double frame : {1.0 / 15, 1.0 / 60, 1.0 / 240})
      for (const ModeResponse& mode : MeasureModes(solver, medium, frame)) {
        EXPECT_NEAR(mode.first, mode.exact_first, 2e-5);
        if (mode.gone) continue;
        EXPECT_NEAR(mode.sum, mode.exact_sum, 3e-5);
        EXPECT_NEAR(mode.product, mode.exact_product, 3e-5);
      }
    std::printf("modal, %-8s static shape at", kNames[q]);
    for (const int rate : {15, 30, 60, 120, 240}) {
      const double error = StaticShapeError(solver, medium, strand, rate);
      std::printf(" %d fps %+.4f %%", rate, 100.0 * error);
      EXPECT_LT(std::abs(error), 1e-4);
    }
    const double jittered = StaticShapeError(solver, medium, strand, 60, 8.0, 3.0);
    std::printf(", 15-240 mixed %+.4f %%\n", 100.0 * jittered);
    EXPECT_LT(std::abs(jittered), 1e-4);
  }
}

void ExpectSettled(const StressProblem& row, size_t quality) {
  const SolverFactory strand = LayerFactory(ModalKernelsOf(BestIsa()), kQualities[quality]);
  const StressResult r = RunStress(row, strand, false);
  SCOPED_TRACE(testing::Message() << kNames[quality] << ", " << row.material.links << " parts, "
                                  << row.name);
  EXPECT_EQ(r.non_finite, 0);
  EXPECT_LT(r.worst_stretch, kMostPromisedStretch);
  EXPECT_EQ(r.unsettled, 0);
  EXPECT_EQ(r.stuck, 0);
}

TEST(Modal, EveryStressRowSettles) {
  for (const int links : {3, 4, 8})
    for (const StressProblem& row : StressProblems({.links = links, .random_starts = 80}))
      for (size_t q = 0; q < 3; ++q) ExpectSettled(row, q);
}

// Other strands where frames are longest, and curl that follows its parent.
TEST(Modal, OtherSeedsAndParentCurlSettle) {
  for (const uint64_t seed : {2, 3, 4})
    for (const StressProblem& row :
         StressProblems({.links = 4, .random_starts = 0, .seed = seed, .frame_rates = {15}}))
      if (row.frames_per_second == 15)
        for (size_t q = 0; q < 3; ++q) ExpectSettled(row, q);
  for (StressProblem& row : StressProblems({.random_starts = 40, .frame_rates = {15, 60}})) {
    row.material.curl = CurlModel::kParent;
    // Strands that swing on their weight faster than a substep follows go by implicit steps without their curl.
    const size_t first = row.name.find("limp") == std::string::npos ? 0 : 1;
    for (size_t q = first; q < 3; ++q) ExpectSettled(row, q);
  }
}

TEST(Modal, RefusesWhatItCannotRun) {
  SolverSetup setup{MakeMaterial(kPresets[0], 3)};
  EXPECT_NE(Modal(ModalQuality::kFast)(setup), nullptr);
  setup.material.length[1] *= 2.0;
  EXPECT_EQ(Modal(ModalQuality::kFast)(setup), nullptr);
}

}  // namespace
}  // namespace pelt::accuracy
