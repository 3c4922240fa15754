// Which strands of a layer share a chunk, and which of its mesh vertices a patch.
//
// Strands are laid along a path by halving the layer again and again across its widest direction
// (place, or facing once a part is about a chunk wide, so that the two sides of an ear part) and
// always going on with the half that is nearer to where the path stands. Halves are cut at whole
// chunks, and the strands of a triangle stay together but where a cut goes through it. Then chunks are
// cut from the path greedily, each as long as strands and the vertices that they use allow; where
// strands run out first the chunks are the leaves of the halving.
//
// Inside a chunk strands keep the layer's progressive order.
//
// Vertices are patched in the order in which the chunks use them, each once, in parts of one size. In a
// patch they are ordered by how long their chains stay when these thin (chain_order.hpp), then by the
// share of living strands, 1/8, 1/4, 1/2 and all, from which on some chunk uses them, so that a prefix
// of strands needs a prefix of vertices, and within that so that groups of 16 share joints.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "core/character/character.hpp"
#include "core/chunk.hpp"

namespace pelt {

struct PatchStrand {
  glm::vec3 position;                // rest pose, m
  glm::vec3 normal;                  // unit
  std::array<uint32_t, 3> vertices;  // of the mesh
  float radius;                      // DensestPackingRadius of the density here, m
};

// Dense weights of up to 16 vertices: the joints any of them uses, ascending.
struct VertexGroup {
  std::vector<uint8_t> joints;
};

struct ChunkPart {
  std::vector<uint32_t> strands;   // places in the layer's progressive order, ascending
  std::vector<uint32_t> vertices;  // of the mesh, that they use, in the order of the first use
};

struct VertexPatch {
  std::vector<uint32_t> vertices;  // of the mesh, in the patch's order
  std::vector<VertexGroup> groups;
};

// How many of each a chunk and its halo hold.
struct ChunkLimits {
  uint32_t strands = kStrandsPerChunk;
  uint32_t vertices = kVerticesPerChunk;
};

// `strands` in progressive order. Every strand is in exactly one chunk.
std::vector<ChunkPart> CutChunks(std::span<const PatchStrand> strands,
                                 const ChunkLimits& limits = {});

// Every vertex that a chunk uses is in exactly one patch. `first`: 1 of those whose chains go first in their patch;
// empty: none.
std::vector<VertexPatch> PackVertices(const Mesh&, std::span<const PatchStrand> strands,
                                      std::span<const ChunkPart> chunks,
                                      std::span<const uint8_t> first = {});

}  // namespace pelt
