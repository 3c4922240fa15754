// What handing out work costs: the numbers of job queues on the Cell and of the Xenon's locks.
// Numbers only; a plain struct, so that a test can plant a wrong one.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "platform_sim/platforms/number.hpp"

namespace pelt {

// One PPE thread hands jobs to the SPEs, one after another; each SPE then spends something on its
// own for every job.
struct DispatchParameters {
  std::string_view name;
  uint32_t ppe_job_ns;      // of the PPE, for every job; nothing else is dispatched meanwhile
  uint32_t spe_job_ns;      // of the SPE, for every job, beside the work
  uint32_t jobs_ahead = 2;  // of an SPE: the job it runs and those that wait for it
};

// GNU Radio's gcell (2007): jobs through shared queues, completion told through the OS.
inline constexpr DispatchParameters kGcellDispatch = {"gcell", 22000, 1000};
// SPEs that draw the next job's number from an atomic line; the PPE only starts them. `draw_ns`:
// what AtomicBounceCycles (memory/spu_program.hpp) predicts, row S1.
constexpr DispatchParameters AtomicDispatch(uint32_t draw_ns) {
  return {"atomic line", 0, draw_ns};
}

std::vector<PlatformNumber> DescribeDispatch(const DispatchParameters& p);

// Microsoft's figures for the Xenon. What a load-hit-store costs, the fifth of them, is the core's:
// PpeParameters::load_hit_store_cycles.
struct SynchronisationCost {
  std::string_view row, name;
  uint32_t least_cycles, most_cycles;

  constexpr uint32_t Middle() const { return (least_cycles + most_cycles) / 2; }
};
inline constexpr std::array<SynchronisationCost, 4> kXenonSynchronisation = {{
    {"X1", "lwsync", 33, 48},
    {"X2", "InterlockedIncrement", 225, 260},
    {"X3", "critical section", 345, 345},
    {"X4", "mutex", 2350, 2350},
}};

}  // namespace pelt
