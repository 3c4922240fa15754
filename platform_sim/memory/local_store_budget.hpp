// Does a program fit into an SPU's local store? Code, stack, resident data and the DMA buffers
// share it; a second buffer hides the transfers and takes the same again.
#pragma once

#include <cstdint>
#include <string>

#include "platform_sim/platforms/cell_memory.hpp"

namespace pelt {

struct LocalStoreUse {
  uint64_t code_bytes = 0;
  uint64_t stack_bytes = 0;
  uint64_t data_bytes = 0;    // resident: parameters, tables
  uint64_t buffer_bytes = 0;  // one set
  uint32_t buffer_sets = 2;

  uint64_t Bytes() const {
    return code_bytes + stack_bytes + data_bytes + buffer_bytes * buffer_sets;
  }
};

// False, and in `error` by how much and what of, when it does not fit. `free_bytes`: what is left.
bool FitsLocalStore(const CellMemoryParameters& p, const LocalStoreUse& use, uint64_t& free_bytes,
                    std::string& error);

}  // namespace pelt
