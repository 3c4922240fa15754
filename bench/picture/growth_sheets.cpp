#include "bench/picture/growth_sheets.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "bench/picture/mesh_finder.hpp"
#include "core/error.hpp"

namespace pelt {
namespace {

// Texels a side: as fine as the layer's finest map, within what is worth its time.
constexpr uint32_t kLeastSide = 512, kMostSide = 1024;

std::vector<const ControlMap*> MapsOf(const LayerSetup& layer) {
  std::vector<const ControlMap*> maps;
  for (const MapChannel* channel : {&layer.density_map, &layer.mask.uv, &layer.mask.bald})
    if (channel->map) maps.push_back(channel->map.get());
  if (layer.mask.box && layer.mask.box->map.map) maps.push_back(layer.mask.box->map.map.get());
  return maps;
}

uint32_t SideFor(const FurSetup& setup) {
  uint32_t side = kLeastSide;
  for (const LayerSetup& layer : setup.layers)
    for (const ControlMap* map : MapsOf(layer)) side = std::max({side, map->width, map->height});
  return std::min(side, kMostSide);
}

bool IsEvenlyFull(const GrowthMap& map) {
  return std::ranges::all_of(map.share, [](uint8_t share) { return share == 255; });
}

// At the middles of the triangles that it is cut into, kCuts along each edge.
glm::vec3 MeanShare(const GrowthSheets& growth, const Mesh& mesh, uint32_t triangle) {
  constexpr int kCuts = 6;
  const auto& corner = mesh.triangles[triangle];
  glm::vec3 sum(0.0f);
  const auto add = [&](float u, float v) {
    const glm::vec3 bary(1.0f - u - v, u, v);
    const glm::vec2 uv =
        mesh.uv[corner[0]] * bary.x + mesh.uv[corner[1]] * bary.y + mesh.uv[corner[2]] * bary.z;
    sum += bary * growth.At(growth.SheetOf(triangle), uv);
  };
  constexpr float kThird = 1.0f / 3.0f;
  for (int i = 0; i < kCuts; ++i)
    for (int j = 0; i + j < kCuts; ++j) {
      add((float(i) + kThird) / float(kCuts), (float(j) + kThird) / float(kCuts));
      if (i + j + 1 < kCuts)
        add((float(i) + 2.0f * kThird) / float(kCuts), (float(j) + 2.0f * kThird) / float(kCuts));
    }
  return sum / float(kCuts * kCuts);
}

}  // namespace

GrowthSheets::GrowthSheets(const Mesh& mesh, GrowthMap map) : sheet_(std::move(map.sheet)) {
  const size_t texels = size_t(map.side) * map.side;
  for (uint32_t s = 0; s < map.sheets; ++s) {
    ControlMap& sheet = texels_.emplace_back(ControlMap{map.side, map.side, {}});
    sheet.rgba.reserve(texels * 4);
    for (size_t i = 0; i < texels; ++i)
      sheet.rgba.insert(sheet.rgba.end(), 4, map.share[s * texels + i]);
  }
  for (uint32_t t = 0; t < sheet_.size(); ++t)
    corner_share_.push_back(sheet_[t] == FlowMap::kNoSheet ? glm::vec3(0.0f)
                                                           : MeanShare(*this, mesh, t));
}

SharedGrowth MakeGrowthSheets(const Character& character, const RestGeometry& rest,
                              const FurSetup& setup, const LayerSetup& layer,
                              const std::shared_ptr<const SurfaceColour>& surface,
                              std::vector<std::string>& notes) {
  const bool by_images = GrowsByImages(character.mesh, layer);
  const bool wanted = layer.params.output == Output::kShells || !MapsOf(layer).empty() || by_images;
  if (!layer.params.enabled || !wanted || character.mesh.uv.empty()) return nullptr;
  try {
    GrowthMap map = MakeGrowthMap(character, rest, setup, layer,
                                  by_images ? kMostSide : SideFor(setup), surface);
    if (IsEvenlyFull(map)) return nullptr;
    return std::make_shared<const GrowthSheets>(character.mesh, std::move(map));
  } catch (const Error& error) {
    notes.push_back(fmt::format("{}; its fur is as dense as at the vertices.", error.what()));
    return nullptr;
  }
}

std::vector<uint16_t> SheetsOfShells(const FurScene& scene, uint32_t layer, const Mesh& mesh,
                                     const GrowthSheets& growth) {
  std::vector<uint16_t> sheets;
  if (growth.texels().size() == 1) return sheets;
  const MeshFinder finder(mesh);
  const SceneShape& shape = scene.shape();
  const uint32_t first = shape.layer_first_chunk[layer], end = shape.layer_first_chunk[layer + 1];
  sheets.assign(size_t(shape.LayerPatches(layer)) * kVerticesPerChunk, 0);
  for (uint32_t c = first; c < end; ++c) {
    const StrandBlock& strands = *scene.memory().Of<&Streams::strands>(c);
    const HaloBlock& halo = *scene.memory().Of<&Streams::halo>(c);
    const std::vector<uint32_t> places = finder.Places(scene.memory(), c);
    for (uint32_t s = 0; s < strands.strand_count; ++s) {
      const uint32_t* triangle =
          finder.FindTriangle({places[strands.vertex[0][s]], places[strands.vertex[1][s]],
                               places[strands.vertex[2][s]]});
      if (!triangle || growth.SheetOf(*triangle) == FlowMap::kNoSheet) continue;
      for (const auto& corner : strands.vertex)
        sheets[halo.vertex[corner[s]]] = growth.SheetOf(*triangle);
    }
  }
  return sheets;
}

}  // namespace pelt
