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

// What L1 and L2 are, whatever lies around them.
struct CacheParameters {
  uint32_t l1_bytes = 32 * 1024;
  uint32_t l1_ways = 4;
  uint32_t l2_bytes = 1024 * 1024;
  uint32_t l2_ways = 8;
  uint32_t l2_hit_cycles = 40;
  uint32_t l2_milli_bytes_per_cycle = 16000;
  uint32_t outstanding_misses = 8;  // of a core
  // For which a line that was fetched ahead keeps loads out of L1 while it comes in. What a load
  // that misses waits is l2_hit_cycles, all in all. Nothing is known of a Xenon's.
  uint32_t l1_fill_cycles = 0;
};

// All that the cache model takes.
struct CacheMemoryParameters : CacheParameters {
  std::string_view name;
  PpeParameters core;
  uint32_t cores = 1;
  uint32_t line_bytes = 128;
  uint32_t memory_cycles = 610;
  uint32_t bus_milli_bytes_per_cycle = 3375;     // each way
  uint32_t memory_milli_bytes_per_cycle = 7000;  // both ways, shared with the GPU
  uint32_t gpu_permille = 0;                     // of the memory, taken by the GPU

  uint32_t Threads() const { return cores * core.smt_threads; }
};

// False, and why in `error`, for caches that cannot be.
bool CheckCacheMemory(const CacheMemoryParameters& p, std::string& error);

}  // namespace pelt
