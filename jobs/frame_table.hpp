// The frame, as one table: which kernels run, on what, when. Everything else about scheduling is
// derived from it (jobs/plan.hpp).
#pragma once

#include <vector>

#include "core/kernels/activate.hpp"
#include "core/kernels/collect_changes.hpp"
#include "core/kernels/kernel_table.hpp"
#include "core/kernels/order_layers.hpp"
#include "core/kernels/select_lod.hpp"
#include "core/kernels/simulate_pbd.hpp"
#include "core/kernels/sort_key.hpp"
#include "core/kernels/wind.hpp"
#include "core/kernels/write_ribbons.hpp"
#include "jobs/plan.hpp"

namespace pelt {

// One set of every stage's parameters, filled once a frame on the caller's thread.
struct FrameParams {
  SelectLodParams select_lod{};
  ActivateParams activate{};
  WindParams wind{};
  SimulateParams simulate{};
  SortKeyParams sort_key{};
  CollectChangesParams collect_changes{};
  OrderLayersParams order_layers{};
  WriteRibbonsParams write_ribbons{};
};

enum class VertexOrder : uint8_t {
  kSorted,      // vertices lie in draw order
  kIndexBuffer  // vertices lie in strand order; kOrder is the sorted index buffer
};

// Stages point into `params`, which must outlive every plan made from the table.
std::vector<Stage> MakeFrameTable(const KernelTable& kernels, const FrameParams& params,
                                  VertexOrder order);

}  // namespace pelt
