// One set of every stage's parameters, filled once per frame on the caller's thread. A kernel gets
// the member that has its Params' type: each type occurs once.
#pragma once

#include "core/kernels/activate.hpp"
#include "core/kernels/collect_changes.hpp"
#include "core/kernels/light_layer.hpp"
#include "core/kernels/order_layers.hpp"
#include "core/kernels/paint_strands.hpp"
#include "core/kernels/select_fins.hpp"
#include "core/kernels/select_lod.hpp"
#include "core/kernels/select_shells.hpp"
#include "core/kernels/simulate_pbd.hpp"
#include "core/kernels/sort_key.hpp"
#include "core/kernels/wind.hpp"
#include "core/kernels/write_ribbons.hpp"

namespace pelt {

struct FrameParams {
  SelectLodParams select_lod{};
  ActivateParams activate{};
  WindParams wind{};
  SimulateParams simulate{};
  SortKeyParams sort_key{};
  CollectChangesParams collect_changes{};
  OrderLayersParams order_layers{};
  WriteRibbonsParams write_ribbons{};
  LightLayerParams light_layer{};
  SelectShellsParams select_shells{};
  PaintStrandsParams paint_strands{};
  SelectFinsParams select_fins{};
};

}  // namespace pelt
