// Both consoles in numbers, every number once: what reports, the measured rows and the frame model
// start from. Whoever asks "what if" changes it here, once, and every model follows.
//
//   CellParameters            clock, SPUs, line ...  (CellSystem)   spu: the SPU's core
//                             MFC, EIB, memory       (CellMemoryParameters)
//                             ppe, ppe_caches, jobs
//   XenonParameters           clock ...; caches, bus, memory (CacheMemoryParameters); core: its
//   core
#pragma once

#include <string>
#include <vector>

#include "platform_sim/platforms/cell.hpp"
#include "platform_sim/platforms/dispatch.hpp"
#include "platform_sim/platforms/gpu.hpp"
#include "platform_sim/platforms/xenon.hpp"

namespace pelt {

inline constexpr CacheParameters kPpeCaches = {
    .l1_bytes = {32 * 1024, "L1 data", "B", "cellmark, GCC"},
    .l1_ways = {4, "L1 ways", "ways", "taken from the Xenon", Sureness::kSecondHand},
    .l2_bytes = {512 * 1024, "L2", "B", "cellmark"},
    .l2_ways = {8, "L2 ways", "ways", "cellmark"},
    .l2_hit_cycles = {42, "L2 hit", "cycles",
                      "cellmark: what row P3 leaves for an L1 miss, not a prediction"},
    .l2_milli_bytes_per_cycle = {16000, "L2 rate", "B/cycle", "taken from the Xenon",
                                 Sureness::kLead, 1e-3},
    .outstanding_misses = {8, "misses in flight", "lines", "taken from the Xenon", Sureness::kLead},
    .l1_fill_cycles = {8, "L1 filled by a line for", "cycles",
                       "the line at the L2's rate; that loads wait meanwhile is the model's",
                       Sureness::kLead},
};

struct CellParameters : CellMemoryParameters {
  PpeParameters ppe;
  CacheParameters ppe_caches = kPpeCaches;
  DispatchParameters jobs = kGcellDispatch;
  GpuParameters gpu = kRsx;
};

// The PPE's caches as the cache model takes them. Line, bus and memory are the Cell's; the way to
// memory is the L2's look-up, then what an SPU's line takes.
CacheMemoryParameters PpeMemory(const CellParameters& cell = {});

struct PlatformParameters {
  CellParameters cell;
  XenonParameters xenon;
};

// Every number of a console with unit, source and how sure it is; class L ones are `kLead`.
std::vector<PlatformNumber> DescribeCell(const CellParameters& cell);

// False, and why in `error`, for a console that cannot be.
bool CheckPlatforms(const PlatformParameters& p, std::string& error);

}  // namespace pelt
