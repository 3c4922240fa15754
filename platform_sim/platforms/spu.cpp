#include "platform_sim/platforms/spu.hpp"

#include "core/format.hpp"

namespace pelt {

std::vector<PlatformNumber> DescribeNumbers(const SpuParameters& spu) {
  std::vector<PlatformNumber> out;
  for (const SpuClassParameters& c : spu.classes) {
    const char* pipe = c.pipe == SpuPipe::kEven ? "even" : "odd";
    out.push_back({Format("{} latency ({} pipe: {})", c.name, pipe, c.operations),
                   double(c.latency_cycles), "cycles", c.source, c.sure});
    if (c.stall_cycles)
      out.push_back({Format("{} stall of both pipes", c.name), double(c.stall_cycles), "cycles",
                     c.source, c.sure});
  }
  TellNumbers<SpuNumbers>(spu, out);
  return out;
}

}  // namespace pelt
