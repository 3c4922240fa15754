#include "platform_sim/platforms/dispatch.hpp"

namespace pelt {

std::vector<PlatformNumber> DescribeDispatch(const DispatchParameters& p) {
  using enum Sureness;
  const std::string_view source =
      p.name == kGcellDispatch.name ? "gcell, 2007, derived: row J4" : "the model's, row S1";
  return {
      {"PPE, for a job", double(p.ppe_job_ns), "ns", source, kPublished},
      {"SPE, for a job", double(p.spe_job_ns), "ns", source, kPublished},
      {"jobs an SPE may have", double(p.jobs_ahead), "jobs", "the model's", kLead},
  };
}

}  // namespace pelt
