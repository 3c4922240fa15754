#include "core/groom/shell_skin.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/float_rules.hpp"
#include "core/groom/sample_elimination.hpp"
#include "core/groom/setup_names.hpp"

namespace pelt {
namespace {

SurfacePoint CornerOf(uint32_t triangle, int corner) {
  SurfacePoint place{triangle, glm::vec3(0.0f)};
  place.bary[corner] = 1.0f;
  return place;
}

SurfacePoint MiddleOf(uint32_t triangle) {
  constexpr float kThird = 1.0f / 3.0f;
  return {triangle, {1.0f - 2.0f * kThird, kThird, kThird}};
}

bool Grows(const Growth& growth, uint32_t triangle) {
  if (!(growth.TriangleLimit(triangle) > 0.0f)) return false;
  bool grows = growth.Share(MiddleOf(triangle)) > 0.0f;
  for (int corner = 0; corner < 3; ++corner)
    grows = grows || growth.Share(CornerOf(triangle, corner)) > 0.0f;
  return grows;
}

float AreaOf(const Mesh& mesh, const RestGeometry& rest, uint32_t triangle) {
  const auto& v = mesh.triangles[triangle];
  const glm::vec3 across = glm::cross(rest.position[v[1]] - rest.position[v[0]],
                                      rest.position[v[2]] - rest.position[v[0]]);
  return 0.5f * std::sqrt(glm::dot(across, across));
}

}  // namespace

std::vector<ScatterPoint> PlaceShells(const Character& character, const RestGeometry& rest,
                                      const FurSetup& setup, const LayerSetup& layer,
                                      const Growth& growth, ScatterDensity* density) {
  const Mesh& mesh = character.mesh;
  if (mesh.uv.empty())
    FailLayerKey(setup, layer, "output",
                 "shells are cut by a texture, and the mesh has no texture coordinates");
  // A mean size, as chunks count on a radius above 0.
  double area = 0.0;
  std::vector<ScatterPoint> points;
  for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!Grows(growth, t)) continue;
    area += double(AreaOf(mesh, rest, t));
    const SurfacePoint place = MiddleOf(t);
    points.push_back({place, Interpolate(rest.position, mesh, place),
                      InterpolateNormal(mesh, rest, place), 0.0f});
  }
  if (points.empty())
    FailLayerKey(setup, layer, "mask", "no triangle is left: " + growth.ExplainEmpty());
  const float radius = DensestPackingRadius(double(points.size()) / std::max(area, 1e-9));
  for (ScatterPoint& point : points) point.radius = radius;
  if (density) *density = {double(points.size()), uint32_t(points.size()), 2.0f * radius};
  return points;
}

ShellSkin::ShellSkin(const Mesh& mesh, const RestGeometry& rest, const Growth& growth,
                     const AttributeMaker& maker, std::span<const ScatterPoint> triangles)
    : colours_(mesh.position.size()) {
  std::vector<float> stencil(mesh.position.size(), 0.0f);
  std::vector<uint8_t> seen(mesh.position.size(), 0);
  corners_.reserve(3 * triangles.size());
  for (const ScatterPoint& triangle : triangles)
    for (int corner = 0; corner < 3; ++corner) {
      const SurfacePoint place = CornerOf(triangle.place.triangle, corner);
      const uint32_t v = mesh.triangles[place.triangle][size_t(corner)];
      // Random numbers are the vertex's: its triangles agree about it.
      const GroomedStrand& strand = corners_.emplace_back(maker.Groom(
          {place, rest.position[v], InterpolateNormal(mesh, rest, place), triangle.radius}, v));
      stencil[v] = std::max(stencil[v], growth.Share(place));
      if (!seen[v]) colours_[v] = {strand.base_colour, strand.tip_colour};
      seen[v] = 1;
    }
  for (size_t v = 0; v < colours_.size(); ++v) {
    const uint32_t alpha = uint32_t(std::clamp(stencil[v], 0.0f, 1.0f) * 255.0f + 0.5f);
    colours_[v].base = (colours_[v].base & 0x00ffffffu) | alpha << 24;
  }
}

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
