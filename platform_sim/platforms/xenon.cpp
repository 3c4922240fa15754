#include "platform_sim/platforms/xenon.hpp"

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

std::vector<PlatformNumber> DescribeXenon(const XenonParameters& p) {
  std::vector<PlatformNumber> out = {TellNumber(p.clock_hz), TellNumber(p.availability_permille)};
  TellNumbers<MemoryNumbers>(p, out);
  TellNumbers<CacheParameters>(p, out);
  for (PlatformNumber& number : DescribeNumbers(p.core)) out.push_back(std::move(number));
  TellNumbers<GpuNumbers>(p.gpu, out);
  TellNumbers<ShaderNumbers>({}, out);
  return out;
}

bool CheckXenon(const XenonParameters& p, std::string& error) {
  if (!CheckCacheMemory(p, error)) return false;
  if (p.cores > kMostXenonCores) {
    error = Format("Xenon refused: it has {} cores; an Xbox 360 has {}", p.cores.value,
                   kMostXenonCores);
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
