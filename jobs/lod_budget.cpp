#include "jobs/lod_budget.hpp"

#include <algorithm>
#include <cmath>

#include "core/float_rules.hpp"
#include "core/kernels/select_lod.hpp"

namespace pelt {
namespace {

// Of the budget, in which a frame must fit without `fast` for a layer to leave it.
constexpr double kBand = 0.9;
// Of the strands that are asked for: fur that does not fit is thin, not gone.
constexpr float kLeastScale = 1.0f / 32;

// Lanes that kernels work on where `live(n)` of a block's n live.
template <class Live>
double LanesOf(uint32_t count, uint32_t blocks, const Live& live) {
  if (blocks == 0) return 0.0;
  return double(blocks) * RoundUpToLaneGroups(live((count + blocks - 1) / blocks));
}

// ns, with what `scale` leaves of the strands that the layer asks for; of its chains what LOD leaves then.
double NsOf(const LayerDemand& layer, ModalQuality quality, const LodSettings& lod, bool thins,
            float scale) {
  if (!(layer.wanted > 0.0f)) return 0.0;
  const float share = layer.wanted * std::min(scale * layer.importance, 1.0f);
  const bool chains_thin = thins && layer.on_vertices;
  const uint32_t level = std::max(
      chains_thin ? select_lod_detail::LevelOf(share, lod.least_chains) : 0, layer.chain_level);
  const double strands = LanesOf(layer.strands, layer.chunks,
                                 [&](uint32_t n) { return uint32_t(std::ceil(float(n) * share)); });
  const double vertices =
      LanesOf(layer.vertices, layer.patches, [&](uint32_t n) { return CountChains(n, level); });
  const FurCosts& costs = lod.costs;
  const double chain = double(costs.node_ns[CostTier(layer.solver, quality)]) * layer.nodes;
  return double(costs.chunk_ns) * (layer.patches + layer.chunks) +
         double(costs.vertex_ns) * vertices + double(costs.strand_ns) * strands +
         chain * (layer.on_vertices ? vertices : strands);
}

bool IsLowered(const LayerDemand& layer, double px) {
  return layer.solver == Solver::kModal && layer.quality == ModalQuality::kFine &&
         layer.fast_px2 <= px * px;
}

class Chooser {
 public:
  Chooser(std::span<const LayerDemand> layers, const LodSettings& lod, bool thins,
          std::vector<uint32_t>& order)
      : layers_(layers), lod_(lod), thins_(thins), order_(order) {
    order_.clear();
    float least = 1.0f;
    for (const LayerDemand& layer : layers_)
      if (layer.wanted > 0.0f) least = std::min(least, layer.importance);
    whole_ = WholeScale(least);
    for (uint32_t l = 0; l < layers_.size(); ++l)
      if (!IsLowered(layers_[l], lod_.fast_quality_px) && IsLowered(layers_[l], lod_.worst_px))
        order_.push_back(l);
    std::ranges::sort(order_, [&](uint32_t a, uint32_t b) {
      return layers_[a].fast_px2 != layers_[b].fast_px2 ? layers_[a].fast_px2 < layers_[b].fast_px2
                                                        : a < b;
    });
  }

  // The least error up to which layers must be in `fast` for the frame to cost `ns` at most, all that are
  // allowed when none does.
  float LeastPx(double ns) const {
    double sum = Ns(lod_.fast_quality_px, whole_);
    float px = lod_.fast_quality_px;
    for (const uint32_t l : order_) {
      if (sum <= ns) break;
      const LayerDemand& layer = layers_[l];
      sum += NsOf(layer, ModalQuality::kFast, lod_, thins_, whole_) -
             NsOf(layer, layer.quality, lod_, thins_, whole_);
      // Past the rounding of who asks (QualityOnScreen).
      px = std::min(float(std::sqrt(layer.fast_px2) * 1.000001), lod_.worst_px);
    }
    return px;
  }
  // Of all layers, `fine` up to `px` in `fast`.
  double Ns(float px, float scale) const {
    double sum = 0.0;
    for (const LayerDemand& layer : layers_)
      sum += NsOf(layer, IsLowered(layer, px) ? ModalQuality::kFast : layer.quality, lod_, thins_,
                  scale);
    return sum;
  }
  float whole() const { return whole_; }
  // The largest found that costs `ns` at most; the least where none does. More strands never cost less.
  float LargestScale(float px, double ns) const {
    if (Ns(px, whole_) <= ns) return whole_;
    float low = kLeastScale, high = whole_;
    while (high - low > 1.0f / 4096) {
      const float middle = 0.5f * (low + high);
      (Ns(px, middle) <= ns ? low : high) = middle;
    }
    return low;
  }

 private:
  std::span<const LayerDemand> layers_;
  const LodSettings& lod_;
  const bool thins_;
  float whole_ = 1.0f;  // the scale that leaves all strands
  std::vector<uint32_t>& order_;
};

}  // namespace

LodBudget FindLodBudget(std::span<const LayerDemand> layers, const LodSettings& lod, bool thins,
                        std::vector<uint32_t>& order) {
  LodBudget found{.fast_px = lod.fast_quality_px, .keep_fast_px = lod.fast_quality_px};
  if (lod.budget_us == 0) return found;
  const double budget = 1e3 * lod.budget_us;
  const Chooser chooser(layers, lod, thins, order);
  found.fast_px = chooser.LeastPx(budget);
  found.keep_fast_px = std::max(found.fast_px, chooser.LeastPx(kBand * budget));
  found.scale = thins ? chooser.LargestScale(found.fast_px, budget) : chooser.whole();
  found.ns = chooser.Ns(found.fast_px, found.scale);
  return found;
}

}  // namespace pelt
