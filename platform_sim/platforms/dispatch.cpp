#include "platform_sim/platforms/dispatch.hpp"

namespace pelt {

std::vector<PlatformNumber> DescribeDispatch(const DispatchParameters& p) {
  using enum Sureness;
  const bool gcell = p.name == "gcell";
  const std::string_view source = gcell ? "gcell, 2007, derived" : "cellmark, row S1";
  return {
      {"PPE, for a job", double(p.ppe_job_ns), "ns", source, kPublished},
      {"SPE, for a job", double(p.spe_job_ns), "ns", source, kPublished},
      {"jobs an SPE may have", double(p.jobs_ahead), "", "the model's", kLead},
      {"availability", p.availability_permille / 1000.0, "", "cellmark, derived", kPublished},
  };
}

}  // namespace pelt
