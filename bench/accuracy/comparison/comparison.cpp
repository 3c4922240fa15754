#include "bench/accuracy/comparison/comparison.hpp"

#include <fmt/format.h>

#include "bench/accuracy/comparison/lane_batch.hpp"

namespace pelt::accuracy {

using MakeSolver = StrandSolver*(const ComparisonTables&, const ChainMaterial&, TableMaker,
                                 uint32_t lanes);
MakeSolver ComparisonKernelsReference, ComparisonKernelsSse4, ComparisonKernelsAvx2,
    ComparisonKernelsAvx512, ComparisonKernelsSimd128;

namespace {

MakeSolver* FindComparison(Isa isa) {
  // What core has kernels for and this processor runs.
  if (!FindKernels(isa)) return nullptr;
  switch (isa) {
    case Isa::kReference:
      return ComparisonKernelsReference;
#if defined(PELT_COMPARISON_SSE4)
    case Isa::kSse4:
      return ComparisonKernelsSse4;
#endif
#if defined(PELT_COMPARISON_AVX2)
    case Isa::kAvx2:
      return ComparisonKernelsAvx2;
#endif
#if defined(PELT_COMPARISON_AVX512)
    case Isa::kAvx512:
      return ComparisonKernelsAvx512;
#endif
#if defined(PELT_COMPARISON_SIMD128)
    case Isa::kSimd128:
      return ComparisonKernelsSimd128;
#endif
    default:
      return nullptr;
  }
}

}  // namespace

std::unique_ptr<StrandSolver> MakeComparison(Isa isa, const MethodSettings& settings,
                                             const SolverSetup& setup) {
  MakeSolver* make = FindComparison(isa);
  if (!make || settings.substeps < 1 || settings.substeps > kMaxSubsteps) return nullptr;
  if (setup.material.links > kMaxTableLinks) return nullptr;
  ComparisonTables tables{};
  MakeTables(setup.material, settings, setup.frame_seconds, tables);
  return std::unique_ptr<StrandSolver>(make(tables, setup.material, MakeTables, setup.lanes));
}

SolverFactory ComparisonFactory(Isa isa, const MethodSettings& settings) {
  return [=](const SolverSetup& setup) { return MakeComparison(isa, settings, setup); };
}

std::string MethodLabel(const MethodSettings& settings) {
  const auto count = [](int n, std::string_view one) {
    return fmt::format("{} {}{}", n, one, n == 1 ? "" : "s");
  };
  switch (settings.method) {
    case Method::kFollowTheLeader:
      return "follow-the-leader, " + count(settings.substeps, "substep");
    case Method::kPbd:
      return fmt::format("PBD, {}, {}", count(settings.substeps, "substep"),
                         count(settings.iterations, "iteration"));
    case Method::kXpbd:
      return fmt::format("XPBD, {}, {}", count(settings.substeps, "substep"),
                         count(settings.iterations, "iteration"));
    case Method::kXpbdCubic:
      return fmt::format("XPBD, cubic root, {}, {}", count(settings.substeps, "substep"),
                         count(settings.iterations, "iteration"));
    case Method::kImplicitEuler:
      return fmt::format("implicit Euler, {}, {}", count(settings.substeps, "substep"),
                         count(settings.iterations, "Newton step"));
    case Method::kTrapezoid:
      break;
  }
  return fmt::format("trapezoid, {}, {}", count(settings.substeps, "substep"),
                     count(settings.iterations, "Newton step"));
}

}  // namespace pelt::accuracy
