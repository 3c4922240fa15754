// What all parts of a Cell share: clock, SPUs, local store, line. The one place of these numbers;
// whoever models a part takes them from here.
//
// Clock: 3.192 GHz. A retail PS3's timebase counts at 79.8 MHz, a fortieth of the clock (cellmark),
// and the rows of consoles.md are a retail PS3's; "3.2 GHz" is the round figure. The quarter of a
// percent between them moves no row over its limit, which a test holds.
//
// Availability: measured throughput kernels reach this part of what the exact issue model says, the
// same for every kernel, cause unknown (cellmark; P, derived). No model applies it: cores, memory
// and frames are timed without. It is applied in two places, and both report their figures with and
// without: to the measured rows of work held up over many iterations (RowKind), and to a frame, for
// the verdict whether it fits (ConsoleMachine::Available), on every console alike.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "platform_sim/platforms/number.hpp"
#include "platform_sim/platforms/spu.hpp"

namespace pelt {

struct CellSystemNumbers {
  Number<uint32_t> spu_count = {6, "SPEs a game can use", "SPEs", "cellmark"};
  Number<uint32_t> local_store_bytes = {256 * 1024, "local store", "B", "IBM SDK 3.0 tutorial"};
  // Of the bus, the memory and the PPE's caches.
  Number<uint32_t> line_bytes = {128, "line", "B", "IBM SDK 3.0 tutorial"};
  Number<uint32_t> availability_permille = {
      920, "availability", "of a rate", "cellmark, derived", Sureness::kPublished, 1e-3};
};

struct CellSystem : CellSystemNumbers {
  Number<uint64_t> clock_hz = {3'192'000'000, "clock", "Hz", "cellmark: timebase x 40"};
  SpuParameters spu = {};

  double Availability() const { return availability_permille / 1000.0; }
  double GigaHertz() const { return double(clock_hz) * 1e-9; }
  double Nanoseconds(double cycles) const { return cycles / GigaHertz(); }
  uint32_t ChannelCycles() const { return spu.Of(SpuClass::kChannel).latency_cycles; }
};

std::vector<PlatformNumber> DescribeCellSystem(const CellSystem& cell);

// False, and why in `error`, for a system that cannot be or that no fur runs on.
bool CheckCellSystem(const CellSystem& cell, std::string& error);

}  // namespace pelt
