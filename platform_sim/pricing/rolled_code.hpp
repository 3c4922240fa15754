// How much of a trace is code of its own: loops inside an iteration are in it once for every time round.
//
// Idea: operations of the same kinds, in the same order, so many of them that it is no chance, are the same code run
// again: a loop of the source over substeps or short steps of a strike, or a function that is called from two places.
// A local store holds it once.
//
// Invariant: code that comes again within kLongEnough operations counts each time. Loops as short as that are priced
// as written out, so that their rounds overlap.
#pragma once

#include "platform_sim/pricing/recorded_operation.hpp"

namespace pelt {

// Fewer are not told from chance, and gain more written out than their code is worth.
inline constexpr uint32_t kLongEnough = 256;

// The share of the operations [begin, end) that did not come before. What is up to `furthest` operations back is
// looked at: an iteration, because iterations are interleaved, whose code is there for each.
double ShareOfOwnCode(const Trace& trace, uint32_t begin, uint32_t end, uint32_t furthest);

}  // namespace pelt
