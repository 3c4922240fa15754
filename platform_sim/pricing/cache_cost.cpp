#include "platform_sim/pricing/cache_cost.hpp"

#include <algorithm>
#include <unordered_set>
#include <vector>

#include "platform_sim/memory/xenon_memory.hpp"

namespace pelt {
namespace {

using Accesses = std::vector<MemoryAccess>;

constexpr uint64_t kThreadSpace = uint64_t{1} << 32;  // threads share no line
constexpr uint32_t kFreeMilliBytesPerCycle = 1'000'000'000;

// Every line is in the second level: whoever misses the first waits for no longer way than that.
CacheMemoryParameters AllInSecondLevel(CacheMemoryParameters p) {
  p.l2_milli_bytes_per_cycle =
      std::max(p.l2_milli_bytes_per_cycle / p.cores, 1u);  // a core's share
  p.cores = 1;
  p.memory_cycles = p.l2_hit_cycles;
  p.bus_milli_bytes_per_cycle = p.memory_milli_bytes_per_cycle = kFreeMilliBytesPerCycle;
  p.gpu_permille = 0;
  return p;
}

Accesses AccessesOf(const Trace& trace, double cycles, uint64_t space) {
  Accesses out;
  const double pace = cycles / double(std::max<size_t>(trace.operations.size(), 1));
  for (size_t o = 0; o < trace.operations.size(); ++o) {
    const RecordedOperation& operation = trace.operations[o];
    if (!IsLoad(operation.kind) && !IsStore(operation.kind)) continue;
    MemoryAccess access;
    access.kind = IsStore(operation.kind) ? AccessKind::kStore : AccessKind::kLoad;
    access.bytes = operation.size_bytes;
    access.address = space + uint64_t(operation.address);
    access.cycle = Cycles(double(o) * pace);
    out.push_back(access);
  }
  return out;
}

// A dcbt ahead of the first load of each line.
Accesses WithPrefetches(const Accesses& accesses, const CacheMemoryParameters& p, uint64_t& lines) {
  std::unordered_set<uint64_t> seen;  // asked only, never walked
  Accesses out;
  for (const MemoryAccess& access : accesses) {
    const uint64_t line = access.address / p.line_bytes;
    if (access.kind != AccessKind::kLoad || !seen.insert(line).second) continue;
    MemoryAccess fetch;
    fetch.kind = AccessKind::kPrefetch;
    fetch.address = line * p.line_bytes;
    fetch.bytes = p.line_bytes;
    fetch.cycle = std::max<Cycles>(access.cycle - 2 * Cycles(p.l2_hit_cycles), 0);
    out.push_back(fetch);
  }
  lines = out.size();
  const auto fetches = Accesses::difference_type(out.size());
  out.insert(out.end(), accesses.begin(), accesses.end());
  std::inplace_merge(out.begin(), out.begin() + fetches, out.end(),
                     [](const auto& a, const auto& b) { return a.cycle < b.cycle; });
  return out;
}

Cycles Waits(const CacheMemoryRun& run) {
  Cycles most = 0;
  for (const ThreadMemoryTimes& thread : run.threads)
    most = std::max(most, thread.Stall() - thread.load_hit_store_stall);
  return most;
}

}  // namespace

Result<CacheCost> PriceCaches(const Trace& trace, uint32_t iterations, double cycles_per_iteration,
                              uint32_t threads, const CacheMemoryParameters& caches) {
  const CacheMemoryParameters p = AllInSecondLevel(caches);
  std::vector<Accesses> bare, fetched;
  uint64_t lines = 0;
  for (uint32_t t = 0; t < threads; ++t) {
    bare.push_back(AccessesOf(trace, cycles_per_iteration * iterations, t * kThreadSpace));
    fetched.push_back(WithPrefetches(bare.back(), p, lines));
  }
  CacheMemoryRun bare_run, fetched_run;
  std::string error;
  if (!RunCacheMemory(p, bare, bare_run, error) || !RunCacheMemory(p, fetched, fetched_run, error))
    return Failure{error};
  const double per_iteration = 1.0 / std::max(iterations, 1u);
  CacheCost cost;
  cost.lines_per_iteration = double(lines) * per_iteration;
  // Each dcbt takes a cycle of the unit that loads and stores.
  cost.wait_cycles_per_iteration = double(Waits(fetched_run) + Cycles(lines)) * per_iteration;
  cost.unfetched_wait_cycles_per_iteration = double(Waits(bare_run)) * per_iteration;
  return cost;
}

}  // namespace pelt
