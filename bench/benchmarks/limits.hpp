// What this machine can do at most, measured in the same run as the figures that are compared
// with it: memory and cache bandwidth, and vector operations.
#pragma once

#include <cstdint>
#include <vector>

#include "core/kernels/frame_table.hpp"
#include "jobs/scene.hpp"

namespace pelt {

struct MachineLimits {
  double memory_bytes_per_s = 0.0;     // copying from and to main memory: bytes read plus written
  double cache_bytes_per_s = 0.0;      // the same within 128 KB read and 128 KB written
  double lane_operations_per_s = 0.0;  // multiplies and adds on vectors of the instruction set
};

// One core; takes about a second.
MachineLimits MeasureLimits(Isa isa);

// Lane operations of each stage of the scene's plan in the frame that has been begun, which is run
// by this call, on the recording kernels (platform_sim/pricing/recording_vec.hpp). One is an
// arithmetic, compare, select, logic or conversion on one lane; loads, stores and moves between
// lanes are not: bytes are accounted for by the ports. Nor is sorting, scalar code on integers.
std::vector<uint64_t> CountOperations(FurScene& scene);

}  // namespace pelt
