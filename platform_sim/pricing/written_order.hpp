// A trace in the order its source was written in, regardless of which compiler built the kernels.
//
// C++ leaves one thing open: which operand of an expression is computed first. Of a * b + c * d one
// compiler records the left product first, another the right one. Costs must not depend on that, so
// here it is always the left one; all else stays where the source has it.
//
// Idea: operands that may change places are read by their own expression only. So the trace falls
// into stretches, from behind: what stands before an operation without a gap and is read by none
// behind it. Within a stretch all leads to its last operation, and a walk from there, operands from
// left to right, gives the order. Two traces that differ by who came first have the same stretches
// and the same walks.
//
//   ... | load a, load b, a * b, load c, load d, c * d, +, store | ...     one stretch: the store's
//   ... | x = ... | y = x * x | z = x + y ...                              x is read by two: its
//   own
//
// What stays open are operands of several values, such as the vectors of a * s + b * t: no single
// operation is their last. Kernels give such operands names, or use Combine (core/simd/maths.hpp);
// a test compares the prices of every compiler with the same digest.
//
// Operations that nothing needs are left out. Constants come right before their first reader: which expression
// names one first is open as well.
//
// Invariant: the same values, from the same operands; what has an effect stays in its order, and
// nothing crosses it; every load reads what it read. Values, constants and temporaries are numbered
// anew, in the new order. Two effects in one expression are the one thing that remains open;
// kernels do not write such.
#pragma once

#include "platform_sim/pricing/recorded_operation.hpp"

namespace pelt {

Trace InWrittenOrder(const Trace& trace);

}  // namespace pelt
