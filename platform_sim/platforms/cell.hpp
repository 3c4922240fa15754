// The Cell in numbers: what all its parts share (clock, SPUs, local store, line), and its memory (local
// store, MFC, EIB, memory controller, L2 seen from the SPEs). The one place of these numbers; whoever
// models a part takes them from here. Plain structs, so that a test can plant a wrong number and see a
// measured row notice. The cores' are in spu.hpp and ppe.hpp.
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
//
// Memory: all times are cycles of the system's clock; a bus cycle is two of them. One set serves every
// row: nothing is fitted per row.
//
// Class L numbers (no source read): what makes up a DMA's latency, how many lines an MFC keeps in
// flight, what refresh and turning the memory's direction cost, which rings an SPE's neighbours
// hold. What they decide is the rate of one SPE alone and of mixed reads and writes; the rates of
// six SPEs that only read follow from the published ones and the refresh.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
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

struct CellMemoryNumbers {
  static constexpr std::string_view kSdk = "IBM SDK 3.0 tutorial";
  static constexpr std::string_view kKistler =
      "Kistler, Perrone, Petrini, IEEE Micro 2006: 290 cycles in all";
  static constexpr std::string_view kRings = "D. Krolak (IBM), interview, as quoted";
  static constexpr std::string_view kChen =
      "Chen et al., IBM J. R&D 51 (2007): 24.6 GB/s, mixed 21 GB/s";

  // MFC
  Number<uint32_t> largest_command_bytes = {16 * 1024, "largest DMA command", "B", kSdk};
  Number<uint32_t> queue_commands = {16, "DMA queue", "commands", kSdk};
  Number<uint32_t> list_elements = {2048, "DMA list", "elements", "CBE handbook, as quoted",
                                    Sureness::kSecondHand};
  Number<uint32_t> tags = {32, "tags", "tags", kSdk};
  // LSA, EAH, EAL, size, tag, command.
  Number<uint32_t> channels_per_command = {6, "channel operations of a command", "operations",
                                           kSdk};
  // Tag mask, update request, status.
  Number<uint32_t> channels_per_wait = {3, "channel operations of a wait", "operations", kSdk};
  // The MFC takes up a command; not overlapped with another's.
  Number<uint32_t> command_cycles = {30, "MFC takes up a command", "cycles", kKistler,
                                     Sureness::kLead};
  // And fetches a list element.
  Number<uint32_t> list_element_cycles = {10, "MFC fetches a list element", "cycles", kKistler,
                                          Sureness::kLead};
  // Of one MFC.
  Number<uint32_t> lines_in_flight = {16, "lines an MFC has in flight", "lines", "CBE handbook",
                                      Sureness::kLead};

  // EIB
  Number<uint32_t> bus_cycle_cycles = {2, "bus cycle", "cycles", "half clock, as quoted",
                                       Sureness::kSecondHand};
  // Half of them each way round.
  Number<uint32_t> rings = {4, "rings", "rings", "as quoted", Sureness::kSecondHand};
  Number<uint32_t> ring_bytes = {16, "ring width", "B/bus cycle", "as quoted",
                                 Sureness::kSecondHand};
  Number<uint32_t> transfers_per_ring = {3, "transfers on a ring", "transfers", "as quoted",
                                         Sureness::kSecondHand};
  // Between two starts on one ring.
  Number<uint32_t> ring_start_bus_cycles = {3, "starts on a ring, apart", "bus cycles", kRings,
                                            Sureness::kSecondHand};
  // A command's coherence phase; one starts each bus cycle.
  Number<uint32_t> snoop_cycles = {100, "snoop", "cycles", kKistler, Sureness::kLead};
  // Of a line in another SPE's local store, without the ring.
  Number<uint32_t> local_store_cycles = {118, "local store of another SPE", "cycles", kKistler,
                                         Sureness::kLead};

  // Memory controller, XDR, L2
  // 128 B at 8 B/cycle: 25.6 GB/s at 3.2 GHz.
  Number<uint32_t> memory_line_cycles = {16, "memory, a line", "cycles", "25.6 GB/s, cellmark"};
  // Of a line, without queue, snoop and ring.
  Number<uint32_t> memory_access_cycles = {438, "memory access", "cycles",
                                           "round trip about 180 ns", Sureness::kLead};
  Number<uint32_t> refresh_interval_cycles = {3200, "refresh and scrub every", "cycles",
                                              "the model's; only the share counts",
                                              Sureness::kLead};
  // Leaves 24.6 GB/s.
  Number<uint32_t> refresh_cycles = {125, "refresh and scrub take", "cycles", kChen,
                                     Sureness::kLead};
  // From reads to writes and back.
  Number<uint32_t> turnaround_cycles = {22, "memory turns its direction in", "cycles", kChen,
                                        Sureness::kLead};
  // Served one way before the other way has its turn.
  Number<uint32_t> turnaround_lines = {8, "lines one way before it turns", "lines", kChen,
                                       Sureness::kLead};
  // 128 B at 7 GB/s.
  Number<uint32_t> l2_line_cycles = {58, "L2, a line for an SPE", "cycles",
                                     "7 GB/s in all, Perrone, MIT 6.189, 2007"};

  // Through the operating system: one of the two calls that a mailbox round trip makes.
  Number<uint32_t> os_call_ns = {5800, "operating-system call", "ns",
                                 "cellmark: half the mailbox round trip S2, not a prediction"};
};

// What of an SPU's local store belongs to no kernel: the numbers of a program that was never
// shipped, so class L all of them.
struct SpuRuntimeParameters {
  // Draws items from the counter, makes and gives DMA lists, runs a pass's kernels.
  Number<uint32_t> code_bytes = {8 * 1024, "code of the loop over items", "B", "the model's",
                                 Sureness::kLead};
  // Kernels have no large arrays of their own and do not call each other.
  Number<uint32_t> stack_bytes = {8 * 1024, "stack", "B", "the model's", Sureness::kLead};
};

// The system, as its memory needs it, and the memory.
struct CellMemoryParameters : CellSystem, CellMemoryNumbers {
  SpuRuntimeParameters runtime = {};  // what of the local store is no kernel's
  // Ring stops 0 .. 11 are PPE, SPE1, SPE3, SPE5, SPE7, IOIF1, IOIF0, SPE6, SPE4, SPE2, SPE0, MIC.
  // A game's SPUs 0 .. 5 follow each other round the ring, and 3 further on is as far one way as
  // the other (cellmark, all 30 pairs): so the two SPEs that are not the game's lie opposite each
  // other. Which of the four such pairs, and which SPU is the first, it leaves open (class L).
  uint32_t missing_spe[2] = {0, 7};
  uint32_t first_spu = 0;  // how many SPEs that are the game's lie between the PPE and SPU 0
};

// The table that reports print: every number above with unit, source and how sure it is.
std::vector<PlatformNumber> DescribeCellMemory(const CellMemoryParameters& p);

// False, and why in `error`, for a platform that cannot be or that no fur runs on.
bool CheckCellMemory(const CellMemoryParameters& p, std::string& error);

}  // namespace pelt
