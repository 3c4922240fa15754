// The solvers that ours are compared with, by name and instruction set; ours, through core's
// kernels, among them.
#pragma once

#include <memory>
#include <string>

#include "bench/accuracy/comparison/tables.hpp"
#include "bench/accuracy/strand_solver.hpp"
#include "core/kernels/frame_table.hpp"

namespace pelt::accuracy {

// Null where this program or processor lacks the instruction set, or for other than 3 or 4 links.
std::unique_ptr<StrandSolver> MakeComparison(Isa isa, const MethodSettings& settings,
                                             const SolverSetup& setup);
SolverFactory ComparisonFactory(Isa isa, const MethodSettings& settings);

// "XPBD, 8 substeps" and the like.
std::string MethodLabel(const MethodSettings& settings);

// Pelt's own position-based solvers: the kernels as they run in a frame, on chunks. Their hardness
// (PBD) or stiffness (Verlet) is set from the material's stiffness as PBD's share is, and tuned by
// the same scale; it is not a share of the physical energy, and depends on frame rate and
// iterations.
enum class CoreMethod : uint8_t { kPbd, kVerlet };
struct CoreSettings {
  CoreMethod method = CoreMethod::kPbd;
  uint32_t iterations = 4;
  double stiffness_scale = 1.0;
};
std::unique_ptr<StrandSolver> MakeCoreSolver(Isa isa, const CoreSettings& settings,
                                             const SolverSetup& setup);
SolverFactory CoreFactory(Isa isa, const CoreSettings& settings);

}  // namespace pelt::accuracy
