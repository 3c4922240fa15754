// The comparison solvers of one instruction set. Compiled once for each, with PELT_VECTOR the
// vector type, PELT_COMPARISON the name of the function, and the flags that let the compiler use
// the set.
#include <type_traits>

#include "bench/accuracy/comparison/direct_methods.hpp"
#include "bench/accuracy/comparison/lane_batch.hpp"
#include "bench/accuracy/comparison/point_methods.hpp"
#include "core/kernels/unrolled.hpp"

namespace pelt::accuracy {

StrandSolver* PELT_COMPARISON(const ComparisonTables& tables, const ChainMaterial& material,
                              TableMaker make, uint32_t lanes);

namespace {

using V = PELT_VECTOR;
// Position-based methods are one long string of dependent operations: two groups side by side, as
// core's own PBD, are a third faster. The direct ones keep the registers full with one, but for 8
// lanes and 3 links (10 to 25 % faster). Each method gets what suits it on this set.
template <class W>
struct PairOf {
  using Type = W;
};
template <class W>
requires simd_detail::IsRegister<W>
struct PairOf<W> {
  using Type = Unrolled<W>;
};
using Pair = PairOf<V>::Type;
using Direct3 = std::conditional_t<V::kLanes == 8, Pair, V>;

template <template <class, int> class Method, class W3, class W4>
StrandSolver* Make(const ComparisonTables& tables, const ChainMaterial& material, TableMaker make,
                   uint32_t lanes) {
  if (material.links == 3) return new LaneBatch<Method, W3, 3>(tables, material, make, lanes);
  if (material.links == 4) return new LaneBatch<Method, W4, 4>(tables, material, make, lanes);
  return nullptr;
}

}  // namespace

StrandSolver* PELT_COMPARISON(const ComparisonTables& tables, const ChainMaterial& material,
                              TableMaker make, uint32_t lanes) {
  switch (tables.settings.method) {
    case Method::kFollowTheLeader:
      return Make<FollowTheLeader, Pair, Pair>(tables, material, make, lanes);
    case Method::kPbd:
      return Make<Pbd, Pair, Pair>(tables, material, make, lanes);
    case Method::kXpbd:
      return Make<Xpbd, Pair, Pair>(tables, material, make, lanes);
    case Method::kXpbdCubic:
      return Make<XpbdCubic, Pair, Pair>(tables, material, make, lanes);
    case Method::kImplicitEuler:
      return Make<ImplicitEuler, Direct3, V>(tables, material, make, lanes);
    case Method::kTrapezoid:
      return Make<Trapezoid, Direct3, V>(tables, material, make, lanes);
  }
  return nullptr;
}

}  // namespace pelt::accuracy
