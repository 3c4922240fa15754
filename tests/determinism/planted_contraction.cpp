// The one source that is built with contraction allowed, to show that it is noticed. The vector
// type has a tag of its own, so no function of this file is shared with another.
#include "tests/determinism/planted_faults.hpp"

namespace pelt::testing {
namespace {
struct ContractedLanes {
  static constexpr int kLanes = 8;
};
}  // namespace

KernelDesc ContractedMultiplyAdd() { return MakeKernelDesc<MultiplyAdd<Vec<ContractedLanes>>>(); }

}  // namespace pelt::testing
