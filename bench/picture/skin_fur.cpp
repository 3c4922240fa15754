#include "bench/picture/skin_fur.hpp"

#include <algorithm>
#include <cmath>

#include "bench/picture/canvas.hpp"
#include "bench/picture/hairs.hpp"

namespace pelt {
namespace {

struct ColourSum {
  glm::vec3 colour{0.0f}, tip{0.0f};
  float strands = 0.0f;
};
struct PaintSum {
  glm::vec4 paint{0.0f};
  float living = 0.0f;  // strands whose paint is known
};

// Area of hair for each of skin, of a layer of shells: so much that as great a share of skin is bare as
// of the texture's texels.
float ShellDensity(const FurScene& scene, uint32_t layer) {
  uint32_t side = 0;
  const std::vector<uint8_t> texels = scene.FurTexture(layer, side);
  const auto bare = std::count(texels.begin(), texels.end(), uint8_t(0));
  return -std::log(std::max(float(bare), 1.0f) / float(texels.size()));
}

// Of a chunk's triangle in the world, at rest or not.
float AreaOf(const FrameMemory& memory, uint32_t chunk, uint32_t t) {
  const StrandBlock& triangles = *memory.Of<&Streams::strands>(chunk);
  const auto corner = [&](int k) {
    const auto [patch, lane] = FindVertex(memory, chunk, triangles.vertex[k][t]);
    const float* p = memory.Of<&Streams::shell_vertices>(patch)->vertex[lane].position;
    return glm::vec3(p[0], p[1], p[2]);
  };
  const glm::vec3 a = corner(0);
  return 0.5f * glm::length(glm::cross(corner(1) - a, corner(2) - a));
}

// What the skin at a strand's root has of mud, snow, darkness and dust. Of a layer that is not
// painted, what its colours are tinted with.
glm::vec4 SkinPaint(const FurScene& scene, uint32_t chunk, uint32_t strand) {
  constexpr float kMeanNoise = 0.5f;
  const FrameMemory& memory = scene.memory();
  const LayerBlock& layer = *memory.Of<&Streams::layers>(scene.shape().chunk_layer[chunk]);
  if (!(layer.flags & kLayerPainted)) return {layer.dirt, 0.0f, 1.0f - layer.darken, 0.0f};
  const RootBlock& roots = *memory.Of<&Streams::roots>(chunk);
  const glm::vec3 normal(roots.normal[0][strand], roots.normal[1][strand], roots.normal[2][strand]);
  glm::vec4 seen =
      SeenPaint(PaintOf(memory.Of<&Streams::looks>(chunk)->record[strand]), normal, kMeanNoise);
  seen.z *= 1.0f - layer.darken;
  return seen;
}

void AddPaint(const FurScene& scene, uint32_t chunk, const std::vector<uint32_t>& chunk_places,
              std::vector<PaintSum>& sums) {
  const StrandBlock& strands = *scene.memory().Of<&Streams::strands>(chunk);
  const uint32_t live = scene.memory().Of<&Streams::chunk_state>(chunk)->live_strands;
  for (uint32_t s = 0; s < live; ++s) {
    const glm::vec4 paint = SkinPaint(scene, chunk, s);
    for (size_t k = 0; k < 3; ++k) {
      PaintSum& sum = sums[chunk_places[strands.vertex[k][s]]];
      sum.paint += paint * strands.bary[k][s];
      sum.living += strands.bary[k][s];
    }
  }
}

void AddColours(const StrandBlock& strands, const glm::vec3& tint,
                const std::vector<uint32_t>& chunk_places, std::vector<ColourSum>& sums) {
  for (uint32_t s = 0; s < strands.strand_count; ++s) {
    const glm::vec3 colour = tint * LinearColour(strands.base_colour[s]);
    const glm::vec3 tip = tint * LinearColour(strands.tip_colour[s]);
    for (size_t k = 0; k < 3; ++k) {
      const float share = strands.bary[k][s];
      ColourSum& sum = sums[chunk_places[strands.vertex[k][s]]];
      sum.colour += colour * share;
      sum.tip += tip * share;
      sum.strands += share;
    }
  }
}

// hair_area(strand) is how much it covers, m^2.
template <class HairArea>
void AddAreas(const StrandBlock& strands, const HairArea& hair_area,
              const std::vector<uint32_t>& chunk_places, std::vector<float>& layer_area) {
  for (uint32_t s = 0; s < strands.strand_count; ++s) {
    const float area = hair_area(s);
    for (size_t k = 0; k < 3; ++k)
      layer_area[chunk_places[strands.vertex[k][s]]] += area * strands.bary[k][s];
  }
}

void MarkMaterials(const StrandBlock& strands, const std::vector<uint32_t>& chunk_places,
                   const MeshFinder& finder, const Mesh& mesh, SkinFur& fur) {
  MeshFinder::Triangle last{};
  for (uint32_t s = 0; s < strands.strand_count; ++s) {
    MeshFinder::Triangle places;
    for (size_t k = 0; k < 3; ++k) places[k] = chunk_places[strands.vertex[k][s]];
    if (places == last) continue;
    last = places;
    if (const uint32_t* triangle = finder.FindTriangle(places))
      fur.on_material[mesh.triangle_material[*triangle]] = 1;
  }
}

}  // namespace

SkinFurFinder::SkinFurFinder(const FurScene& scene, uint32_t actor, const Mesh& mesh)
    : finder_(mesh), area_(finder_.size() + 1, 0.0f) {
  fur_.on_material.resize(mesh.materials.size());
  fur_.place = finder_.places();
  std::vector<ColourSum> sums(finder_.size() + 1);
  const SceneShape& shape = scene.shape();
  for (uint32_t l = 0; l < shape.layer_count; ++l) {
    if (shape.layer_character[l] != actor) continue;
    const bool shells = shape.layer_kind[l] & kLayerShells;
    Layer& layer = layers_.emplace_back(Layer{l, shells ? ShellDensity(scene, l) : 0.0f, {}, {}});
    layer.area.resize(finder_.size() + 1, 0.0f);
    const LayerLook& look = scene.Look(l);
    const glm::vec3 tint(look.tint[0], look.tint[1], look.tint[2]);
    for (uint32_t c = shape.layer_first_chunk[l]; c < shape.layer_first_chunk[l + 1]; ++c) {
      const StrandBlock& strands = *scene.memory().Of<&Streams::strands>(c);
      const std::vector<uint32_t>& places =
          layer.places.emplace_back(finder_.Places(scene.memory(), c));
      AddColours(strands, tint, places, sums);
      MarkMaterials(strands, places, finder_, mesh, fur_);
      if (shells) continue;
      AddAreas(
          strands, [&](uint32_t s) { return strands.length[s] * strands.width[s]; }, places,
          layer.area);
    }
    for (size_t place = 0; place < area_.size(); ++place) area_[place] += layer.area[place];
  }
  ColourSum all;
  for (const ColourSum& sum : sums) {
    all.colour += sum.colour;
    all.tip += sum.tip;
    all.strands += sum.strands;
  }
  for (const uint32_t place : finder_.places()) {
    const ColourSum& known = sums[place].strands > 0.0f ? sums[place] : all;
    fur_.colour.push_back(known.colour / std::max(known.strands, 1e-6f));
    fur_.tip.push_back(known.tip / std::max(known.strands, 1e-6f));
  }
}

void SkinFurFinder::AddShells(const FurScene& scene, const Layer& layer,
                              std::vector<float>& area) const {
  const uint32_t first = scene.shape().layer_first_chunk[layer.number];
  for (uint32_t c = 0; c < layer.places.size(); ++c) {
    const StrandBlock& strands = *scene.memory().Of<&Streams::strands>(first + c);
    const auto hair_area = [&](uint32_t s) {
      return layer.shell_density * AreaOf(scene.memory(), first + c, s);
    };
    AddAreas(strands, hair_area, layer.places[c], area);
  }
}

SkinFur SkinFurFinder::Find(const FurScene& scene) const {
  SkinFur fur = fur_;
  std::vector<float> all = area_;
  std::vector<PaintSum> paint(all.size());
  for (const Layer& layer : layers_) {
    const auto& block = *scene.memory().Of<&Streams::layers>(layer.number);
    for (int k = 0; k < 3; ++k) fur.mud_colour[k] = block.dirt_colour[k];
    std::vector<float> area = layer.area;
    if (layer.shell_density > 0.0f) {
      AddShells(scene, layer, area);
      for (size_t place = 0; place < all.size(); ++place) all[place] += area[place];
    }
    for (uint32_t c = 0; c < layer.places.size(); ++c)
      AddPaint(scene, scene.shape().layer_first_chunk[layer.number] + c, layer.places[c], paint);
    SkinFur::OfLayer& of_layer = fur.layers.emplace_back(SkinFur::OfLayer{layer.number, {}});
    for (const uint32_t place : finder_.places()) of_layer.area.push_back(area[place]);
  }
  for (const uint32_t place : finder_.places()) {
    fur.area.push_back(all[place]);
    fur.paint.push_back(paint[place].paint / std::max(paint[place].living, 1e-6f));
  }
  return fur;
}

}  // namespace pelt
