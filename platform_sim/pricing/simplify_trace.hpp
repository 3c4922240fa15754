// What a compiler does with a kernel before it thinks of a machine's instructions: computes equal
// things once (what does not change from iteration to iteration leaves the loop with that), drops
// what nothing reads, and, where the machine has it, makes multiply-adds of products that one sum
// reads.
//
// Invariant: what remains reads and writes the same memory in the same order, but for loads of what
// was loaded before and not written since. Records are loaded each time: which one it is, the code
// does not know. If ignored: strands that share a vertex would look as if they cost nothing.
#pragma once

#include <cstdint>
#include <vector>

#include "platform_sim/pricing/recorded_operation.hpp"

namespace pelt {

struct SimplifyRules {
  // Off: products are rounded by themselves, as on the host.
  bool fuse_multiply_add = true;
};

// Operations [begin, end) of the trace. Values made before are there; values read behind `end` are
// kept. Their numbers stay those of the trace.
std::vector<RecordedOperation> SimplifyTrace(const Trace& trace, uint32_t begin, uint32_t end,
                                             const SimplifyRules& rules);

}  // namespace pelt
