#include "platform_sim/platforms/cell_system.hpp"

#include <bit>

#include "core/format.hpp"

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

}  // namespace pelt
