// What first-level caches add to a kernel's price, from the addresses that its recording touched.
//
// A frame brings an item's blocks into the second level while the item before it is worked on
// (frame/xenon_console.cpp). From there a kernel brings each line into the first level by a dcbt,
// as early as two times the way takes: that is one more instruction on the load/store unit for each
// line, and what waiting is left where lines come faster than misses may be outstanding, or than
// the second level gives them. Without the dcbt the first load of every line waits: both are told.
//
// Invariant: the trace runs at the pace of its scheduled code, evenly. Load-hit-stores are not in
// it: the core's issue model has counted them.
#pragma once

#include <optional>
#include <string>

#include "core/error.hpp"
#include "platform_sim/platforms/caches.hpp"
#include "platform_sim/pricing/recorded_operation.hpp"

namespace pelt {

struct CacheCost {
  double lines_per_iteration = 0.0;                  // that come into the first level
  double wait_cycles_per_iteration = 0.0;            // with a dcbt for each line: what is added
  double unfetched_wait_cycles_per_iteration = 0.0;  // without
};

// One item of `iterations` iterations that takes `cycles_per_iteration` when every access hits the
// first level.
// `threads`: that do the same on one core at the same time, each on data of its own. Caches
// that cannot be are refused.
Result<CacheCost> PriceCaches(const Trace& trace, uint32_t iterations, double cycles_per_iteration,
                              uint32_t threads, const CacheMemoryParameters& caches);

}  // namespace pelt
