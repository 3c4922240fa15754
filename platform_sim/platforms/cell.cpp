#include "platform_sim/platforms/cell.hpp"

#include <bit>

#include "core/format.hpp"
#include "platform_sim/platforms/ppe.hpp"

namespace pelt {
namespace {

constexpr uint32_t kMostLocalStoreBytes = 256 * 1024;
constexpr uint32_t kLeastLocalStoreBytes = 64 * 1024;
constexpr uint32_t kMostSpus = 6;
// The widest margin that is still a Cell: prototypes ran at 2.1 GHz.
constexpr uint64_t kLeastClockHz = 100'000'000, kMostClockHz = 10'000'000'000;

}  // namespace

std::vector<PlatformNumber> DescribeCellSystem(const CellSystem& cell) {
  std::vector<PlatformNumber> out = {TellNumber(cell.clock_hz)};
  TellNumbers<CellSystemNumbers>(cell, out);
  return out;
}

bool CheckCellSystem(const CellSystem& cell, std::string& error) {
  const auto refuse = [&](std::string why) {
    error = "Cell platform refused: " + why;
    return false;
  };
  if (cell.spu_count == 0) return refuse("it has no SPU; a retail PS3 gives a game 6");
  if (cell.spu_count > kMostSpus)
    return refuse(Format("it has {} SPUs; a retail PS3 gives a game at most {}",
                         cell.spu_count.value, kMostSpus));
  if (cell.local_store_bytes < kLeastLocalStoreBytes)
    return refuse(
        Format("a local store of {} bytes holds no kernel with its double-buffered "
               "chunks; at least {} are needed, a Cell has 262144",
               cell.local_store_bytes.value, kLeastLocalStoreBytes));
  if (cell.local_store_bytes > kMostLocalStoreBytes)
    return refuse(Format("a local store of {} bytes; a Cell has {}, and no more can be executed",
                         cell.local_store_bytes.value, kMostLocalStoreBytes));
  if (cell.clock_hz < kLeastClockHz || cell.clock_hz > kMostClockHz)
    return refuse(Format("a clock of {} Hz; {} to {} make sense, a retail PS3's is 3192000000",
                         cell.clock_hz.value, kLeastClockHz, kMostClockHz));
  if (!std::has_single_bit(cell.line_bytes.value) || cell.line_bytes < 16 || cell.line_bytes > 4096)
    return refuse(Format("lines of {} bytes; they must be a power of two from 16 to 4096",
                         cell.line_bytes.value));
  if (cell.availability_permille == 0 || cell.availability_permille > 1000)
    return refuse(Format("an availability of {} permille; it must be 1 to 1000",
                         cell.availability_permille.value));
  if (cell.ChannelCycles() == 0) return refuse("a channel operation takes no time");
  return true;
}

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

// The cores' (spu.hpp, ppe.hpp).

std::vector<PlatformNumber> DescribeNumbers(const SpuParameters& spu) {
  std::vector<PlatformNumber> out;
  for (const SpuClassParameters& c : spu.classes) {
    const char* pipe = c.pipe == SpuPipe::kEven ? "even" : "odd";
    out.push_back({Format("{} latency ({} pipe: {})", c.name, pipe, c.operations),
                   double(c.latency_cycles), "cycles", c.source, c.sure});
    if (c.stall_cycles)
      out.push_back({Format("{} stall of both pipes", c.name), double(c.stall_cycles), "cycles",
                     c.source, c.sure});
  }
  TellNumbers<SpuNumbers>(spu, out);
  return out;
}

std::vector<PlatformNumber> DescribeNumbers(const PpeParameters& ppe) {
  std::vector<PlatformNumber> out;
  for (const PpeClassParameters& c : ppe.classes)
    out.push_back({Format("{} latency{}", c.name, c.blocks_units ? ", not pipelined" : ""),
                   double(c.latency_cycles), "cycles", c.source, c.sure});
  TellNumbers<PpeNumbers>(ppe, out);
  return out;
}

}  // namespace pelt
