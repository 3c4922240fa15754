#include "core/groom/chain_order.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

#include "core/float_rules.hpp"

namespace pelt {
namespace {

double Squared(double x, double y, double z) { return x * x + y * y + z * z; }

class Distances {
 public:
  explicit Distances(std::span<const ChainPlace> places) : places_(places) {
    double size[3];
    for (int k = 0; k < 3; ++k) {
      const auto [low, high] = std::ranges::minmax(
          places, {}, [k](const ChainPlace& place) { return place.position[k]; });
      size[k] = double(high.position[k]) - double(low.position[k]);
    }
    facing_scale_ = pelt::Squared(size[0], size[1], size[2]) / 9.0;
  }
  double Squared(size_t a, size_t b) const {
    const ChainPlace &from = places_[a], &to = places_[b];
    const auto way = [&](int k) { return double(from.position[k]) - double(to.position[k]); };
    const auto along = [&](int k) { return double(from.normal[k]) * double(to.normal[k]); };
    const double facing = along(0) + along(1) + along(2);
    return pelt::Squared(way(0), way(1), way(2)) + facing_scale_ * std::max(0.0, 1.0 - facing);
  }

 private:
  std::span<const ChainPlace> places_;
  double facing_scale_;  // m^2
};

// The first of those that are as far. Those of another use wait for all of less.
std::vector<uint32_t> OrderFarthestFirst(std::span<const ChainPlace> places) {
  const Distances distances(places);
  std::vector<double> nearest(places.size(), std::numeric_limits<double>::max());
  std::vector<uint32_t> order, left(places.size());
  std::iota(left.begin(), left.end(), 0u);
  while (!left.empty()) {
    const auto next = std::min_element(left.begin(), left.end(), [&](uint32_t a, uint32_t b) {
      return std::tuple(places[a].use, -nearest[a], a) < std::tuple(places[b].use, -nearest[b], b);
    });
    order.push_back(*next);
    left.erase(next);
    for (const uint32_t i : left)
      nearest[i] = std::min(nearest[i], distances.Squared(i, order.back()));
  }
  return order;
}

// Where the prefix ends that a lane follows: of the first 0.
uint32_t EndOfParents(uint32_t lane, uint32_t count) {
  for (uint32_t level = 1; level < kChainLevels; ++level)
    if (const uint32_t end = CountChains(count, level); lane >= end) return end;
  return 0;
}

}  // namespace

std::vector<uint32_t> FindChainLevels(std::span<const ChainPlace> places) {
  std::vector<uint32_t> levels(places.size());
  if (places.empty()) return levels;
  const std::vector<uint32_t> order = OrderFarthestFirst(places);
  for (uint32_t level = 1; level < kChainLevels; ++level)
    for (uint32_t i = 0; i < CountChains(uint32_t(places.size()), level); ++i)
      levels[order[i]] = level;
  return levels;
}

ChainParentBlock FindChainParents(std::span<const ChainPlace> places) {
  constexpr double kSame_m2 = 1.0e-12;
  ChainParentBlock parents{};
  if (places.empty()) return parents;
  const Distances distances(places);
  for (uint32_t lane = 0; lane < places.size(); ++lane) {
    const uint32_t end = EndOfParents(lane, uint32_t(places.size()));
    if (end == 0) continue;
    std::vector<std::pair<double, uint32_t>> near;
    for (uint32_t i = 0; i < end; ++i) near.emplace_back(distances.Squared(lane, i), i);
    const size_t count = std::min<size_t>(3, end);
    std::partial_sort(near.begin(), near.begin() + std::ptrdiff_t(count), near.end());
    double weights[3] = {}, sum = 0.0;
    for (size_t k = 0; k < count; ++k) sum += weights[k] = 1.0 / (near[k].first + kSame_m2);
    for (size_t k = 0; k < count; ++k) {
      parents.lanes[lane] |= near[k].second << 8 * k;
      parents.share[k][lane] = float(weights[k] / sum);
    }
  }
  return parents;
}

std::vector<double> MeasureFollowing(std::span<const ChainPlace> places, uint32_t simulated) {
  const ChainParentBlock parents = FindChainParents(places);
  std::vector<std::array<double, 3>> found;  // of each place; parents come first
  std::vector<double> apart;
  for (uint32_t lane = 0; lane < places.size(); ++lane) {
    const ChainPlace& own = places[lane];
    std::array<double, 3>& at = found.emplace_back();
    for (size_t k = 0; k < 3; ++k) at[k] = double(own.position[k]);
    if (lane < simulated) continue;
    std::array<double, 3> put{};
    for (uint32_t parent = 0; parent < 3; ++parent)
      for (size_t k = 0; k < 3; ++k)
        put[k] += double(parents.share[parent][lane]) *
                  found[parents.lanes[lane] >> 8 * parent & 0xffu][k];
    apart.push_back(std::sqrt(Squared(put[0] - at[0], put[1] - at[1], put[2] - at[2])));
    at = put;
  }
  return apart;
}

}  // namespace pelt
