#include "core/groom/bake.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/character/mesh_repair.hpp"
#include "core/character/pose.hpp"
#include "core/error.hpp"
#include "core/float_environment.hpp"
#include "core/float_rules.hpp"
#include "core/format.hpp"
#include "core/groom/chunk_builder.hpp"
#include "core/groom/patch_index.hpp"
#include "core/groom/shell_skin.hpp"
#include "core/groom/surface_colour.hpp"
#include "core/layer_block.hpp"

namespace pelt {
namespace {

double MeasureArea(const Mesh& mesh, const std::vector<glm::vec3>& position) {
  double area = 0.0;
  for (const auto& v : mesh.triangles) {
    const glm::dvec3 a = position[v[0]], b = position[v[1]], c = position[v[2]];
    const glm::dvec3 cross = glm::cross(b - a, c - a);
    area += 0.5 * std::sqrt(glm::dot(cross, cross));
  }
  return area;
}

// Bind space may be scaled against the rest pose (a rig modelled in centimetres under a node that
// scales by 0.01), so lengths are carried over by area.
float MeasureMetresPerMeshUnit(const Mesh& mesh, const RestGeometry& rest, float unit_scale) {
  const double mesh_area = MeasureArea(mesh, mesh.position);
  const double rest_area = MeasureArea(mesh, rest.position);
  if (!(mesh_area > 0.0) || !(rest_area > 0.0)) return unit_scale;
  return float(std::sqrt(rest_area / mesh_area));
}

// What stands where: strands that are scattered, or the triangles of shells.
std::vector<ScatterPoint> PlaceStrands(const Character& character, const RestGeometry& rest,
                                       const FurSetup& setup, const LayerSetup& layer,
                                       const Growth& growth, ScatterDensity* density) {
  if (layer.params.output == Output::kShells)
    return PlaceShells(character, rest, setup, layer, growth, density);
  return ScatterLayer(character, rest, setup, layer, growth, density);
}

// 1 of each vertex of the mesh that is nearest to one of the chain_mesh's, and of its seam duplicates. Empty without a
// chain_mesh.
std::vector<uint8_t> FindChainVertices(const RestGeometry& rest, const FurSetup& setup,
                                       float unit_scale, std::span<const uint32_t> duplicates) {
  if (!setup.chain_mesh) return {};
  glm::vec3 low(std::numeric_limits<float>::max()), high = -low;
  for (const glm::vec3& p : rest.position) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  std::vector<uint8_t> found(rest.position.size(), 0);
  float farthest2 = 0.0f;
  for (const glm::vec3& p : ComputeRestGeometry(*setup.chain_mesh, unit_scale).position) {
    const auto away2 = [&](const glm::vec3& at) { return glm::dot(at - p, at - p); };
    const auto nearest = std::ranges::min_element(rest.position, {}, away2);
    farthest2 = std::max(farthest2, away2(*nearest));
    found[duplicates[size_t(nearest - rest.position.begin())]] = 1;
  }
  constexpr float kMostOff = 0.1f;  // of the surface's extent
  const glm::vec3 extent = high - low;
  if (!(farthest2 <= kMostOff * kMostOff * glm::dot(extent, extent)))
    throw Error(
        Format("{}: key 'chain_mesh': lies up to {:.3g} m from the surface; it is to be the "
               "same character in the same units",
               setup.path, std::sqrt(farthest2)));
  for (size_t v = 0; v < found.size(); ++v) found[v] = found[duplicates[v]];
  return found;
}

// The least whose chains are all that `first` names, which go first.
float LeastShare(std::span<const VertexPatch> patches, std::span<const uint8_t> first) {
  uint32_t level = kChainLevels - 1;
  for (const VertexPatch& patch : patches) {
    const auto wanted = std::ranges::count_if(patch.vertices, [&](uint32_t v) { return first[v]; });
    while (level > 0 && CountChains(uint32_t(patch.vertices.size()), level) < uint32_t(wanted))
      --level;
  }
  return 1.0f / float(1u << level);
}

LayerChains MeasureChains(const Groom& groom, const GroomLayer& layer,
                          std::span<const VertexPatch> patches, std::span<const uint8_t> first,
                          float metres_per_mesh_unit) {
  LayerChains chains;
  std::vector<double> apart;
  for (uint32_t p = 0; p < layer.patch_count; ++p) {
    const MeshBlock& mesh = groom.mesh[layer.first_patch + p];
    const uint32_t live = CountChains(mesh.vertex_count, LeastChainLevel(layer.params));
    chains.all += mesh.vertex_count;
    chains.simulated += live;
    for (const uint32_t v : patches[p].vertices) chains.of_mesh += !first.empty() && first[v];
    if (live == mesh.vertex_count) continue;
    for (const double distance : MeasureFollowing(ListChainPlaces(mesh), live))
      apart.push_back(distance * double(metres_per_mesh_unit));
  }
  if (apart.empty()) return chains;
  std::ranges::sort(apart);
  for (const double distance : apart) chains.mean_m += distance / double(apart.size());
  chains.p95_m = apart[(apart.size() * 95 + 99) / 100 - 1];
  return chains;
}

void BakeLayer(const Character& character, const RestGeometry& rest, const FurSetup& setup,
               const LayerSetup& layer, std::span<const uint32_t> duplicates,
               std::span<const uint8_t> chain_vertices, float metres_per_mesh_unit,
               const std::shared_ptr<const SurfaceColour>& surface, Groom& groom,
               ScatterStats* stats, std::vector<LayerDensity>* densities) {
  // A setup need not come from a file: ReadFurSetup has said as much, with the line.
  if (const std::string bad = FindBadParam(layer.params); !bad.empty())
    throw Error(Format("{}: layer '{}': {}", setup.path, layer.name, bad));
  if (const auto bad = FindBadTrait(layer))
    throw Error(Format("{}: layer '{}': {}: {}", setup.path, layer.name, bad->key, bad->reason));
  const Growth growth(character, rest, setup, layer, surface);
  const AttributeMaker maker(character, rest, setup, layer, surface);
  ScatterDensity density;
  const std::vector<ScatterPoint> points =
      PlaceStrands(character, rest, setup, layer, growth, &density);
  std::vector<GroomedStrand> strands(points.size());
  for (uint32_t i = 0; i < points.size(); ++i) strands[i] = maker.Groom(points[i], i);
  // Shells know each vertex's own fur; other layers have the mean of the strands around it.
  std::optional<ShellSkin> shells;
  if (layer.params.output == Output::kShells)
    shells.emplace(character.mesh, rest, growth, maker, points);
  std::vector<uint32_t> fin_edges;
  if (layer.params.fins) fin_edges = FindFinEdges(character.mesh, duplicates, points);
  const VertexChains vertices(character.mesh, rest, duplicates, maker,
                              shells ? shells->corners() : strands);
  const std::vector<PatchStrand> placed = ListPatchStrands(character.mesh, points);
  const std::vector<ChunkPart> chunks = CutChunks(placed);
  const bool chained = layer.params.chain == ChainKind::kVertex && !shells;
  const auto first = chained ? chain_vertices : std::span<const uint8_t>();
  const std::vector<VertexPatch> patches = PackVertices(character.mesh, placed, chunks, first);
  AppendLayer({character.mesh, layer, strands, vertices, metres_per_mesh_unit,
               shells ? &*shells : nullptr, fin_edges},
              chunks, patches, groom);
  GroomLayer& made = groom.layers.back();
  if (!first.empty() && made.params.chain_share == 1.0f)
    made.params.chain_share = LeastShare(patches, first);
  if (densities) {
    densities->push_back({layer.name, density, made.length_max});
    if (chained)
      densities->back().chains = MeasureChains(groom, made, patches, first, metres_per_mesh_unit);
  }
  if (stats) {
    stats->layers.push_back(
        MeasureLayerScatter(character, rest, layer, growth, points, chunks, patches));
  }
}

}  // namespace

namespace {

Groom BakeRounded(Character character, FurSetup setup, float unit_scale,
                  const BakeProgress* progress, ScatterStats* stats,
                  std::vector<LayerDensity>* densities, std::vector<std::string>* notes) {
  SmoothCreases(setup.crease_angle, &character.mesh);
  setup.crease_angle = 0.0f;
  return BakeGroom(character, ComputeRestGeometry(character, unit_scale), setup, unit_scale,
                   progress, stats, densities, notes);
}

// The character's images are decoded once, if any layer looks at them.
std::shared_ptr<const SurfaceColour> DecodeImages(const Character& character, const FurSetup& setup,
                                                  std::vector<std::string>* notes) {
  const bool needed =
      std::any_of(setup.layers.begin(), setup.layers.end(), [&](const LayerSetup& layer) {
        return TakesSurfaceColour(layer) || GrowsByImages(character.mesh, layer);
      });
  if (!needed) return nullptr;
  auto surface = std::make_shared<const SurfaceColour>(character);
  if (notes) notes->insert(notes->end(), surface->faults().begin(), surface->faults().end());
  return surface;
}

// Maps are as fine as their texels on the skin, and a brush of one width in UV paints spots of that many.
void NoteUvScale(const Character& character, const RestGeometry& rest, const FurSetup& setup,
                 std::vector<std::string>& notes) {
  constexpr double kNoted = 4.0;
  const auto has_map = [](const LayerSetup& layer) { return !FindSurfaceMap(layer).empty(); };
  if (!std::ranges::any_of(setup.layers, has_map)) return;
  const auto scale = MeasureUvScale(character.mesh, rest);
  if (!scale || scale->coarsest < kNoted * scale->finest) return;
  notes.push_back(Format(
      "Maps are {:.0f} times coarser on some skin than on other: 1 of UV is {:.3g} m long there, "
      "and {:.3g} m where they are finest (5 % of the area beyond each).",
      scale->coarsest / scale->finest, scale->coarsest, scale->finest));
}

}  // namespace

bool LayerDensity::IsCutBald() const {
  const double cover = 0.5 * double(longest_m), spacing = double(scatter.spacing_m);
  const double asked_spacing = spacing * std::sqrt(double(scatter.grown) / scatter.asked);
  return IsCut() && spacing > cover && asked_spacing <= cover;
}

std::vector<std::string> WarnOfBaldness(std::span<const LayerDensity> layers) {
  std::vector<std::string> warnings;
  for (const LayerDensity& l : layers)
    if (l.IsCutBald())
      warnings.push_back(
          Format("WARNING: layer '{}' is bald: max_strands leaves {} of the {:.0f} strands that "
                 "its density "
                 "asks for ({:.2g} %), {:.0f} mm apart and at most {:.0f} mm long",
                 l.layer, l.scatter.grown, l.scatter.asked,
                 100.0 * double(l.scatter.grown) / l.scatter.asked,
                 1e3 * double(l.scatter.spacing_m), 1e3 * double(l.longest_m)));
  if (!layers.empty() && warnings.size() == layers.size())
    warnings.push_back("WARNING: the whole character is bald: max_strands cuts every layer so");
  return warnings;
}

Groom BakeGroom(const Character& character, const RestGeometry& rest, const FurSetup& setup,
                float unit_scale, const BakeProgress* progress, ScatterStats* stats,
                std::vector<LayerDensity>* densities, std::vector<std::string>* notes) {
  const FloatEnvironment guard;
  if (setup.layers.empty()) {
    throw Error(Format("{}: no layer; a groom needs at least one [[layer]]", setup.path));
  }
  if (setup.layers.size() > kLayersPerScene) {
    throw Error(Format("{}: {} layers, at most {} fit a scene", setup.path, setup.layers.size(),
                       kLayersPerScene));
  }
  if (setup.crease_angle > 0.0f)
    return BakeRounded(character, setup, unit_scale, progress, stats, densities, notes);
  Groom groom;
  groom.unit_scale = unit_scale;
  groom.joint_count = uint32_t(character.skeleton.parent.size());
  groom.skeleton = MakeSkeletonBlock(character.skeleton);
  groom.joint_names = character.skeleton.name;
  const float metres_per_mesh_unit = MeasureMetresPerMeshUnit(character.mesh, rest, unit_scale);
  const std::vector<uint32_t> duplicates = FindSeamDuplicates(character.mesh);
  const std::vector<uint8_t> chain_vertices =
      FindChainVertices(rest, setup, unit_scale, duplicates);
  const auto surface = DecodeImages(character, setup, notes);
  if (notes) NoteUvScale(character, rest, setup, *notes);
  const float count = float(setup.layers.size());
  for (size_t i = 0; i < setup.layers.size(); ++i) {
    if (progress && *progress) (*progress)(setup.layers[i].name, float(i) / count);
    BakeLayer(character, rest, setup, setup.layers[i], duplicates, chain_vertices,
              metres_per_mesh_unit, surface, groom, stats, densities);
  }
  if (progress && *progress) (*progress)(setup.layers.back().name, 1.0f);
  return groom;
}

std::vector<uint8_t> CutByStencil(const Groom& groom, const ControlMap& stencil, int channel) {
  const FloatEnvironment guard;
  std::vector<uint8_t> cut;
  cut.reserve(groom.strand_uv.size() * kStrandsPerChunk);
  for (const StrandUvBlock& block : groom.strand_uv)
    for (const uint32_t uv : block.uv) {
      const glm::vec2 at(float(uv & 0xffffu) / 65535.0f, float(uv >> 16) / 65535.0f);
      cut.push_back(stencil.Sample(at, channel) < 0.5f);
    }
  return cut;
}

}  // namespace pelt
