#include "platform_sim/frame/job_dispatch.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <vector>

#include "core/format.hpp"

namespace pelt {
namespace {

constexpr int64_t kPicoseconds = 1000;  // of a nanosecond

// When the jobs an SPE has end, first to last; only as many as it may have are kept.
struct Spe {
  std::deque<int64_t> ends;

  int64_t FreePlace(size_t places) const { return ends.size() < places ? 0 : ends.front(); }
  int64_t Free() const { return ends.empty() ? 0 : ends.back(); }
};

}  // namespace

bool RunJobs(const DispatchParameters& p, uint32_t spe_count, uint64_t jobs, double job_ns,
             JobRun& run, std::string& error) {
  constexpr double kLongestJobNs = 1e9;
  if (!(job_ns >= 0.0 && job_ns <= kLongestJobNs)) {
    error = Format("jobs of {} ns; expected 0 to {}", job_ns, kLongestJobNs);
    return false;
  }
  if (spe_count == 0 || jobs == 0 || p.jobs_ahead == 0) {
    error = Format("{} jobs on {} SPEs that may have {}: none may be zero", jobs, spe_count,
                   p.jobs_ahead);
    return false;
  }
  run = {};
  std::vector<Spe> spes(spe_count);
  const int64_t work =
      std::llround(job_ns * double(kPicoseconds)) + int64_t(p.spe_job_ns) * kPicoseconds;
  const int64_t dispatch = int64_t(p.ppe_job_ns) * kPicoseconds;
  int64_t ppe = 0;
  for (uint64_t job = 0; job < jobs; ++job) {
    Spe& spe = *std::min_element(spes.begin(), spes.end(), [&](const Spe& a, const Spe& b) {
      const int64_t place_a = std::max(ppe, a.FreePlace(p.jobs_ahead));
      const int64_t place_b = std::max(ppe, b.FreePlace(p.jobs_ahead));
      return place_a != place_b ? place_a < place_b : a.Free() < b.Free();
    });
    ppe = std::max(ppe, spe.FreePlace(p.jobs_ahead)) + dispatch;
    if (spe.ends.size() == p.jobs_ahead) spe.ends.pop_front();
    spe.ends.push_back(std::max(ppe, spe.Free()) + work);
    run.ppe_busy_ps += dispatch;
    run.spe_busy_ps += work;
    run.finish_ps = std::max(run.finish_ps, spe.ends.back());
  }
  return true;
}

}  // namespace pelt
