// From a layer's strands, chunks and patches to the blocks the frame runs on.
//
// Invariants (chunk.hpp): unused lanes copy the last used one, in every row; strands are in progressive
// order; clump controls are the first strands, a multiple of the lane group and fewer than all.
#pragma once

#include <cstdint>
#include <span>

#include "core/groom/groom.hpp"
#include "core/groom/patches.hpp"
#include "core/groom/shell_skin.hpp"
#include "core/groom/vertex_chains.hpp"

namespace pelt {

struct LayerBake {
  const Mesh& mesh;
  const LayerSetup& layer;
  std::span<const GroomedStrand> strands;  // progressive order
  const VertexChains& vertices;
  float metres_per_mesh_unit;
  const ShellSkin* shells = nullptr;  // of a layer of shells
  // Of each strand of a layer of shells with fins, which are triangles: fin_edges.hpp. Else empty.
  std::span<const uint32_t> fin_edges = {};
};

// Appends the layer, its patches, chunks and joint boxes to the groom.
void AppendLayer(const LayerBake&, std::span<const ChunkPart> chunks,
                 std::span<const VertexPatch> patches, Groom& groom);

}  // namespace pelt
