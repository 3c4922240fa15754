#include "core/groom/fin_edges.hpp"

#include <algorithm>
#include <tuple>

#include "core/float_rules.hpp"

namespace pelt {
namespace {

struct Edge {
  uint64_t key;  // both vertices, the lower above
  uint32_t triangle, number;
};

}  // namespace

std::vector<uint32_t> FindFinEdges(const Mesh& mesh, std::span<const uint32_t> duplicates,
                                   std::span<const ScatterPoint> triangles) {
  std::vector<Edge> edges;
  edges.reserve(3 * triangles.size());
  for (uint32_t t = 0; t < triangles.size(); ++t) {
    const auto& corners = mesh.triangles[triangles[t].place.triangle];
    for (uint32_t k = 0; k < 3; ++k) {
      const auto [low, high] =
          std::minmax({duplicates[corners[k]], duplicates[corners[(k + 1) % 3]]});
      if (low != high) edges.push_back({uint64_t(low) << 32 | high, t, k});
    }
  }
  std::ranges::sort(edges, {},
                    [](const Edge& e) { return std::tuple(e.key, e.triangle, e.number); });
  std::vector<uint32_t> owned(triangles.size(), 0);
  for (size_t i = 0; i < edges.size(); ++i)
    if (i == 0 || edges[i].key != edges[i - 1].key)
      owned[edges[i].triangle] |= 255u << 8 * edges[i].number;
  return owned;
}

}  // namespace pelt
