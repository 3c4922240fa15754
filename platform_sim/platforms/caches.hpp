// The numbers of the caches and the memory behind the PPE and its sister, the Xenon's three cores.
// Numbers only; a plain struct, so that a test can plant a wrong one. What belongs to the core (the
// cycles of an L1 hit, load-hit-store, threads and their turns) is in `core`, once.
//
// Rates are thousandths of a byte per cycle of the system's clock.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "platform_sim/platforms/number.hpp"
#include "platform_sim/platforms/ppe.hpp"

namespace pelt {

inline constexpr std::string_view kXenonTalks = "IBM, Microsoft talks, as reported";

// What L1 and L2 are, independent of what lies around them: a Xenon's, where nothing else is said.
struct CacheParameters {
  Number<uint32_t> l1_bytes = {32 * 1024, "L1 data", "B", kXenonTalks, Sureness::kSecondHand};
  Number<uint32_t> l1_ways = {4, "L1 ways", "ways", kXenonTalks, Sureness::kSecondHand};
  Number<uint32_t> l2_bytes = {1024 * 1024, "L2", "B", kXenonTalks, Sureness::kSecondHand};
  Number<uint32_t> l2_ways = {8, "L2 ways", "ways", kXenonTalks, Sureness::kSecondHand};
  Number<uint32_t> l2_hit_cycles = {40, "L2 hit", "cycles", "39 to 40, widely repeated",
                                    Sureness::kLead};
  Number<uint32_t> l2_milli_bytes_per_cycle = {
      16000, "L2 rate", "B/cycle", "51.2 GB/s, IBM talk", Sureness::kPublished, 1e-3};
  Number<uint32_t> outstanding_misses = {8, "misses in flight, a core", "lines", "Microsoft"};
  // For which a line that was fetched ahead keeps loads out of L1 while it comes in. What a load
  // that misses waits is l2_hit_cycles, all in all.
  Number<uint32_t> l1_fill_cycles = {0, "L1 filled by a line for", "cycles",
                                     "nothing is known of a Xenon's", Sureness::kLead};
};

// What lies around them.
struct MemoryNumbers {
  Number<uint32_t> cores = {3, "cores", "cores", kXenonTalks, Sureness::kSecondHand};
  Number<uint32_t> line_bytes = {128, "line", "B", kXenonTalks, Sureness::kSecondHand};
  Number<uint32_t> memory_cycles = {610, "memory", "cycles", "about 610, widely repeated",
                                    Sureness::kLead};
  Number<uint32_t> bus_milli_bytes_per_cycle = {
      3375, "front-side bus, each way", "B/cycle", "10.8 GB/s, Microsoft", Sureness::kPublished,
      1e-3};
  Number<uint32_t> memory_milli_bytes_per_cycle = {
      7000, "memory rate", "B/cycle", "22.4 GB/s, Microsoft", Sureness::kPublished, 1e-3};
  Number<uint32_t> gpu_permille = {
      0, "the GPU's share of memory", "of the rate", "the caller's", Sureness::kLead, 1e-3};
};

// All that the cache model takes.
struct CacheMemoryParameters : CacheParameters, MemoryNumbers {
  std::string_view name;
  PpeParameters core;

  uint32_t Threads() const { return cores * core.smt_threads; }
};

// False, and why in `error`, for caches that cannot be.
bool CheckCacheMemory(const CacheMemoryParameters& p, std::string& error);

}  // namespace pelt
