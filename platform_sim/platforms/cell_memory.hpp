// The numbers of the Cell's memory: local store, MFC, EIB, memory controller, L2 seen from the
// SPEs. Numbers only; a plain struct, so that a test can plant a wrong one and see a measured row
// notice.
//
// All times are cycles of the system's clock; a bus cycle is two of them. One set serves every row:
// nothing is fitted per row.
//
// Class L numbers (no source read): what makes up a DMA's latency, how many lines an MFC keeps in
// flight, what refresh and turning the memory's direction cost, which rings an SPE's neighbours
// hold. What they decide is the rate of one SPE alone and of mixed reads and writes; the rates of
// six SPEs that only read follow from the published ones and the refresh.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "platform_sim/platforms/cell_system.hpp"
#include "platform_sim/platforms/spu_runtime.hpp"

namespace pelt {

// The system, as its memory needs it, and the memory.
struct CellMemoryParameters : CellSystem {
  SpuRuntimeParameters runtime;  // what of the local store is no kernel's

  // MFC
  uint32_t largest_command_bytes = 16 * 1024;
  uint32_t queue_commands = 16;
  uint32_t list_elements = 2048;
  uint32_t tags = 32;
  uint32_t channels_per_command = 6;  // LSA, EAH, EAL, size, tag, command
  uint32_t channels_per_wait = 3;     // tag mask, update request, status
  uint32_t command_cycles = 30;       // the MFC takes up a command; not overlapped with another's
  uint32_t list_element_cycles = 10;  // and fetches a list element
  uint32_t lines_in_flight = 16;      // of one MFC

  // EIB
  uint32_t bus_cycle_cycles = 2;
  uint32_t rings = 4;  // half of them each way round
  uint32_t ring_bytes = 16;
  uint32_t transfers_per_ring = 3;
  uint32_t ring_start_bus_cycles = 3;  // between two starts on one ring
  uint32_t snoop_cycles = 100;         // a command's coherence phase; one starts each bus cycle
  uint32_t local_store_cycles = 118;   // of a line in another SPE's local store, without the ring
  // Ring stops 0 .. 11 are PPE, SPE1, SPE3, SPE5, SPE7, IOIF1, IOIF0, SPE6, SPE4, SPE2, SPE0, MIC.
  // A game's SPUs 0 .. 5 follow each other round the ring, and 3 further on is as far one way as
  // the other (cellmark, all 30 pairs): so the two SPEs that are not the game's lie opposite each
  // other. Which of the four such pairs, and which SPU is the first, it leaves open (class L).
  uint32_t missing_spe[2] = {0, 7};
  uint32_t first_spu = 0;  // how many SPEs that are the game's lie between the PPE and SPU 0

  // Memory controller, XDR, L2
  uint32_t memory_line_cycles = 16;     // 128 B at 8 B/cycle: 25.6 GB/s at 3.2 GHz
  uint32_t memory_access_cycles = 438;  // of a line, without queue, snoop and ring
  uint32_t refresh_interval_cycles = 3200;
  uint32_t refresh_cycles = 125;    // leaves 24.6 GB/s
  uint32_t turnaround_cycles = 22;  // from reads to writes and back
  uint32_t turnaround_lines = 8;    // lines served one way before the other way has its turn
  uint32_t l2_line_cycles = 58;     // 128 B at 7 GB/s

  // Through the operating system
  uint32_t os_call_ns = 5800;  // one of the two that a mailbox round trip makes
};

// The table that reports print: every number above with unit, source and how sure it is.
std::vector<PlatformNumber> DescribeCellMemory(const CellMemoryParameters& p);

// False, and why in `error`, for a platform that cannot be or that no fur runs on.
bool CheckCellMemory(const CellMemoryParameters& p, std::string& error);

}  // namespace pelt
