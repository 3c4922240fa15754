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
struct DispatchNumbers {
  // Nothing else is dispatched meanwhile.
  Number<uint32_t> ppe_job_ns = {0, "PPE, for a job", "ns", "the model's, row S1"};
  // Beside the work.
  Number<uint32_t> spe_job_ns = {0, "SPE, for a job", "ns", "the model's, row S1"};
  // The job it runs and those that wait for it.
  Number<uint32_t> jobs_ahead = {2, "jobs an SPE may have", "jobs", "the model's", Sureness::kLead};
};

struct DispatchParameters : DispatchNumbers {
  std::string_view name = {};
};

// GNU Radio's gcell (2007): jobs through shared queues, completion reported through the OS.
inline constexpr DispatchParameters kGcellDispatch = {
    {.ppe_job_ns = {22000, "PPE, for a job", "ns", "gcell, 2007, derived: row J4"},
     .spe_job_ns = {1000, "SPE, for a job", "ns", "gcell, 2007, derived: row J4"}},
    "gcell"};
// SPEs that draw the next job's number from an atomic line; the PPE only starts them. `draw_ns`:
// what AtomicBounceCycles (memory/spu_program.hpp) predicts, row S1.
constexpr DispatchParameters AtomicDispatch(uint32_t draw_ns) {
  DispatchParameters p = {{}, "atomic line"};
  p.spe_job_ns = draw_ns;
  return p;
}

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
