// The Xenon's (and the PPE's) memory, fed by the addresses that a thread touches.
//
//   thread 0 1   2 3   4 5      L1: 32 KB per core, both threads; stores go through and do not fill
//   it
//        [L1]   [L1]   [L1]     L2: shared, written back; then front-side bus, each way its own
//        rate;
//        ------[ L2 ]------     then memory, one rate for both ways, shared with the GPU
//
// A trace says when a thread would touch what if memory were free: the times of the core model, L1
// hits included. Out comes by how much it is later. In order: a load stalls its thread until the
// data is there, less the cycles until its first use; stores stall only when too many misses are
// out. A load of bytes that were stored less than `load_hit_store_cycles` ago waits for that store
// to leave the queue: a load-hit-store.
//
// Not modelled: instruction fetch, TLB, the store queue's depth, coherence traffic between L1s
// beyond dropping the line another core writes, the L2's banks, DRAM pages and direction changes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "platform_sim/memory/event_queue.hpp"
#include "platform_sim/platforms/xenon.hpp"

namespace pelt {

// One set-associative cache: which lines are in it, which go. Least recently used goes first.

class Cache {
 public:
  struct Evicted {
    bool any = false, dirty = false;
    uint64_t line = 0;
  };

  Cache(uint32_t bytes, uint32_t ways, uint32_t line_bytes)
      : ways_(ways), sets_(bytes / (ways * line_bytes)), entries_(size_t(ways_) * sets_) {}

  // Is line number `line` here? Marks it used, and dirty if asked to.
  bool Touch(uint64_t line, bool dirty);
  // Puts it here; what had to go is returned.
  Evicted Fill(uint64_t line, bool dirty);
  // Drops it, without a word about what it held.
  void Drop(uint64_t line);

 private:
  struct Entry {
    uint64_t line = ~uint64_t{0};
    uint64_t used = 0;
    bool dirty = false;
  };
  Entry* Find(uint64_t line);

  uint32_t ways_, sets_;
  uint64_t clock_ = 0;
  std::vector<Entry> entries_;
};

enum class AccessKind : uint8_t {
  kLoad,
  kStore,
  kPrefetch,  // dcbt: fetches the line and stalls nothing
  kLineZero,  // dcbz: makes a line of zeros in L2 without reading it
};

struct MemoryAccess {
  AccessKind kind = AccessKind::kLoad;
  uint32_t bytes = 4;
  uint64_t address = 0;
  Cycles cycle = 0;       // not before the access in front of it
  Cycles use_cycles = 0;  // of a load: from its L1 hit to the first use of what it loads
};

struct ThreadMemoryTimes {
  uint64_t loads = 0, stores = 0;
  uint64_t l1_misses = 0, l2_misses = 0;  // of loads
  uint64_t store_l2_misses = 0;
  uint64_t prefetches = 0;
  uint64_t load_hit_stores = 0;
  Cycles l2_stall = 0, memory_stall = 0, miss_queue_stall = 0, load_hit_store_stall = 0;
  Cycles finish = 0;  // when its last access is through

  Cycles Stall() const { return l2_stall + memory_stall + miss_queue_stall + load_hit_store_stall; }
};

struct CacheMemoryRun {
  std::vector<ThreadMemoryTimes> threads;
  uint64_t bus_read_bytes = 0, bus_write_bytes = 0;  // memory moves the sum of both
  uint64_t l2_bytes = 0;                             // lines and stores that L1 and L2 exchange
  Cycles finish = 0;
};

// Runs trace t on hardware thread t; threads 2c and 2c + 1 share core c. False, and why in `error`,
// for caches that cannot be, more traces than threads, or an access that goes back in time or is
// larger than a line.
bool RunCacheMemory(const CacheMemoryParameters& p,
                    std::span<const std::vector<MemoryAccess>> traces, CacheMemoryRun& run,
                    std::string& error);

}  // namespace pelt
