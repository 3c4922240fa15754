// How even a scatter is; what is measured, and its source: see scatter.hpp.
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/float_environment.hpp"
#include "core/float_rules.hpp"
#include "core/groom/sample_elimination.hpp"
#include "core/groom/scatter.hpp"
#include "core/random.hpp"

namespace pelt {
namespace {

constexpr uint64_t kRejectionSeed = 0x72656a65;  // "reje"

// Squared distance to the nearest point that faces the same way, by a sweep along x.
class NearestSearch {
 public:
  explicit NearestSearch(std::span<const ScatterPoint> points) : points_(points) {
    order_.resize(points.size());
    for (uint32_t i = 0; i < order_.size(); ++i) order_[i] = i;
    std::sort(order_.begin(), order_.end(), [&](uint32_t a, uint32_t b) {
      const float xa = points[a].position.x, xb = points[b].position.x;
      return xa != xb ? xa < xb : a < b;
    });
    Build(0, order_.size(), 0);
  }

  float Find(const ScatterPoint& point) const {
    float best = std::numeric_limits<float>::infinity();
    Search(point, 0, order_.size(), 0, best);
    return best;
  }

 private:
  static constexpr size_t kLeaf = 8;

  // A k-d tree in the order itself: the middle of a range splits it.
  void Build(size_t first, size_t last, int axis) {
    if (last - first <= kLeaf) return;
    const size_t middle = (first + last) / 2;
    std::nth_element(order_.begin() + long(first), order_.begin() + long(middle),
                     order_.begin() + long(last), [&](uint32_t a, uint32_t b) {
                       const float pa = points_[a].position[axis], pb = points_[b].position[axis];
                       return pa != pb ? pa < pb : a < b;
                     });
    Build(first, middle, (axis + 1) % 3);
    Build(middle + 1, last, (axis + 1) % 3);
  }

  void Consider(const ScatterPoint& point, uint32_t other, float& best) const {
    const ScatterPoint& q = points_[other];
    if (&q == &point || glm::dot(q.normal, point.normal) <= 0.0f) return;
    const glm::vec3 apart = q.position - point.position;
    best = std::min(best, glm::dot(apart, apart));
  }

  void Search(const ScatterPoint& point, size_t first, size_t last, int axis, float& best) const {
    if (last - first <= kLeaf) {
      for (size_t i = first; i < last; ++i) Consider(point, order_[i], best);
      return;
    }
    const size_t middle = (first + last) / 2;
    const float beyond = point.position[axis] - points_[order_[middle]].position[axis];
    const int next = (axis + 1) % 3;
    Consider(point, order_[middle], best);
    if (beyond < 0.0f) {
      Search(point, first, middle, next, best);
      if (beyond * beyond < best) Search(point, middle + 1, last, next, best);
    } else {
      Search(point, middle + 1, last, next, best);
      if (beyond * beyond <= best) Search(point, first, middle, next, best);
    }
  }

  std::span<const ScatterPoint> points_;
  std::vector<uint32_t> order_;
};

uint32_t CountOfShare(size_t count, double share) {
  return uint32_t(std::ceil(double(count) * share));
}

// Every chunk's prefix: together, and each alone.
void MeasureChunks(std::span<const ScatterPoint> points, std::span<const ChunkPart> chunks,
                   double share, SpacingStats& together, SpacingStats& alone) {
  std::vector<ScatterPoint> all, chunk;
  double sum_least = 0.0, sum_mean = 0.0, sum_variation = 0.0;
  uint64_t measured = 0;
  for (const ChunkPart& part : chunks) {
    const uint32_t kept = CountOfShare(part.strands.size(), share);
    chunk.clear();
    for (uint32_t i = 0; i < kept; ++i) chunk.push_back(points[part.strands[i]]);
    all.insert(all.end(), chunk.begin(), chunk.end());
    const SpacingStats stats =
        MeasureSpacing(chunk, float(std::sqrt(double(part.strands.size()) / double(kept))));
    if (stats.count < 2) continue;
    ++measured;
    sum_least += stats.least;
    sum_mean += stats.mean;
    sum_variation += stats.variation;
  }
  together = MeasureSpacing(all, float(std::sqrt(double(points.size()) / double(all.size()))));
  if (measured == 0) return;
  alone = {sum_mean / double(measured), sum_least / double(measured),
           sum_variation / double(measured), measured};
}

}  // namespace

SpacingStats MeasureSpacing(std::span<const ScatterPoint> points, float scale) {
  const FloatEnvironment guard;
  SpacingStats stats;
  const NearestSearch search(points);
  double sum = 0.0, squares = 0.0, least = std::numeric_limits<double>::infinity();
  for (const ScatterPoint& point : points) {
    const float square = search.Find(point);
    if (!std::isfinite(square)) continue;
    const double rho = std::sqrt(double(square)) / (2.0 * double(point.radius) * double(scale));
    sum += rho;
    squares += rho * rho;
    least = std::min(least, rho);
    ++stats.count;
  }
  if (stats.count == 0) return stats;
  stats.mean = sum / double(stats.count);
  stats.least = least;
  const double variance = squares / double(stats.count) - stats.mean * stats.mean;
  if (stats.mean > 0.0) stats.variation = std::sqrt(std::max(variance, 0.0)) / stats.mean;
  return stats;
}

std::vector<ScatterPoint> ScatterByRejection(const Character& character, const RestGeometry& rest,
                                             const Growth& growth, uint32_t count, uint64_t seed) {
  const FloatEnvironment guard;
  const Mesh& mesh = character.mesh;
  std::vector<double> cumulative(mesh.triangles.size());
  double sum = 0.0;
  for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& v = mesh.triangles[t];
    const glm::dvec3 a = rest.position[v[0]], b = rest.position[v[1]], c = rest.position[v[2]];
    const glm::dvec3 cross = glm::cross(b - a, c - a);
    sum += std::sqrt(glm::dot(cross, cross)) * double(growth.TriangleLimit(t));
    cumulative[t] = sum;
  }
  Random random(MixSeed(seed, kRejectionSeed));
  std::vector<ScatterPoint> points;
  while (points.size() < count) {
    const auto at = std::upper_bound(cumulative.begin(), cumulative.end(), sum * random.Uniform());
    const uint32_t t =
        uint32_t(std::min<size_t>(size_t(at - cumulative.begin()), cumulative.size() - 1));
    const double x = random.Uniform(), y = random.Uniform();
    const SurfacePoint place = PlaceInTriangle(t, x, y);
    const float share = growth.Share(place);
    if (random.Uniform() * double(growth.TriangleLimit(t)) >= double(share)) continue;
    points.push_back({place, Interpolate(rest.position, mesh, place),
                      InterpolateNormal(mesh, rest, place),
                      DensestPackingRadius(double(growth.densest()) * double(share))});
  }
  return points;
}

