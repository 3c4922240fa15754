#include "bench/picture/mapped_fur.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace pelt {
namespace {

float AreaOf(const Body& body, uint32_t triangle) {
  const auto& corner = body.character->mesh.triangles[triangle];
  const glm::vec3& p = body.position[corner[0]];
  return 0.5f * glm::length(glm::cross(body.position[corner[1]] - p, body.position[corner[2]] - p));
}

// What a layer covers at each place, by the maps' shares alone; m^2.
std::vector<float> AreaByShare(const Body& body, const SkinFur& fur, const GrowthSheets& growth) {
  std::vector<float> area(fur.place.size(), 0.0f);
  for (uint32_t t = 0; t < body.character->mesh.triangles.size(); ++t) {
    const glm::vec3 part = growth.CornerShare(t) * AreaOf(body, t);
    for (int k = 0; k < 3; ++k)
      area[fur.place[body.character->mesh.triangles[t][size_t(k)]]] += part[k];
  }
  return area;
}

// Few hairs at the edge of a bald spot are an accident: there the layer's mean counts as well, as much as a share of
// the mean skin round a vertex.
std::vector<float> FindRates(const Body& body, const SkinFur& fur, const SkinFur::OfLayer& layer,
                             const GrowthSheets& growth) {
  constexpr float kMeansShare = 0.02f;
  const std::vector<float> by_share = AreaByShare(body, fur, growth);
  std::vector<float> hair(by_share.size(), 0.0f);  // at each place
  for (size_t v = 0; v < layer.area.size(); ++v) hair[fur.place[v]] = layer.area[v];
  const float all = std::accumulate(by_share.begin(), by_share.end(), 0.0f);
  const float mean = std::accumulate(hair.begin(), hair.end(), 0.0f) / std::max(all, 1e-12f);
  const float weight = std::max(kMeansShare * all / float(by_share.size()), 1e-12f);
  std::vector<float> rate;
  for (const uint32_t place : fur.place)
    rate.push_back((hair[place] + mean * weight) / (by_share[place] + weight));
  return rate;
}

}  // namespace

std::vector<float> AreasRoundVertices(const Mesh& mesh, const std::vector<glm::vec3>& position) {
  std::vector<float> area(position.size(), 0.0f);
  for (const auto& triangle : mesh.triangles) {
    const glm::vec3& p = position[triangle[0]];
    const float third =
        glm::length(glm::cross(position[triangle[1]] - p, position[triangle[2]] - p)) / 6.0f;
    for (const uint32_t v : triangle) area[v] += third;
  }
  return area;
}

void MapFur(const SkinFur& fur, std::span<const SharedGrowth> growth, Body& body) {
  if (growth.empty()) return;
  std::vector<float> rest(body.position.size(), 0.0f);
  for (const SkinFur::OfLayer& layer : fur.layers) {
    if (const SharedGrowth& sheets = growth[layer.layer];
        sheets && body.mapped.size() < kMappedLayers)
      body.mapped.push_back({sheets, FindRates(body, fur, layer, *sheets)});
    else
      for (size_t v = 0; v < rest.size(); ++v) rest[v] += layer.area[v];
  }
  if (body.mapped.empty()) return;
  const std::vector<float> area = AreasRoundVertices(body.character->mesh, body.position);
  for (size_t v = 0; v < rest.size(); ++v)
    body.unmapped.push_back(rest[v] / std::max(area[v], 1e-9f));
}

bool IsMapped(const Body& body, uint32_t triangle) {
  return std::ranges::any_of(body.mapped, [&](const MappedFur& mapped) {
    return mapped.growth->SheetOf(triangle) != FlowMap::kNoSheet;
  });
}

float CoveredAt(const Body& body, const SurfacePoint& point) {
  const Mesh& mesh = body.character->mesh;
  if (!body.furry_material[mesh.triangle_material[point.triangle]]) return 0.0f;
  if (!IsMapped(body, point.triangle)) return Interpolate(body.covered, mesh, point);
  const glm::vec2 uv = Interpolate(mesh.uv, mesh, point);
  float hair = Interpolate(body.unmapped, mesh, point);
  for (const MappedFur& mapped : body.mapped)
    if (const uint16_t sheet = mapped.growth->SheetOf(point.triangle); sheet != FlowMap::kNoSheet)
      hair += Interpolate(mapped.rate, mesh, point) * mapped.growth->At(sheet, uv);
  return 1.0f - std::exp(-hair);
}

}  // namespace pelt
