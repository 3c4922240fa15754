#include "platform_sim/platforms/xenon_memory.hpp"

#include "core/format.hpp"

namespace pelt {

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
