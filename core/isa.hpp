// The instruction sets that the kernels are built for.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace pelt {

// kSimd128: the 128-bit vectors of a machine other than x86 (NEON, AltiVec).
enum class Isa : uint8_t { kReference, kSse4, kAvx2, kAvx512, kSimd128 };
inline constexpr Isa kAllIsas[] = {Isa::kReference, Isa::kSse4, Isa::kAvx2, Isa::kAvx512,
                                   Isa::kSimd128};

// The widest set this processor runs.
Isa BestIsa();
std::string_view IsaName(Isa isa);  // "reference", "sse4", "avx2", "avx512", "simd128"
std::optional<Isa> ParseIsa(std::string_view name);

}  // namespace pelt