std::vector<PatchStrand> ListPatchStrands(const Mesh& mesh, std::span<const ScatterPoint> points) {
  std::vector<PatchStrand> strands(points.size());
  for (size_t i = 0; i < points.size(); ++i) {
    strands[i] = {points[i].position, points[i].normal, mesh.triangles[points[i].place.triangle],
                  points[i].radius};
  }
  return strands;
}

LayerScatterStats MeasureLayerScatter(const Character& character, const RestGeometry& rest,
                                      const LayerSetup& layer, const Growth& growth,
                                      std::span<const ScatterPoint> points,
                                      std::span<const ChunkPart> chunks,
                                      std::span<const VertexPatch> patches) {
  const FloatEnvironment guard;
  LayerScatterStats stats;
  stats.name = layer.name;
  stats.strand_count = uint32_t(points.size());
  stats.chunk_count = uint32_t(chunks.size());
  stats.patch_count = uint32_t(patches.size());
  uint64_t vertices = 0, rows = 0, groups = 0, uses = 0;
  for (const ChunkPart& chunk : chunks) uses += chunk.vertices.size();
  for (const VertexPatch& patch : patches) {
    vertices += patch.vertices.size();
    groups += patch.groups.size();
    for (const VertexGroup& group : patch.groups) rows += group.joints.size();
  }
  const double patch_count = double(patches.size());
  stats.strand_fill = double(points.size()) / (double(chunks.size()) * kStrandsPerChunk);
  stats.vertex_fill = double(vertices) / (patch_count * kVerticesPerChunk);
  stats.row_fill = double(rows) / (patch_count * kInfluenceRows);
  stats.rows_per_group = double(rows) / double(groups);
  stats.chunks_per_vertex = double(uses) / double(vertices);

  // The cap of max_strands widens the spacing everywhere alike; the baseline's must agree.
  std::vector<ScatterPoint> plain =
      ScatterByRejection(character, rest, growth, stats.strand_count, layer.seed);
  const float widened = points[0].radius /
                        DensestPackingRadius(double(growth.densest()) *
                                             std::max(double(growth.Share(points[0].place)), 1e-6));
  for (ScatterPoint& point : plain) point.radius *= widened;
  const std::vector<ChunkPart> plain_chunks = CutChunks(ListPatchStrands(character.mesh, plain));
  for (size_t i = 0; i < stats.prefix.size(); ++i) {
    PrefixStats& prefix = stats.prefix[i];
    prefix.share = 1.0 / double(8u >> i);
    const uint32_t kept = CountOfShare(points.size(), prefix.share);
    prefix.layer =
        MeasureSpacing(points.first(kept), float(std::sqrt(double(points.size()) / double(kept))));
    MeasureChunks(points, chunks, prefix.share, prefix.every_chunk, prefix.inside_chunks);
    MeasureChunks(plain, plain_chunks, prefix.share, prefix.plain_every_chunk,
                  prefix.plain_inside_chunks);
  }
  return stats;
}

}  // namespace pelt
