// What the modal solver's features do to its error, and that they do nothing where they do not act.
#include "bench/accuracy/feature_errors.hpp"

#include <gtest/gtest.h>

#include <map>

namespace pelt::accuracy {
namespace {

ModalKernels Kernels() { return ModalKernelsOf(BestIsa()); }

TEST(FeatureErrors, AreThoseOfFreeStrandsWhereNothingTouches) {
  // Per cent, whatever the quality. Impacts are met at the end of their substep.
  const std::map<std::string, double> most = {
      {"bare", 3.0},         {"surface", 4.0}, {"sphere", 20.0}, {"moving sphere", 30.0},
      {"ground", 10.0},      {"bounce", 12.0}, {"limit", 16.0},  {"clump", 3.0},
      {"strength 0.5", 3.0}, {"wind", 3.0}};
  for (const int links : {3, 4}) {
    FeatureOptions options;
    options.links = links;
    options.timing.frames = 0;
    const std::vector<FeatureError> rows = MeasureFeatures(Kernels(), options);
    EXPECT_EQ(rows.size(), 3 * most.size());
    for (const FeatureError& row : rows) {
      std::printf("%d links, %-13s quality %d: %.2f %% (reference %.2f %%), penetration %.3f %%\n",
                  links, row.name.c_str(), int(row.quality), 100.0 * row.error,
                  100.0 * row.self_error, 100.0 * row.penetration);
      EXPECT_LT(100.0 * row.error, most.at(row.name)) << row.name;
      EXPECT_LT(row.self_error, 0.1) << row.name;
      // What moves is met where it is at the end of a substep, and what it then holds inside leaves slowly.
      EXPECT_LT(row.penetration, row.name == "moving sphere" ? 0.03 : 0.01) << row.name;
    }
  }
}

// A contact is felt: the same strands without it go somewhere else.
TEST(FeatureErrors, EveryProblemFeelsItsFeature) {
  for (const FeatureProblem& problem : FeatureProblems(3)) {
    FeatureProblem bare = problem;
    bare.features = {};
    bare.features.wind = false;
    const bool same = RunDigest(Kernels(), ModalQuality::kDefault, problem, 2.0) ==
                      RunDigest(Kernels(), ModalQuality::kDefault, bare, 2.0);
    EXPECT_EQ(same, problem.name == "bare") << problem.name;
  }
}

// Switched on but out of reach: every bit of the motion, and so its energy, is as without.
TEST(FeatureErrors, NothingChangesWhereNothingTouches) {
  for (const int links : {3, 4})
    for (const ModalQuality quality :
         {ModalQuality::kFast, ModalQuality::kDefault, ModalQuality::kBest}) {
      FeatureProblem problem = FeatureProblems(links)[0];
      const uint64_t bare = RunDigest(Kernels(), quality, problem, 2.0);
      problem.features.surface_hardness = 1.0f;  // the strands stand up
      problem.features.bounce = 0.5f;
      problem.features.use_ground = true;
      problem.features.ground_offset = 10.0;
      problem.features.sphere_radius = 0.01;
      problem.features.sphere_centre = {0.0, -0.1, 0.0};
      problem.features.wind = true;  // still air
      problem.features.max_distance = 1.5f;
      EXPECT_EQ(RunDigest(Kernels(), quality, problem, 2.0), bare) << links;
      problem.features.ground_offset = 0.02;
      EXPECT_NE(RunDigest(Kernels(), quality, problem, 2.0), bare) << links;
    }
}

}  // namespace
}  // namespace pelt::accuracy
