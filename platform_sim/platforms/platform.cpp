#include "platform_sim/platforms/platform.hpp"

#include "platform_sim/local_store.hpp"

namespace pelt {

// What the executor with real local stores runs in is what the platform says there is.
static_assert(CellSystem{}.local_store_bytes == kLocalStoreBytes);

CacheMemoryParameters PpeMemory(const CellParameters& cell) {
  CacheMemoryParameters p;
  static_cast<CacheParameters&>(p) = cell.ppe_caches;
  p.name = "PPE";
  p.core = cell.ppe;
  p.cores = 1;
  p.line_bytes = cell.line_bytes;
  const uint32_t beats = cell.line_bytes / std::max(cell.ring_bytes.value, 1u);
  p.memory_cycles = cell.ppe_caches.l2_hit_cycles + cell.snoop_cycles + cell.memory_access_cycles +
                    cell.memory_line_cycles + beats * cell.bus_cycle_cycles;
  p.memory_milli_bytes_per_cycle =
      cell.line_bytes * 1000 / std::max(cell.memory_line_cycles.value, 1u);
  p.bus_milli_bytes_per_cycle = cell.ring_bytes * 1000 / std::max(cell.bus_cycle_cycles.value, 1u);
  return p;
}

std::vector<PlatformNumber> DescribeCell(const CellParameters& cell) {
  std::vector<PlatformNumber> out = DescribeCellSystem(cell);
  const auto append = [&](std::string_view of, std::vector<PlatformNumber> numbers) {
    for (PlatformNumber& number : numbers) {
      number.name = std::string(of) + number.name;
      out.push_back(std::move(number));
    }
  };
  append("SPU: ", DescribeNumbers(cell.spu));
  append("", DescribeCellMemory(cell));
  append("PPE: ", DescribeNumbers(cell.ppe));
  TellNumbers(cell.ppe_caches, out, "PPE: ");
  TellNumbers<DispatchNumbers>(cell.jobs, out, "jobs: ");
  TellNumbers<GpuNumbers>(cell.gpu, out);
  TellNumbers<ShaderNumbers>({}, out);
  return out;
}

bool CheckPlatforms(const PlatformParameters& p, std::string& error) {
  return CheckCellMemory(p.cell, error) && CheckCacheMemory(PpeMemory(p.cell), error) &&
         CheckXenon(p.xenon, error);
}

}  // namespace pelt
