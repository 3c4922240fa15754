// A job's nominal time is work at the model's rate: availability stretches it. What dispatching
// costs was measured as it is.
#include "platform_sim/rows/predictions.hpp"
#include "platform_sim/rows/row_work.hpp"

namespace pelt::rows {
namespace {

bool MicrosecondsPerJob(const DispatchParameters& jobs, uint32_t spes, double job_us,
                        double& predicted, std::string& error) {
  constexpr uint64_t kJobs = 5000;
  JobRun run;
  if (!RunJobs(jobs, spes, kJobs, job_us * 1000.0, run, error)) return false;
  predicted = run.MicrosecondsPerJob(kJobs);
  return true;
}

}  // namespace

bool JobsOnOneSpe(const PlatformParameters& p, double availability, uint32_t job_us,
                  double& predicted, std::string& error) {
  return MicrosecondsPerJob(p.cell.jobs, 1, job_us / availability, predicted, error);
}

// The mean over 2 to 6 SPEs, for a job of any length.
bool FloorOfShortJobs(const PlatformParameters& p, double availability, uint32_t job_us,
                      double& predicted, std::string& error) {
  double sum = 0.0;
  for (uint32_t spes = 2; spes <= 6; ++spes) {
    if (!MicrosecondsPerJob(p.cell.jobs, spes, job_us / availability, predicted, error))
      return false;
    sum += predicted;
  }
  predicted = sum / 5;
  return true;
}

}  // namespace pelt::rows
