// What of an SPU's local store belongs to nobody's kernel: the numbers of a program that was never
// shipped, so class L all of them. Numbers only; a plain struct, so that a test can plant others.
#pragma once

#include <cstdint>
#include <vector>

#include "platform_sim/platforms/number.hpp"

namespace pelt {

struct SpuRuntimeParameters {
  // Draws items from the counter, makes and gives DMA lists, runs a pass's kernels.
  uint32_t code_bytes = 8 * 1024;
  // Kernels have no large arrays of their own and do not call each other.
  uint32_t stack_bytes = 8 * 1024;
};

inline std::vector<PlatformNumber> DescribeSpuRuntime(const SpuRuntimeParameters& p) {
  return {
      {"code of the loop over items", double(p.code_bytes), "B", "the model's", Sureness::kLead},
      {"stack", double(p.stack_bytes), "B", "the model's", Sureness::kLead},
  };
}

}  // namespace pelt
