// Job dispatch: who waits for whom. Its rows are in measured_rows_test.cpp.
#include <gtest/gtest.h>

#include "platform_sim/rows/row_work.hpp"

namespace pelt {
namespace {

double PerJob(const DispatchParameters& p, uint32_t spes, double job_us) {
  constexpr uint64_t kJobs = 2000;
  JobRun run;
  std::string error;
  EXPECT_TRUE(RunJobs(p, spes, kJobs, job_us * 1000.0, run, error)) << error;
  return run.MicrosecondsPerJob(kJobs);
}

// Row J4 says so of gcell: 19 to 25 us, for any SPE count and any job.
TEST(DispatchProperties, ShortJobsHaveTheDispatchersFloor) {
  for (uint32_t spes = 2; spes <= 6; ++spes)
    for (const double us : {1.0, 5.0, 10.0}) {
      EXPECT_GE(PerJob(kGcellDispatch, spes, us), 19.0) << spes << " SPEs, " << us << " us";
      EXPECT_LE(PerJob(kGcellDispatch, spes, us), 25.0) << spes << " SPEs, " << us << " us";
    }
}

TEST(DispatchProperties, AJobAheadHidesTheDispatch) {
  DispatchParameters p = kGcellDispatch;
  const double hidden = PerJob(p, 1, 100);
  p.jobs_ahead = 1;  // the SPE waits for each
  EXPECT_NEAR(PerJob(p, 1, 100) - hidden, 22.0, 0.1);
}

TEST(DispatchProperties, MoreSpesAreNeverSlowerAndNoneBeatsItsLimits) {
  for (const DispatchParameters& p : {kGcellDispatch, AtomicDispatch(150)})
    for (const double us : {1.0, 20.0, 100.0, 500.0}) {
      double before = 1e9;
      for (uint32_t spes = 1; spes <= 6; ++spes) {
        const double per_job = PerJob(p, spes, us);
        EXPECT_LE(per_job, before * 1.0001);
        EXPECT_GE(per_job * spes, us);
        EXPECT_GE(per_job, p.ppe_job_ns / 1000.0);
        before = per_job;
      }
    }
}

TEST(DispatchErrors, NothingToRunOn) {
  JobRun run;
  std::string error;
  EXPECT_FALSE(RunJobs(kGcellDispatch, 0, 1, 1, run, error));
  EXPECT_FALSE(error.empty());
  EXPECT_FALSE(RunJobs(kGcellDispatch, 1, 0, 1, run, error));
  EXPECT_FALSE(RunJobs(kGcellDispatch, 1, 1, -1.0, run, error));
}

}  // namespace
}  // namespace pelt
