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
  const auto add = [&](const char* name, double value, const char* unit, const char* source) {
    out.push_back({name, value, unit, source, Sureness::kPublished});
  };
  add("fetch group", spu.fetch_group_bytes, "bytes", "SDK");
  add("instruction", spu.instruction_bytes, "bytes", "SDK");
  add("mispredicted branch", spu.mispredict_cycles, "cycles", "SDK");
  add("lead of a branch hint", spu.hint_lead_cycles, "cycles", "SDK");
  add("reach of a branch hint", spu.hint_reach_instructions, "instructions", "GCC");
  add("FP6 right after an FP7", spu.fp6_after_fp7_cycles, "cycles", "SDK");
  add("registers", spu.register_count, "registers", "SDK");
  return out;
}

}  // namespace pelt
