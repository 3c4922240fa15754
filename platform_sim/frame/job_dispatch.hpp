// A queue of jobs on some SPEs: who waits for whom.
//
// The PPE dispatches serially; an SPE that has fewer jobs than it may have gets the next one, the
// emptiest SPE first. With long jobs the SPEs are the limit, with short ones the PPE is, however
// many SPEs there are: that floor is row J4.
//
// Not modelled: contention on the queue's lock, the jobs' data (see cell_memory.hpp).
#pragma once

#include <cstdint>
#include <string>

#include "platform_sim/platforms/dispatch.hpp"

namespace pelt {

struct JobRun {
  int64_t finish_ps = 0;
  int64_t ppe_busy_ps = 0;
  int64_t spe_busy_ps = 0;  // of all of them

  double MicrosecondsPerJob(uint64_t jobs) const { return double(finish_ps) / 1e6 / double(jobs); }
};

// `jobs` equal jobs of `job_ns` on `spe_count` SPEs, `job_ns` as it really takes: an availability
// is the caller's to apply. False, and why in `error`, for none of either.
bool RunJobs(const DispatchParameters& p, uint32_t spe_count, uint64_t jobs, double job_ns,
             JobRun& run, std::string& error);

}  // namespace pelt
