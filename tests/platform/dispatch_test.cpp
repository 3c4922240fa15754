// Job dispatch against gcell's rows and Microsoft's figures.
#include <gtest/gtest.h>

#include "platform_sim/frame/job_dispatch.hpp"
#include "tests/platform/platform_rows.hpp"

namespace pelt {
namespace {

using namespace testing;

constexpr double kAllowedPercent = 20.0;

double PerJob(const DispatchParameters& p, uint32_t spes, uint64_t job_us) {
  constexpr uint64_t kJobs = 20000;
  JobRun run;
  std::string error;
  EXPECT_TRUE(RunJobs(p, spes, kJobs, job_us * 1000, run, error)) << error;
  return run.MicrosecondsPerJob(kJobs);
}

TEST(DispatchRows, J1OneSpe) {
  ExpectRow("J1", PerJob(kGcellDispatch, 1, 100), 107.53, "us", kAllowedPercent);
  ExpectRow("J1", PerJob(kGcellDispatch, 1, 300), 320.62, "us", kAllowedPercent);
  ExpectRow("J1", PerJob(kGcellDispatch, 1, 500), 533.64, "us", kAllowedPercent);
}

// Measured: 19 to 25 us, whatever the SPE count.
TEST(DispatchRows, J4FloorOfShortJobs) {
  for (uint32_t spes = 2; spes <= 6; ++spes)
    for (uint64_t us : {1, 5, 10}) {
      const double floor = PerJob(kGcellDispatch, spes, us);
      EXPECT_GE(floor, 19.0) << spes << " SPEs, " << us << " us";
      EXPECT_LE(floor, 25.0) << spes << " SPEs, " << us << " us";
    }
  ExpectRow("J4", PerJob(kGcellDispatch, 6, 5), 22.0, "us", kAllowedPercent);
}

TEST(DispatchPlanted, NoSerialDispatchIsNoticed) {
  DispatchParameters p = kGcellDispatch;
  p.ppe_job_ns = 0;
  EXPECT_LT(PerJob(p, 6, 5), 19.0);
  p = kGcellDispatch;
  p.availability_permille = 700;
  EXPECT_GT(PercentOff(PerJob(p, 1, 300), 320.62), kAllowedPercent);
  p = kGcellDispatch;
  p.spe_job_ns = 30000;
  EXPECT_GT(PercentOff(PerJob(p, 1, 100), 107.53), kAllowedPercent);
  p = kGcellDispatch;
  p.jobs_ahead = 1;  // the SPE waits for each dispatch
  EXPECT_GT(PercentOff(PerJob(p, 1, 100), 107.53), kAllowedPercent);
}

TEST(DispatchProperties, MoreSpesAreNeverSlowerAndNoneBeatsItsLimits) {
  for (const DispatchParameters& p : {kGcellDispatch, kAtomicDispatch})
    for (uint64_t us : {1, 20, 100, 500}) {
      double before = 1e9;
      for (uint32_t spes = 1; spes <= 6; ++spes) {
        const double per_job = PerJob(p, spes, us);
        EXPECT_LE(per_job, before * 1.0001);
        EXPECT_GE(per_job * spes, double(us));
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
}

// X1 - X5 are parameters, given as Microsoft's ranges.
TEST(DispatchRows, XenonSynchronisation) {
  const auto& x = kXenonSynchronisation;
  EXPECT_EQ(x[0].least_cycles, 33u);
  EXPECT_EQ(x[0].most_cycles, 48u);
  EXPECT_EQ(x[1].least_cycles, 225u);
  EXPECT_EQ(x[1].most_cycles, 260u);
  EXPECT_EQ(x[2].Middle(), 345u);
  EXPECT_EQ(x[3].Middle(), 2350u);
  EXPECT_EQ(x[4].most_cycles, 40u);
}

}  // namespace
}  // namespace pelt
