#include "bench/accuracy/tip_errors.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include "core/modal/quality_on_screen.hpp"

namespace pelt::accuracy {
namespace {

constexpr uint32_t kBinBits = 18;  // of a float, that a bin leaves out
constexpr float kLeast = 0x1p-20f, kMost = 0x1p4f;
uint32_t BinOf(float share) {
  const auto bits = [](float value) { return std::bit_cast<uint32_t>(value) >> kBinBits; };
  return bits(std::clamp(share, kLeast, kMost)) - bits(kLeast);
}
double EndOf(uint32_t bin) {
  return std::bit_cast<float>((bin + 1 + (std::bit_cast<uint32_t>(kLeast) >> kBinBits))
                              << kBinBits);
}

}  // namespace

void TipErrors::Counts::Add(double share, double bound) {
  bins.resize(BinOf(kMost) + 1);
  ++bins[BinOf(float(share))];
  within += share <= bound;
}

void TipErrors::Counts::Add(const Counts& other) {
  bins.resize(BinOf(kMost) + 1);
  std::transform(other.bins.begin(), other.bins.end(), bins.begin(), bins.begin(), std::plus<>());
  within += other.within;
}

TipErrors::TipErrors(const Scenario& scene, std::span<const SceneWay> ways) {
  for (uint32_t c = 0; c < scene.actors.size(); ++c)
    for (const GroomLayer& layer : scene.grooms[scene.actors[c].groom].layers)
      layers_.push_back({layer.name, c, layer.params.solver == Solver::kModal});
  for (const SceneWay& way : ways) {
    const bool one = way.IsChoice() && way.simulate && !way.halved;
    ways_.push_back(one ? way.name : "");
  }
  counts_.assign(ways.size(), std::vector<Counts>(layers_.size()));
}

void TipErrors::Add(size_t w, const FurScene& scene, const ScenePointsLayout& layout,
                    const ScenePoints& points, const ScenePoints& reference) {
  if (ways_[w].empty()) return;
  for (const auto& piece : layout.pieces()) {
    const uint32_t l = scene.shape().chunk_layer[piece.chunk];
    if (!layers_[l].modal) continue;
    const double length = scene.memory().Of<&Streams::layers>(l)->length_max;
    const ScreenQuality ran = scene.QualityOf(l);
    const double bound = ErrorShare(ran.quality, ran.chain_level);
    const uint32_t live = scene.memory().Of<&Streams::chunk_state>(piece.chunk)->live_strands;
    for (uint32_t lane = 0; lane < live; ++lane) {
      double off2 = 0.0;
      for (uint32_t axis = 0; axis < 3; ++axis) {
        const size_t at = piece.PlaceOfTip(axis, lane);
        const double off = double(points[at]) - double(reference[at]);
        off2 += off * off;
      }
      counts_[w][l].Add(std::sqrt(off2) / length, bound);
    }
  }
}

TipRow TipErrors::RowOf(size_t w, const Counts& counts) const {
  TipRow row;
  row.way = ways_[w];
  row.within = counts.within;
  row.tips = std::accumulate(counts.bins.begin(), counts.bins.end(), uint64_t{0});
  uint64_t below = 0;
  for (uint32_t bin = 0; bin < counts.bins.size() && 100 * below < 99 * row.tips; ++bin) {
    below += counts.bins[bin];
    row.p99 = EndOf(bin);
  }
  return row;
}

std::vector<TipRow> TipErrors::Layers() const {
  std::vector<TipRow> rows;
  for (size_t w = 0; w < ways_.size(); ++w)
    for (uint32_t l = 0; l < layers_.size(); ++l) {
      if (counts_[w][l].bins.empty()) continue;
      TipRow row = RowOf(w, counts_[w][l]);
      row.layer = l;
      row.character = layers_[l].character;
      row.name = layers_[l].name;
      rows.push_back(std::move(row));
    }
  return rows;
}

std::vector<TipRow> TipErrors::Ways() const {
  std::vector<TipRow> rows;
  for (size_t w = 0; w < ways_.size(); ++w) {
    Counts all;
    for (const Counts& layer : counts_[w])
      if (!layer.bins.empty()) all.Add(layer);
    if (!all.bins.empty()) rows.push_back(RowOf(w, all));
  }
  return rows;
}

}  // namespace pelt::accuracy
