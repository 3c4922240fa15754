#include "platform_sim/platforms/xenon_memory.hpp"

#include "core/format.hpp"

namespace pelt {

std::vector<PlatformNumber> DescribeXenon(const XenonParameters& p) {
  using enum Sureness;
  constexpr std::string_view kTalks = "IBM, Microsoft talks, as reported";
  std::vector<PlatformNumber> out = {
      {"clock", double(p.clock_hz), "Hz", kTalks, kSecondHand},
      {"availability", p.Availability(), "of a rate", "the PS3's: none was measured on an Xbox 360",
       kLead},
      {"cores", double(p.cores), "cores", kTalks, kSecondHand},
      {"line", double(p.line_bytes), "B", kTalks, kSecondHand},
      {"L1 data", double(p.l1_bytes), "B", kTalks, kSecondHand},
      {"L1 ways", double(p.l1_ways), "ways", kTalks, kSecondHand},
      {"L2", double(p.l2_bytes), "B", kTalks, kSecondHand},
      {"L2 ways", double(p.l2_ways), "ways", kTalks, kSecondHand},
      {"L2 hit", double(p.l2_hit_cycles), "cycles", "39 to 40, widely repeated", kLead},
      {"L2 rate", p.l2_milli_bytes_per_cycle / 1000.0, "B/cycle", "51.2 GB/s, IBM talk",
       kPublished},
      {"misses in flight, a core", double(p.outstanding_misses), "lines", "Microsoft", kPublished},
      {"memory", double(p.memory_cycles), "cycles", "about 610, widely repeated", kLead},
      {"front-side bus, each way", p.bus_milli_bytes_per_cycle / 1000.0, "B/cycle",
       "10.8 GB/s, Microsoft", kPublished},
      {"memory rate", p.memory_milli_bytes_per_cycle / 1000.0, "B/cycle", "22.4 GB/s, Microsoft",
       kPublished},
      {"the GPU's share of memory", p.gpu_permille / 1000.0, "of the rate", "the caller's", kLead},
  };
  for (PlatformNumber& number : DescribeNumbers(p.core)) out.push_back(std::move(number));
  return out;
}

bool CheckXenon(const XenonParameters& p, std::string& error) {
  if (!CheckCacheMemory(p, error)) return false;
  if (p.cores > kMostXenonCores) {
    error = Format("Xenon refused: it has {} cores; an Xbox 360 has {}", p.cores, kMostXenonCores);
    return false;
  }
  if (p.clock_hz == 0) {
    error = "Xenon refused: its clock is zero";
    return false;
  }
  if (p.availability_permille == 0 || p.availability_permille > 1000) {
    error = "Xenon refused: its availability must be 1 to 1000 permille";
    return false;
  }
  return true;
}

}  // namespace pelt
