// What the modal solver's features do to its error, and that they do nothing where they do not act.
#include "bench/accuracy/feature_errors.hpp"

#include <gtest/gtest.h>

#include <map>

namespace pelt::accuracy {
namespace {

ModalKernels Kernels() { return ModalKernelsOf(BestIsa()); }

// Per cent, for every quality. Impacts are met at the end of their substep, those of what is fast when
// they are: `best` in steps a quarter as long (core/kernels/modal_short_steps.hpp). `contact`: of links, against the
// reference of contact. In `fast` a frame whose step failed ends where another one puts it, up to 2 % inside what moves.
struct Most {
  double error, penetration, contact = error, fastest = 0.0, self = 10.0;
};
// The walk's lowest root dips so far under the ground, which for it lies as much lower (Colliders::LeaveRoot).
constexpr double kGroundDips = 7.66;
const std::map<std::string, Most> kMost = {
    {"bare", {3.0, 0.0}},
    // Of 4 nodes; 3 are 3.7 % off.
    {"surface", {12.0, 0.01}},
    {"sphere", {20.0, 0.01}},
    {"moving sphere", {40.0, 2.0}},
    {"ground", {10.0, kGroundDips, 5.0}},
    {"bounce", {12.0, kGroundDips}},
    {"ground, friction", {32.0, kGroundDips, 15.0}},
    {"capsule", {20.0, 0.01}},
    {"moving capsule", {40.0, 2.0}},
    {"moving capsule, friction", {65.0, 8.0}},
    // Tips are thrown right round, and whip on as they were met.
    {"fast sphere", {80.0, 0.1, 55.0, 0.0, 25.0}},
    {"fast capsule", {16.0, 0.1, 14.0}},
    {"overlap", {14.0, 0.01, 0.0, 0.21}},
    {"root inside", {6.0, 25.0, 0.0, 1e-3}},
    {"limit", {16.0, 0.01}},
    {"clump", {3.0, 0.0}},
    {"strength 0.5", {3.0, 0.0}},
    {"wind", {3.0, 0.0}}};

TEST(FeatureErrors, AreThoseOfFreeStrandsWhereNothingTouches) {
  for (const int links : {3, 4}) {
    FeatureOptions options;
    options.links = links;
    options.seconds = 2.0;
    options.contact_rate = 12000;
    options.timing.frames = 0;
    const std::vector<FeatureError> rows = MeasureFeatures(Kernels(), options);
    EXPECT_EQ(rows.size(), 3 * kMost.size());
    for (const FeatureError& row : rows) {
      const double contact = row.contact_error.value_or(0.0), fastest = row.fastest.value_or(0.0);
      std::printf(
          "%d parts, %-24s quality %d: %.2f %% (reference %.2f %%), contact %.2f (%.2f) %%, "
          "penetration %.3f %%, %.4f m/s\n",
          links, row.name.c_str(), int(row.quality), 100.0 * row.error, 100.0 * row.self_error,
          100.0 * contact, 100.0 * row.contact_self_error.value_or(0.0), 100.0 * row.penetration,
          fastest);
      const Most& most = kMost.at(row.name);
      EXPECT_LT(100.0 * row.error, most.error) << row.name;
      EXPECT_LE(100.0 * contact, most.contact) << row.name;
      EXPECT_LE(100.0 * row.penetration, most.penetration) << row.name;
      EXPECT_LE(fastest, most.fastest) << row.name;
      EXPECT_LT(100.0 * row.self_error, most.self) << row.name;
    }
  }
}

// Contact that is resolved 16 times as often is that of a reference which shares nothing with it.
TEST(FeatureErrors, ContactConvergesToWhatItShouldBe) {
  for (FeatureProblem& problem : FeatureProblems(3)) {
    if (!HasContactReference(problem)) continue;
    problem.strands.resize(4);
    const double off = ContactError(Kernels(), problem, 16, 24000, 1.0);
    std::printf("%s: %.3f %%\n", problem.name.c_str(), 100.0 * off);
    EXPECT_LT(off, 0.04) << problem.name;
  }
}

// Halving the step changes each contact row by far less than what is measured with it.
TEST(FeatureErrors, TheReferenceOfContactConverges) {
  for (const int links : {3, 4})
    for (const FeatureProblem& problem : FeatureProblems(links)) {
      if (!HasContactReference(problem)) continue;
      FeatureProblem few = problem;
      few.strands.resize(4);
      const double off = ContactSelfError(few, 24000, 1.0);
      std::printf("%d links, %s: %.4f %%\n", links, few.name.c_str(), 100.0 * off);
      // What a ball at 10 m/s throws goes on as it was met; and strands that catch on a capsule let go
      // of it sooner or later as it happens.
      const double most = few.name == "fast sphere"                ? 0.02
                          : few.name == "moving capsule, friction" ? 0.04
                                                                   : 0.005;
      EXPECT_LT(off, most) << links << " links, " << few.name;
    }
}

// A contact is felt: the same strands without it go somewhere else.
TEST(FeatureErrors, EveryProblemFeelsItsFeature) {
  for (const FeatureProblem& problem : FeatureProblems(3)) {
    FeatureProblem bare = problem;
    bare.features = {};
    bare.features.wind = false;
    const bool same = RunDigest(Kernels(), ModalQuality::kFine, problem, 2.0) ==
                      RunDigest(Kernels(), ModalQuality::kFine, bare, 2.0);
    EXPECT_EQ(same, problem.name == "bare") << problem.name;
  }
}

// Switched on but out of reach: every bit of the motion, and so its energy, is as without.
TEST(FeatureErrors, NothingChangesWhereNothingTouches) {
  for (const int links : {3, 4})
    for (const ModalQuality quality :
         {ModalQuality::kFast, ModalQuality::kFine, ModalQuality::kBest}) {
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
