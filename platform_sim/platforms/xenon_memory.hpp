// The numbers of the caches and the memory behind the PPE and its sister, the Xenon's three cores.
// Numbers only; a plain struct, so that a test can plant a wrong one.
//
// Class L (no source read): the Xenon's latencies to L2 and memory and the PPE's to memory. There
// are few public Xenon measurements: its rows stand on the PPE's and on Microsoft's figures, not on
// an Xbox 360. Rates are thousandths of a byte per cycle of the 3.2 GHz clock.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "platform_sim/platforms/number.hpp"

namespace pelt {

struct CacheMemoryParameters {
  std::string_view name;
  uint32_t clock_mhz = 3200;
  uint32_t cores = 3;
  uint32_t threads_per_core = 2;
  uint32_t dispatch_slot_cycles = 2;  // the threads alternate: a thread goes on every other cycle
  uint32_t availability_permille = 920;

  uint32_t line_bytes = 128;
  uint32_t l1_bytes = 32 * 1024;
  uint32_t l1_ways = 4;
  uint32_t l1_hit_cycles = 5;  // load to use
  uint32_t l2_bytes = 1024 * 1024;
  uint32_t l2_ways = 8;
  uint32_t l2_hit_cycles = 40;
  uint32_t l2_milli_bytes_per_cycle = 16000;  // 51.2 GB/s
  uint32_t outstanding_misses = 8;            // of a core
  uint32_t load_hit_store_cycles = 40;        // a store's bytes can be loaded so long after it

  uint32_t memory_cycles = 610;
  uint32_t bus_milli_bytes_per_cycle = 3375;     // 10.8 GB/s, each way
  uint32_t memory_milli_bytes_per_cycle = 7000;  // 22.4 GB/s, both ways, shared with the GPU
  uint32_t gpu_permille = 0;                     // of the memory, taken by the GPU
};

CacheMemoryParameters XenonMemory();
CacheMemoryParameters PpeMemory();

std::vector<PlatformNumber> DescribeCacheMemory(const CacheMemoryParameters& p);

// False, and why in `error`, for caches that cannot be.
bool CheckCacheMemory(const CacheMemoryParameters& p, std::string& error);

}  // namespace pelt
