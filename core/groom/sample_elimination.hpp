// Weighted sample elimination: from many candidate points on a surface keep the best spread ones,
// and put those in an order of which every prefix is well spread.
//
// Source: Yuksel, "Sample Elimination for Generating Poisson Disk Sample Sets" (2015): remove the
// point that is crowded most, weight sum of (1 - d / 2 r_max)^8 over its neighbours, until the
// wanted number is left; then halve again and again with growing radii, and give the points the
// reverse of the order in which they went. Differences: distances are scaled by local radii, so the
// wanted density may vary; a neighbour counts as far as its normal agrees, so the two sides of an
// ear do not see each other; the queue is a table of buckets, 64 an octave of weight, because
// weights only ever fall.
//
// Invariant: the result depends on the points and their order alone. Plain arithmetic only.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace pelt {

// Half the distance of neighbours in the densest packing of `density` points a unit of area: no
// point set is spaced wider.
float DensestPackingRadius(double density);

struct SamplePoint {
  glm::vec3 position;
  glm::vec3 normal;  // unit
  float radius;      // DensestPackingRadius of the wanted density here
};

// Indices of the `keep` points that stay, progressively ordered: every prefix is even in terms of
// the radii. `keep` is at most the number of points; radii are positive.
std::vector<uint32_t> EliminateSamples(std::span<const SamplePoint> points, uint32_t keep);

}  // namespace pelt
