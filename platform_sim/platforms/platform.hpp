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

#include "platform_sim/platforms/cell_memory.hpp"
#include "platform_sim/platforms/dispatch.hpp"
#include "platform_sim/platforms/xenon_memory.hpp"

namespace pelt {

struct CellParameters : CellMemoryParameters {
  PpeParameters ppe;
  // A line fills L1 at the L2's rate, 16 bytes a cycle.
  CacheParameters ppe_caches{.l2_bytes = 512 * 1024, .l2_hit_cycles = 42, .l1_fill_cycles = 8};
  DispatchParameters jobs = kGcellDispatch;
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
