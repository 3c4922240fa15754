// What of an SPU's local store belongs to no kernel: the numbers of a program that was never
// shipped, so class L all of them. Numbers only; cell_memory.cpp lists them with the rest.
#pragma once

#include "platform_sim/platforms/number.hpp"

namespace pelt {

struct SpuRuntimeParameters {
  // Draws items from the counter, makes and gives DMA lists, runs a pass's kernels.
  Number<uint32_t> code_bytes = {8 * 1024, "code of the loop over items", "B", "the model's",
                                 Sureness::kLead};
  // Kernels have no large arrays of their own and do not call each other.
  Number<uint32_t> stack_bytes = {8 * 1024, "stack", "B", "the model's", Sureness::kLead};
};

}  // namespace pelt
