// What of its level of detail a frame can pay for (LodSettings::budget_us).
//
//   cost of what is in view  >  budget   -> `fast` for `fine` where that is seen least, up to worst_px
//                          still over    -> fewer strands of every layer, but never none
//
// Costs are of what last frame's boxes ask for, whether it sleeps or not, and the layers' qualities now do not act on
// them: so the choice settles at once. A layer keeps `fast` until there is room for more than a tenth of the budget
// without it, as LOD follows shares by a band.
//
// Invariant: a function of last frame's blocks and the input, in doubles and in the order of the layers; no clock.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/frame_input.hpp"
#include "core/groom/layer_params.hpp"

namespace pelt {

// The place of FurCosts::node_ns.
constexpr uint32_t CostTier(Solver solver, ModalQuality quality) {
  return solver == Solver::kModal ? uint32_t(solver) + uint32_t(quality) : uint32_t(solver);
}
static_assert(CostTier(Solver::kModal, ModalQuality::kBest) + 1 == kSolverTiers);

struct LayerDemand {
  uint32_t patches = 0, chunks = 0;  // that they lie in
  uint32_t vertices = 0, strands = 0;
  uint32_t nodes = 0;        // of a chain
  bool on_vertices = false;  // its chains
  uint32_t chain_level = 0;  // the least that it has
  Solver solver = Solver::kModal;
  ModalQuality quality = ModalQuality::kFast;  // that it asks for
  float wanted = 0.0f;  // share of its strands, by its size on the screen; 0: out of view
  float importance = 1.0f;
  double fast_px2 = 0.0;  // typical error of `fast` on the screen, px^2
};

struct LodBudget {
  float fast_px = 0.0f;       // typical error up to which `fine` is simulated in `fast`
  float keep_fast_px = 0.0f;  // of layers that are
  float scale = 1.0f;         // as BudgetScale's (core/kernels/select_lod.hpp)
  double ns = 0.0;            // what `costs` say of the choice; 0 without a budget
};

// `order`: scratch.
LodBudget FindLodBudget(std::span<const LayerDemand> layers, const LodSettings& lod, bool thins,
                        std::vector<uint32_t>& order);

}  // namespace pelt
