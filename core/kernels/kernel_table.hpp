// The kernels of one instruction set, types erased. Each set is compiled in its own translation
// unit with its own flags; nothing but these tables crosses from one to another.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "core/kernel.hpp"

namespace pelt {

// kSimd128: the 128-bit vectors of a machine other than x86 (NEON, AltiVec).
enum class Isa : uint8_t { kReference, kSse4, kAvx2, kAvx512, kSimd128 };
inline constexpr Isa kAllIsas[] = {Isa::kReference, Isa::kSse4, Isa::kAvx2, Isa::kAvx512,
                                   Isa::kSimd128};

enum class Kernel : uint8_t {
  kSamplePose,
  kJointPalette,
  kBoundLayer,
  kSelectLod,
  kActivate,
  kSkin,
  kAnchors,
  kRoots,
  kWindVertex,
  kWindStrand,
  kPbdVertex4,
  kPbdStrand4,
  kPbdStrand5,
  kVerlet4,
  kVerlet5,
  kModalVertex4,
  kModalStrand4,
  kModalStrand5,
  kInterpolate,
  kFitCubic4,
  kFitCubic5,
  kFitRibbon4,
  kFitRibbon5,
  kSortKey4,
  kSortKey5,
  kCollectChanges,
  kSortLayer,
  kSortCount0,
  kSortOffsets0,
  kSortScatter0,
  kSortCount1,
  kSortOffsets1,
  kSortScatter1,
  kSortCount2,
  kSortOffsets2,
  kSortScatter2,
  kSortCount3,
  kSortOffsets3,
  kSortScatter3,
  kOrderLayers,
  kWriteInstances,
  kWriteRibbons,
  kWriteRibbonsUnsorted,
  kCount,
};

struct KernelTable {
  KernelDesc kernel[size_t(Kernel::kCount)];
  const KernelDesc& operator[](Kernel k) const { return kernel[size_t(k)]; }
};

// Null when the set was not built or this processor lacks it.
const KernelTable* FindKernels(Isa isa);
// The widest set this processor runs.
Isa BestIsa();
std::string_view IsaName(Isa isa);  // "reference", "sse4", "avx2", "avx512", "simd128"
std::optional<Isa> ParseIsa(std::string_view name);

}  // namespace pelt
