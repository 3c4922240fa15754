// The one source that is built with contraction allowed, to show that it is noticed. The tag is of
// this file alone, so no function of it is shared with another.
#include "core/kernel.hpp"
#include "tests/determinism/planted_faults.hpp"

namespace pelt::testing {
namespace {
struct Contracted {};
}  // namespace

KernelDesc ContractedMultiplyAdd() { return MakeKernelDesc<MultiplyAdd<Contracted>>(); }

}  // namespace pelt::testing
