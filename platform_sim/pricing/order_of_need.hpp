// A trace in an order that its operations alone decide, whatever compiler the kernels were built
// by.
//
// C++ leaves open which operand of a sum is computed first: of a * b + c * d one compiler records
// the left product first, another the right one. Costs must not depend on that.
//
// Idea: what has an effect (stores, branches, extractions) stays in its order, which C++ does lay
// down, and what ran between two of them stays between them. In such a stretch the operations go by
// depth, the longest chain of them that leads to each; loads and constants come right before the
// first that reads them; and equals in the order in which a walk from the effects, operands from
// left to right, needs them. What nobody needs is left out.
//
// Invariant: the same values, from the same operands; every load reads what it read. Values,
// constants and temporaries are numbered anew, in the new order. Two effects in one expression are
// the one thing that remains open; kernels do not write such.
//
// Why not simply in the order of need: what the whole kernel reads would be made one after the
// other, each chain waiting for itself, and other values would live long (skinning: half as many
// cycles again).
#pragma once

#include "platform_sim/pricing/recorded_operation.hpp"

namespace pelt {

Trace OrderByNeed(const Trace& trace);

}  // namespace pelt
