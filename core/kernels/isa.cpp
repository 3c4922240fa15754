#include "core/kernels/kernel_table.hpp"

namespace pelt {

// Defined by kernel_table.cpp, once for each instruction set that is built.
const KernelTable& KernelsReference();
#ifdef PELT_X86
const KernelTable& KernelsSse4();
const KernelTable& KernelsAvx2();
const KernelTable& KernelsAvx512();
#endif

const KernelTable* FindKernels(Isa isa) {
#ifdef PELT_X86
  if (isa == Isa::kSse4 && __builtin_cpu_supports("sse4.1")) return &KernelsSse4();
  if (isa == Isa::kAvx2 && __builtin_cpu_supports("avx2")) return &KernelsAvx2();
  if (isa == Isa::kAvx512 && __builtin_cpu_supports("avx512f") &&
      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") &&
      __builtin_cpu_supports("avx512vl"))
    return &KernelsAvx512();
#endif
  return isa == Isa::kReference ? &KernelsReference() : nullptr;
}

Isa BestIsa() {
  for (Isa isa : {Isa::kAvx512, Isa::kAvx2, Isa::kSse4})
    if (FindKernels(isa)) return isa;
  return Isa::kReference;
}

std::string_view IsaName(Isa isa) {
  constexpr std::string_view kNames[] = {"reference", "sse4", "avx2", "avx512"};
  return kNames[size_t(isa)];
}

std::optional<Isa> ParseIsa(std::string_view name) {
  for (Isa isa : kAllIsas)
    if (IsaName(isa) == name) return isa;
  return std::nullopt;
}

}  // namespace pelt
