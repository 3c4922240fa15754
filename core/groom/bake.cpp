#include "core/groom/bake.hpp"

#include <algorithm>
#include <cmath>

#include "core/character/mesh_repair.hpp"
#include "core/character/pose.hpp"
#include "core/error.hpp"
#include "core/float_environment.hpp"
#include "core/float_rules.hpp"
#include "core/format.hpp"
#include "core/groom/chunk_builder.hpp"
#include "core/groom/shell_skin.hpp"
#include "core/groom/surface_colour.hpp"

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

void BakeLayer(const Character& character, const RestGeometry& rest, const FurSetup& setup,
               const LayerSetup& layer, std::span<const uint32_t> duplicates,
               float metres_per_mesh_unit, const std::shared_ptr<const SurfaceColour>& surface,
               Groom& groom, ScatterStats* stats, std::vector<LayerDensity>* densities) {
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
  const std::vector<VertexPatch> patches = PackVertices(character.mesh, placed, chunks);
  AppendLayer({character.mesh, layer, strands, vertices, metres_per_mesh_unit,
               shells ? &*shells : nullptr, fin_edges},
              chunks, patches, groom);
  if (densities) densities->push_back({layer.name, density, groom.layers.back().length_max});
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
  const auto surface = DecodeImages(character, setup, notes);
  if (notes) NoteUvScale(character, rest, setup, *notes);
  const float count = float(setup.layers.size());
  for (size_t i = 0; i < setup.layers.size(); ++i) {
    if (progress && *progress) (*progress)(setup.layers[i].name, float(i) / count);
    BakeLayer(character, rest, setup, setup.layers[i], duplicates, metres_per_mesh_unit, surface,
              groom, stats, densities);
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
