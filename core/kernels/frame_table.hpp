// The frame, as one table: which kernels run, on what, when, for one instruction set. Everything
// else about scheduling is derived from it (jobs/plan.hpp).
//
// The table is compiled once for each set, in its own translation unit with its own flags
// (frame_table.cpp); nothing but these entries crosses from one to another.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/isa.hpp"
#include "core/outputs.hpp"
#include "core/stage.hpp"

namespace pelt {

struct FrameParams;

struct FrameEntry {
  KernelDesc kernel;
  const void* (*params)(const FrameParams&);  // the kernel's own; null: it has none
  Domain domain;
  Gate gate;
  KindMask kinds = {};                       // besides what its streams demand
  std::optional<VertexOrder> vertices = {};  // only in frames that write them so
};

struct FrameTable {
  std::span<const FrameEntry> entries;
  // Null when there is none of this name.
  const KernelDesc* Find(std::string_view kernel) const;
};

// Null when the set was not built or this processor lacks it.
const FrameTable* FindKernels(Isa isa);

// The stages of a frame. They point into `params`, which must outlive every plan made of them.
std::vector<Stage> MakeStages(const FrameTable& table, const FrameParams& params,
                              VertexOrder order);

}  // namespace pelt
