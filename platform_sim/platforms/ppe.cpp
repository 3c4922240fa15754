#include "platform_sim/platforms/ppe.hpp"

#include "core/format.hpp"

namespace pelt {

std::vector<PlatformNumber> DescribeNumbers(const PpeParameters& ppe) {
  std::vector<PlatformNumber> out;
  for (const PpeClassParameters& c : ppe.classes)
    out.push_back({Format("{} latency{}", c.name, c.blocks_units ? ", not pipelined" : ""),
                   double(c.latency_cycles), "cycles", c.source, c.sure});
  TellNumbers<PpeNumbers>(ppe, out);
  return out;
}

}  // namespace pelt
