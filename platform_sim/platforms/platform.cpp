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
  const uint32_t beats = cell.line_bytes / std::max(cell.ring_bytes, 1u);
  p.memory_cycles = cell.ppe_caches.l2_hit_cycles + cell.snoop_cycles + cell.memory_access_cycles +
                    cell.memory_line_cycles + beats * cell.bus_cycle_cycles;
  p.memory_milli_bytes_per_cycle = cell.line_bytes * 1000 / std::max(cell.memory_line_cycles, 1u);
  p.bus_milli_bytes_per_cycle = cell.ring_bytes * 1000 / std::max(cell.bus_cycle_cycles, 1u);
  return p;
}

std::vector<PlatformNumber> DescribeCell(const CellParameters& cell) {
  using enum Sureness;
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
  const CacheParameters& c = cell.ppe_caches;
  append(
      "PPE: ",
      {{"L1 data", double(c.l1_bytes), "B", "cellmark, GCC", kPublished},
       {"L1 ways", double(c.l1_ways), "ways", "taken from the Xenon", kSecondHand},
       {"L2", double(c.l2_bytes), "B", "cellmark", kPublished},
       {"L2 ways", double(c.l2_ways), "ways", "cellmark", kPublished},
       {"L2 hit", double(c.l2_hit_cycles), "cycles",
        "cellmark: what row P3 leaves for an L1 miss, not a prediction", kPublished},
       {"L2 rate", c.l2_milli_bytes_per_cycle / 1000.0, "B/cycle", "taken from the Xenon", kLead},
       {"L1 filled by a line for", double(c.l1_fill_cycles), "cycles",
        "the line at the L2's rate; that loads wait meanwhile is the model's", kLead},
       {"misses in flight", double(c.outstanding_misses), "lines", "taken from the Xenon", kLead}});
  append("jobs: ", DescribeDispatch(cell.jobs));
  return out;
}

bool CheckPlatforms(const PlatformParameters& p, std::string& error) {
  return CheckCellMemory(p.cell, error) && CheckCacheMemory(PpeMemory(p.cell), error) &&
         CheckXenon(p.xenon, error);
}

}  // namespace pelt
