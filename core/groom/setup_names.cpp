#include "core/groom/setup_names.hpp"

#include <algorithm>
#include <utility>

#include "core/error.hpp"
#include "core/format.hpp"
#include "core/groom/nearest_word.hpp"
#include "core/groom/surface_colour.hpp"

namespace pelt {
namespace {

constexpr size_t kNamesShown = 60;

std::string DescribeUnknown(const std::string& kind, const std::string& name,
                            const std::vector<std::string>& known) {
  std::vector<std::pair<size_t, size_t>> nearest;  // edits to the name, place in `known`
  for (const std::string& other : known)
    nearest.push_back({CountEdits(name, other), nearest.size()});
  std::sort(nearest.begin(), nearest.end());
  std::string list;
  for (size_t i = 0; i < std::min(nearest.size(), kNamesShown); ++i)
    list += Format("{}'{}'", i ? ", " : "", known[nearest[i].second]);
  if (known.size() > kNamesShown) list += Format(" and {} more", known.size() - kNamesShown);
  return Format("the character has no {} '{}'; it has, the most alike first: {}", kind, name,
                known.empty() ? "none" : list);
}

}  // namespace

void FailLayerKey(const FurSetup& setup, const LayerSetup& layer, const std::string& key,
                  const std::string& reason) {
  throw Error(Format("{}: layer '{}': key '{}': {}", setup.path, layer.name, key, reason));
}

void CheckMapsHaveUvs(const Mesh& mesh, const FurSetup& setup, const LayerSetup& layer) {
  if (!mesh.uv.empty()) return;
  if (const std::string key = FindSurfaceMap(layer); !key.empty())
    FailLayerKey(setup, layer, key,
                 "asks for a map over the surface, but the mesh has no texture coordinates; choose "
                 "the region with mask.materials, mask.joints, mask.range or a projected mask.box "
                 "instead, and give different values in layers of their own");
}

void CheckColoursAreKnown(const SurfaceColour* surface, const Mesh& mesh, const FurSetup& setup,
                          const LayerSetup& layer) {
  if (layer.mask.colours.empty()) return;
  for (uint32_t t = 0; t < mesh.triangles.size(); ++t)
    if (surface->Knows(t)) return;
  FailLayerKey(setup, layer, "mask.colours",
               "the character's file has neither images nor colours to look for them");
}

std::vector<uint8_t> FindJoints(const Skeleton& skeleton, const FurSetup& setup,
                                const LayerSetup& layer, const std::string& key,
                                const std::string& joint, bool subtree) {
  std::vector<uint8_t> found(skeleton.name.size(), 0);
  bool any = false;
  for (size_t j = 0; j < found.size(); ++j) {
    const int32_t parent = skeleton.parent[j];
    const bool named = skeleton.name[j] == joint;
    found[j] = named || (subtree && parent >= 0 && found[size_t(parent)]);
    any = any || named;
  }
  if (!any) FailLayerKey(setup, layer, key, DescribeUnknown("joint", joint, skeleton.name));
  return found;
}

std::vector<uint8_t> FindMaterials(const Mesh& mesh, const FurSetup& setup,
                                   const LayerSetup& layer) {
  if (!layer.mask.materials.empty())
    return FindNamedMaterials(mesh, setup, layer, "mask.materials", layer.mask.materials);
  std::vector<uint8_t> found(mesh.materials.size(), 0);
  for (size_t i = 0; i < found.size(); ++i)
    found[i] = i >= mesh.looks.size() || !mesh.looks[i].bare;
  return found;
}

std::vector<uint8_t> FindNamedMaterials(const Mesh& mesh, const FurSetup& setup,
                                        const LayerSetup& layer, const std::string& key,
                                        const std::vector<std::string>& names) {
  std::vector<uint8_t> found(mesh.materials.size(), 0);
  for (const std::string& name : names) {
    bool any = false;
    for (size_t i = 0; i < found.size(); ++i) {
      if (mesh.materials[i] != name) continue;
      found[i] = 1;
      any = true;
    }
    if (!any) FailLayerKey(setup, layer, key, DescribeUnknown("material", name, mesh.materials));
  }
  return found;
}

std::string DescribeBare(const Mesh& mesh, const FurSetup& setup) {
  const bool any =
      std::any_of(setup.layers.begin(), setup.layers.end(),
                  [](const LayerSetup& layer) { return layer.mask.materials.empty(); });
  std::string list;
  for (size_t i = 0; any && i < mesh.looks.size(); ++i)
    if (mesh.looks[i].bare) list += Format("{}'{}'", list.empty() ? "" : ", ", mesh.materials[i]);
  if (list.empty()) return list;
  return Format("bare, as no layer's mask.materials names them: {}", list);
}

}  // namespace pelt
