// From a layer's strands, chunks and patches to the blocks the frame runs on.
//
// Invariants (chunk.hpp): unused lanes copy the last used one, in every row; strands are in progressive
// order; clump controls are the first strands, a multiple of the lane group and fewer than all.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/groom/attributes.hpp"
#include "core/groom/groom.hpp"
#include "core/groom/patches.hpp"
#include "core/groom/shell_skin.hpp"

namespace pelt {

// Chains at the mesh vertices of a layer: each is the mean of the strands around it.
//
// Means are over all strands of the layer that use the vertex, not over those of one chunk, so a
// vertex on a patch border has the same chain, and the same lifted place, in both chunks. Vertices
// that differ only in texture coordinates (a seam) are one: fur must not part along a seam.

struct VertexChain {
  RestShape rest;         // 4 points, equal segments, in the vertex's own frame
  float length = 0.0f;    // m; the layer's segment_length instead of the strands', if it has one
  float strength = 0.0f;  // 0..1
  StrandTraits traits;
  glm::dvec3 down{0.0};  // of the rest pose, in the vertex's own frame
  float lift = 0.0f;     // of the skin along its normal: the layer's offset attribute, m
};

// For each vertex the lowest one that has the same place and normal, bit for bit.
std::vector<uint32_t> FindSeamDuplicates(const Mesh&);

class VertexChains {
 public:
  // `duplicates` is FindSeamDuplicates of the mesh.
  VertexChains(const Mesh&, const RestGeometry&, std::span<const uint32_t> duplicates,
               const AttributeMaker&, std::span<const GroomedStrand> strands);
  // `vertex` of the mesh is used by some strand of the layer.
  const VertexChain& operator[](uint32_t vertex) const { return chains_[slot_[vertex]]; }

 private:
  std::vector<uint32_t> slot_;  // of each mesh vertex
  std::vector<VertexChain> chains_;
};

struct LayerBake {
  const Mesh& mesh;
  const LayerSetup& layer;
  std::span<const GroomedStrand> strands;  // progressive order
  const VertexChains& vertices;
  float metres_per_mesh_unit;
  const ShellSkin* shells = nullptr;  // of a layer of shells
  // Of each strand of a layer of shells with fins, which are triangles: FindFinEdges. Else empty.
  std::span<const uint32_t> fin_edges = {};
};

// Appends the layer, its patches, chunks and joint boxes to the groom.
void AppendLayer(const LayerBake&, std::span<const ChunkPart> chunks,
                 std::span<const VertexPatch> patches, Groom& groom);

}  // namespace pelt
