#include "platform_sim/platforms/caches.hpp"

#include <bit>

#include "core/format.hpp"

namespace pelt {
namespace {

// Of one L2 and one memory: an Xbox 360 has 3 cores of 2 threads.
constexpr uint32_t kMostCores = 16, kMostThreadsOfACore = 4;

}  // namespace

bool CheckCacheMemory(const CacheMemoryParameters& p, std::string& error) {
  const auto refuse = [&](std::string why) {
    error = Format("{} memory refused: {}", p.name, why);
    return false;
  };
  if (p.cores == 0 || p.core.smt_threads == 0)
    return refuse(Format("{} cores of {} threads: it has no core or no thread; give it one",
                         p.cores.value, p.core.smt_threads.value));
  if (p.cores > kMostCores || p.core.smt_threads > kMostThreadsOfACore)
    return refuse(Format("{} cores of {} threads; at most {} of {} are modelled", p.cores.value,
                         p.core.smt_threads.value, kMostCores, kMostThreadsOfACore));
  if (!std::has_single_bit(p.line_bytes.value) || p.line_bytes > 4096)
    return refuse("lines must be a power of two of bytes, 4096 at most");
  const auto sets = [&](uint32_t bytes, uint32_t ways) {
    return ways > 0 && ways <= 1024 && bytes % (ways * p.line_bytes) == 0 &&
           std::has_single_bit(bytes / (ways * p.line_bytes));
  };
  if (!sets(p.l1_bytes, p.l1_ways))
    return refuse(Format("an L1 of {} bytes and {} ways has no power of two of sets",
                         p.l1_bytes.value, p.l1_ways.value));
  if (!sets(p.l2_bytes, p.l2_ways))
    return refuse(Format("an L2 of {} bytes and {} ways has no power of two of sets",
                         p.l2_bytes.value, p.l2_ways.value));
  if (p.outstanding_misses == 0) return refuse("a core needs at least one miss in flight");
  if (p.l2_milli_bytes_per_cycle == 0 || p.bus_milli_bytes_per_cycle == 0 ||
      p.memory_milli_bytes_per_cycle == 0)
    return refuse("a rate is zero");
  if (p.gpu_permille >= 1000)
    return refuse(
        Format("its GPU takes {} of 1000 parts of the memory's rate; leave the cores "
               "some of it, 999 at most",
               p.gpu_permille.value));
  return true;
}

}  // namespace pelt
