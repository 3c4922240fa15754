#include "core/groom/patch_index.hpp"

#include <algorithm>
#include <set>
#include <span>

#include "core/float_rules.hpp"

namespace pelt {
namespace {

PatchBlock DescribePatch(const MeshBlock& mesh, std::span<const double> live_from) {
  PatchBlock patch{};
  patch.vertex_count = mesh.vertex_count;
  for (uint32_t lane = 0; lane < mesh.vertex_count; ++lane) {
    const JointSet joints = FindJoints(mesh, lane);
    for (uint32_t j = 0; j < kJointsPerCharacter; ++j)
      if (joints[j]) patch.joint_mask[j / 32] |= 1u << j % 32;
  }
  double from = 1.0;
  for (uint32_t group = kVertexGroups; group-- > 0;) {
    for (const double lane : live_from.subspan(group * kLaneGroup, kLaneGroup))
      from = std::min(from, lane);
    patch.live_from[group] = float(from);
  }
  return patch;
}

}  // namespace

std::vector<ChainPlace> ListChainPlaces(const MeshBlock& mesh) {
  std::vector<ChainPlace> places(mesh.vertex_count);
  for (uint32_t v = 0; v < mesh.vertex_count; ++v)
    for (int k = 0; k < 3; ++k) {
      places[v].position[k] = mesh.position[k][v];
      places[v].normal[k] = mesh.normal[k][v];
    }
  return places;
}

namespace {

PatchListBlock ListPatches(const StrandBlock& strands, const HaloBlock& halo) {
  std::set<uint32_t> used;
  for (uint32_t i = 0; i < strands.vertex_count; ++i)
    used.insert(halo.vertex[i] / kVerticesPerChunk);
  PatchListBlock list;
  std::fill(std::begin(list.patch), std::end(list.patch), ~0u);
  std::copy_n(used.begin(), std::min(used.size(), std::size(list.patch)), list.patch);
  return list;
}

}  // namespace

double LiveFrom(uint32_t place, uint32_t count) {
  return double(place / kLaneGroup * kLaneGroup) / double(count) * (1.0 - 1.0e-6);
}

JointSet FindJoints(const MeshBlock& mesh, uint32_t lane) {
  const uint32_t group = lane / kLaneGroup;
  JointSet joints;
  for (uint32_t row = mesh.group_first_row[group]; row < mesh.group_first_row[group + 1]; ++row)
    if (mesh.weight[row][lane % kLaneGroup] > 0.0f) joints.set(mesh.row_joint[row]);
  return joints;
}

PatchIndex IndexPatches(const Groom& groom, const GroomLayer& layer) {
  std::vector<double> live_from(size_t(layer.patch_count) * kVerticesPerChunk, 1.0);
  PatchIndex index;
  for (uint32_t c = 0; c < layer.chunk_count; ++c) {
    const StrandBlock& strands = groom.strands[layer.first_chunk + c];
    const HaloBlock& halo = groom.halo[layer.first_chunk + c];
    // Kernels work on whole groups of lanes.
    for (const auto& corner : strands.vertex)
      for (uint32_t s = 0; s < RoundUpToLaneGroups(strands.strand_count); ++s) {
        double& from = live_from[halo.vertex[corner[s]]];
        from = std::min(from, LiveFrom(s, strands.strand_count));
      }
    index.chunks.push_back(ListPatches(strands, halo));
  }
  for (uint32_t p = 0; p < layer.patch_count; ++p) {
    const MeshBlock& mesh = groom.mesh[layer.first_patch + p];
    index.patches.push_back(DescribePatch(
        mesh, std::span(live_from).subspan(size_t(p) * kVerticesPerChunk, kVerticesPerChunk)));
    index.parents.push_back(FindChainParents(ListChainPlaces(mesh)));
  }
  return index;
}

}  // namespace pelt
