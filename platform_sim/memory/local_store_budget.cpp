#include "platform_sim/memory/local_store_budget.hpp"

#include "core/format.hpp"

namespace pelt {

bool FitsLocalStore(const CellMemoryParameters& p, const LocalStoreUse& use, uint64_t& free_bytes,
                    std::string& error) {
  const uint64_t bytes = use.Bytes();
  if (bytes <= p.local_store_bytes) {
    free_bytes = p.local_store_bytes - bytes;
    return true;
  }
  free_bytes = 0;
  error = Format(
      "local store: {} bytes are needed, {} too many for {}: code {}, stack {}, data {}, {} x {} "
      "of "
      "buffers; use smaller chunks, fewer fused stages or one buffer set",
      bytes, bytes - p.local_store_bytes, p.local_store_bytes, use.code_bytes, use.stack_bytes,
      use.data_bytes, use.buffer_sets, use.buffer_bytes);
  return false;
}

}  // namespace pelt
