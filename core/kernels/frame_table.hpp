// The frame, as one table: which kernels run, on what, when, for one instruction set. Everything
// else about scheduling is derived from it (jobs/plan.hpp).
//
// The table is compiled once for each set, in its own translation unit with its own flags
// (frame_table.cpp); nothing but these rows crosses from one to another.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/kernels/frame_params.hpp"
#include "core/stage.hpp"

namespace pelt {

// kSimd128: the 128-bit vectors of a machine other than x86 (NEON, AltiVec).
enum class Isa : uint8_t { kReference, kSse4, kAvx2, kAvx512, kSimd128 };
inline constexpr Isa kAllIsas[] = {Isa::kReference, Isa::kSse4, Isa::kAvx2, Isa::kAvx512,
                                   Isa::kSimd128};

enum class VertexOrder : uint8_t {
  kSorted,      // vertices lie in draw order
  kIndexBuffer  // vertices lie in strand order; the stream `order` is the sorted index buffer
};

struct FrameRow {
  KernelDesc kernel;
  const void* (*params)(const FrameParams&);  // the kernel's own; null: it has none
  Domain domain;
  Gate gate;
  KindMask kinds = {};                       // besides what its streams demand
  std::optional<VertexOrder> vertices = {};  // only in frames that write them so
};

struct FrameTable {
  std::span<const FrameRow> rows;
  // Null when there is none of this name.
  const KernelDesc* Find(std::string_view kernel) const;
};

// Null when the set was not built or this processor lacks it.
const FrameTable* FindKernels(Isa isa);
// The widest set this processor runs.
Isa BestIsa();
std::string_view IsaName(Isa isa);  // "reference", "sse4", "avx2", "avx512", "simd128"
std::optional<Isa> ParseIsa(std::string_view name);

// The stages of a frame. They point into `params`, which must outlive every plan made of them.
std::vector<Stage> MakeStages(const FrameTable& table, const FrameParams& params,
                              VertexOrder order);

}  // namespace pelt
