#include "platform_sim/platforms/cell_memory.hpp"

#include "core/format.hpp"

namespace pelt {
std::vector<PlatformNumber> DescribeCellMemory(const CellMemoryParameters& p) {
  std::vector<PlatformNumber> out;
  TellNumbers(p.runtime, out);
  TellNumbers<CellMemoryNumbers>(p, out);
  return out;
}

bool CheckCellMemory(const CellMemoryParameters& p, std::string& error) {
  const auto refuse = [&](std::string why) {
    error = "Cell platform refused: " + why;
    return false;
  };
  if (!CheckCellSystem(p, error)) return false;
  for (const PlatformNumber& n : DescribeCellMemory(p))
    if (n.value <= 0.0) return refuse(Format("'{}' is zero; it must be positive", n.name));
  if (p.local_store_bytes % p.largest_command_bytes != 0)
    return refuse(
        Format("a local store of {} bytes is not a multiple of the largest DMA "
               "command, {} bytes",
               p.local_store_bytes.value, p.largest_command_bytes.value));
  if (p.missing_spe[0] == p.missing_spe[1] || p.missing_spe[0] > 7 || p.missing_spe[1] > 7)
    return refuse("missing_spe must name two of the SPEs 0 to 7");
  if (p.first_spu > 5) return refuse("first_spu must be 0 to 5");
  if (p.rings < 2 || p.rings % 2 != 0 || p.rings > 4)
    return refuse(Format("{} EIB rings; it needs 2 or 4, half of them each way", p.rings.value));
  if (p.line_bytes % p.ring_bytes != 0 || (p.line_bytes & (p.line_bytes - 1)) != 0)
    return refuse(
        Format("lines of {} bytes; they must be a power of two and whole beats of "
               "{} bytes",
               p.line_bytes.value, p.ring_bytes.value));
  if (p.largest_command_bytes % 16 != 0 || p.tags > 32 || p.transfers_per_ring > 3)
    return refuse("commands are multiples of 16 bytes, at most 32 tags, 3 transfers a ring");
  if (p.refresh_cycles >= p.refresh_interval_cycles)
    return refuse("memory refresh takes all the memory's time");
  return true;
}

}  // namespace pelt
