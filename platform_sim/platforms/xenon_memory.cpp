#include "platform_sim/platforms/xenon_memory.hpp"

#include <fmt/format.h>

#include <bit>

namespace pelt {

CacheMemoryParameters XenonMemory() {
  CacheMemoryParameters p;
  p.name = "Xenon";
  return p;
}

CacheMemoryParameters PpeMemory() {
  CacheMemoryParameters p;
  p.name = "PPE";
  p.cores = 1;
  p.l2_bytes = 512 * 1024;
  p.l2_hit_cycles = 36;
  p.bus_milli_bytes_per_cycle = 8000;
  p.memory_milli_bytes_per_cycle = 8000;
  return p;
}

std::vector<PlatformNumber> DescribeCacheMemory(const CacheMemoryParameters& p) {
  using enum Sureness;
  const bool xenon = p.name == "Xenon";
  const Sureness sure = xenon ? kSecondHand : kPublished;
  const std::string_view chip = xenon ? "IBM, Microsoft talks, as reported" : "cellmark, GCC";
  return {
      {"clock", double(p.clock_mhz), "MHz", chip, sure},
      {"cores", double(p.cores), "", chip, sure},
      {"threads of a core", double(p.threads_per_core), "", chip, sure},
      {"a thread dispatches every", double(p.dispatch_slot_cycles), "cycles", "GCC", kPublished},
      {"availability", p.availability_permille / 1000.0, "", "cellmark, derived", kPublished},
      {"line", double(p.line_bytes), "B", chip, sure},
      {"L1 data", double(p.l1_bytes), "B", chip, sure},
      {"L1 ways", double(p.l1_ways), "", chip, kSecondHand},
      {"L1 hit", double(p.l1_hit_cycles), "cycles", "GCC", kPublished},
      {"L2", double(p.l2_bytes), "B", chip, sure},
      {"L2 ways", double(p.l2_ways), "", chip, sure},
      {"L2 hit", double(p.l2_hit_cycles), "cycles", xenon ? "39 to 40, widely repeated" : chip,
       xenon ? kLead : kPublished},
      {"L2 rate", p.l2_milli_bytes_per_cycle / 1000.0, "B/cycle",
       xenon ? "51.2 GB/s, IBM talk" : "taken from the Xenon", xenon ? kPublished : kLead},
      {"misses in flight, a core", double(p.outstanding_misses), "",
       xenon ? "Microsoft" : "taken from the Xenon", xenon ? kPublished : kLead},
      {"load-hit-store, up to", double(p.load_hit_store_cycles), "cycles", "Microsoft", kPublished},
      {"memory", double(p.memory_cycles), "cycles", "about 610, widely repeated", kLead},
      {"front-side bus, each way", p.bus_milli_bytes_per_cycle / 1000.0, "B/cycle",
       xenon ? "10.8 GB/s, Microsoft" : "25.6 GB/s, cellmark", kPublished},
      {"memory rate", p.memory_milli_bytes_per_cycle / 1000.0, "B/cycle",
       xenon ? "22.4 GB/s, Microsoft" : "25.6 GB/s, cellmark", kPublished},
      {"the GPU's share of memory", p.gpu_permille / 1000.0, "", "the caller's", kLead},
  };
}

bool CheckCacheMemory(const CacheMemoryParameters& p, std::string& error) {
  const auto refuse = [&](std::string why) {
    error = fmt::format("{} memory refused: {}", p.name, why);
    return false;
  };
  if (p.cores == 0 || p.threads_per_core == 0) return refuse("it has no core or no thread");
  if (!std::has_single_bit(p.line_bytes) || p.line_bytes > 4096)
    return refuse("lines must be a power of two of bytes, 4096 at most");
  const auto sets = [&](uint32_t bytes, uint32_t ways) {
    return ways > 0 && ways <= 1024 && bytes % (ways * p.line_bytes) == 0 &&
           std::has_single_bit(bytes / (ways * p.line_bytes));
  };
  if (!sets(p.l1_bytes, p.l1_ways))
    return refuse(fmt::format("an L1 of {} bytes and {} ways has no power of two of sets",
                              p.l1_bytes, p.l1_ways));
  if (!sets(p.l2_bytes, p.l2_ways))
    return refuse(fmt::format("an L2 of {} bytes and {} ways has no power of two of sets",
                              p.l2_bytes, p.l2_ways));
  if (p.outstanding_misses == 0) return refuse("a core needs at least one miss in flight");
  if (p.l2_milli_bytes_per_cycle == 0 || p.bus_milli_bytes_per_cycle == 0 ||
      p.memory_milli_bytes_per_cycle == 0 || p.dispatch_slot_cycles == 0)
    return refuse("a rate or a dispatch slot is zero");
  if (p.gpu_permille >= 1000) return refuse("the GPU takes all of the memory");
  return true;
}

}  // namespace pelt
