#include "core/groom/vertex_chains.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/float_rules.hpp"

namespace pelt {
namespace {

constexpr uint32_t kNoSlot = 0xffffffffu;
constexpr uint32_t kChainPoints = 4;
// A strand on the far edge of a triangle still counts a little, so that every used vertex has a
// mean.
constexpr float kLeastWeight = 1e-3f;

// Of a vertex and its seam duplicates.
struct Sum {
  double weight = 0.0, length = 0.0, strength = 0.0;
  RestShape offset{};  // rest pose, world axes
};

}  // namespace

std::vector<uint32_t> FindSeamDuplicates(const Mesh& mesh) {
  const uint32_t count = uint32_t(mesh.position.size());
  std::vector<uint32_t> order(count), duplicates(count);
  for (uint32_t v = 0; v < count; ++v) order[v] = v;
  auto key = [&](uint32_t v) {
    const glm::vec3 &p = mesh.position[v], &n = mesh.normal[v];
    return std::array<float, 6>{p.x, p.y, p.z, n.x, n.y, n.z};
  };
  std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
    const auto ka = key(a), kb = key(b);
    return ka != kb ? ka < kb : a < b;
  });
  for (uint32_t i = 0; i < count; ++i) {
    const bool same = i > 0 && key(order[i]) == key(order[i - 1]);
    duplicates[order[i]] = same ? duplicates[order[i - 1]] : order[i];
  }
  return duplicates;
}

VertexChains::VertexChains(const Mesh& mesh, const RestGeometry& rest,
                           std::span<const uint32_t> duplicates, const AttributeMaker& maker,
                           std::span<const GroomedStrand> strands)
    : slot_(mesh.position.size(), kNoSlot) {
  std::vector<Sum> sums(mesh.position.size());  // at the lowest duplicate
  std::vector<uint32_t> used;
  for (const GroomedStrand& strand : strands) {
    glm::dvec3 world[kChainPoints - 1];
    for (uint32_t i = 0; i + 1 < kChainPoints; ++i) {
      world[i] = strand.frame.FromFrame(strand.rest.offset[i]);
    }
    for (int corner = 0; corner < 3; ++corner) {
      const uint32_t v = mesh.triangles[strand.place.triangle][size_t(corner)];
      if (slot_[v] == kNoSlot) {
        slot_[v] = uint32_t(used.size());
        used.push_back(v);
      }
      Sum& sum = sums[duplicates[v]];
      const double weight = std::max(strand.place.bary[corner], kLeastWeight);
      sum.weight += weight;
      sum.length += weight * double(strand.length);
      sum.strength += weight * double(strand.strength);
      for (uint32_t i = 0; i + 1 < kChainPoints; ++i) sum.offset.offset[i] += world[i] * weight;
    }
  }
  chains_.resize(used.size());
  for (size_t i = 0; i < used.size(); ++i) {
    const uint32_t v = used[i];
    const Sum& sum = sums[duplicates[v]];
    const RootFrame frame = MakeRootFrame(glm::dvec3(rest.normal[v]), glm::dvec3(rest.tangent[v]));
    RestShape mean{};
    for (uint32_t k = 0; k + 1 < kChainPoints; ++k) {
      mean.offset[k] = frame.ToFrame(sum.offset.offset[k] / sum.weight);
    }
    const double length = sum.length / sum.weight;
    chains_[i].rest =  // Strands above and below may cancel.
        MakeEqualSegments(mean, length, kChainPoints, glm::dvec3(0.0, 0.0, 1.0));
    chains_[i].length = float(length);
    chains_[i].strength = float(std::min(sum.strength / sum.weight, 1.0));
    chains_[i].down = frame.ToFrame(kRestDown);
    chains_[i].lift = maker.LiftVertex(duplicates[v]);
  }
}

}  // namespace pelt
