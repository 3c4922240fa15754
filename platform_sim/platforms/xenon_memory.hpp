// The Xenon: three cores of the PPE's family, their caches, the front-side bus and the memory that
// they share with the GPU; clock and availability of an Xbox 360. The one place of these numbers.
//
// There are few public Xenon measurements: its rows stand on its sister core's, the PPE's, and on
// Microsoft's figures, not on an Xbox 360. Class L (no source read): its latencies to L2 and
// memory.
#pragma once

#include <string>
#include <vector>

#include "platform_sim/platforms/caches.hpp"

namespace pelt {

struct XenonParameters : CacheMemoryParameters {
  uint64_t clock_hz = 3'200'000'000;
  // The PS3's 0.92 was measured on a PS3; nobody measured an Xbox 360's (see cell_system.hpp).
  uint32_t availability_permille = 1000;

  // The defaults of the bases are the Xenon's, but for these.
  XenonParameters() {
    name = "Xenon";
    cores = 3;
    core.vector_register_count = 128;  // VMX128
  }
  double Availability() const { return availability_permille / 1000.0; }
};

inline XenonParameters XenonMemory() { return {}; }

std::vector<PlatformNumber> DescribeXenon(const XenonParameters& xenon);

// False, and why in `error`, for a Xenon that cannot be.
bool CheckXenon(const XenonParameters& xenon, std::string& error);

}  // namespace pelt
