#include "core/isa.hpp"

#include "core/kernels/frame_table.hpp"

namespace pelt {

// Defined by frame_table.cpp, once for each instruction set that is built.
const FrameTable& KernelsReference();
const FrameTable& KernelsSse4();
const FrameTable& KernelsAvx2();
const FrameTable& KernelsAvx512();
const FrameTable& KernelsSimd128();

const FrameTable* FindKernels(Isa isa) {
#ifdef PELT_HAS_SSE4
  if (isa == Isa::kSse4 && __builtin_cpu_supports("sse4.1")) return &KernelsSse4();
#endif
#ifdef PELT_HAS_AVX2
  if (isa == Isa::kAvx2 && __builtin_cpu_supports("avx2")) return &KernelsAvx2();
#endif
#ifdef PELT_HAS_AVX512
  if (isa == Isa::kAvx512 && __builtin_cpu_supports("avx512f") &&
      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") &&
      __builtin_cpu_supports("avx512vl"))
    return &KernelsAvx512();
#endif
#ifdef PELT_HAS_SIMD128
  if (isa == Isa::kSimd128) return &KernelsSimd128();
#endif
  return isa == Isa::kReference ? &KernelsReference() : nullptr;
}

Isa BestIsa() {
  for (Isa isa : {Isa::kAvx512, Isa::kAvx2, Isa::kSse4, Isa::kSimd128})
    if (FindKernels(isa)) return isa;
  return Isa::kReference;
}

const KernelDesc* FrameTable::Find(std::string_view kernel) const {
  for (const FrameEntry& entry : entries)
    if (entry.kernel.name == kernel) return &entry.kernel;
  return nullptr;
}

std::vector<Stage> MakeStages(const FrameTable& table, const FrameParams& params,
                              VertexOrder order) {
  std::vector<Stage> stages;
  for (const FrameEntry& entry : table.entries) {
    if (entry.vertices && entry.vertices != order) continue;
    stages.push_back({entry.kernel, entry.params ? entry.params(params) : nullptr, entry.domain,
                      entry.gate, entry.kinds});
  }
  return stages;
}

std::string_view IsaName(Isa isa) {
  constexpr std::string_view kNames[] = {"reference", "sse4", "avx2", "avx512", "simd128"};
  return kNames[size_t(isa)];
}

std::optional<Isa> ParseIsa(std::string_view name) {
  for (Isa isa : kAllIsas)
    if (IsaName(isa) == name) return isa;
  return std::nullopt;
}

}  // namespace pelt
