// Patches: which strands of a layer share a chunk.
//
// Strands are laid along a path by halving the layer again and again across its widest direction
// (place, or facing once a part is about a chunk wide, so that the two sides of an ear part) and
// always going on with the half that is nearer to where the path stands. Halves are cut at whole
// chunks, and the strands of a triangle stay together but where a cut goes through it: chunks that
// share a triangle each skin and simulate its vertices. Then chunks are cut from the path greedily,
// as long as strands, vertices or weight rows last: full chunks whatever runs out first, and where
// strands run out first the chunks are the leaves of the halving.
//
// Inside a chunk strands keep the layer's progressive order; vertices are ordered by their first
// use at 1/8, 1/4, 1/2 and all of the strands, so that a prefix of strands needs a prefix of
// vertices, and within that so that groups of 16 share joints.
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

struct Patch {
  std::vector<uint32_t> strands;   // places in the layer's progressive order, ascending
  std::vector<uint32_t> vertices;  // of the mesh, in chunk order
  std::vector<VertexGroup> groups;
};

// How many of each a chunk holds.
struct PatchLimits {
  uint32_t strands = kStrandsPerChunk;
  uint32_t vertices = kVerticesPerChunk;
  uint32_t rows = kInfluenceRows;
};

// `strands` in progressive order. Every strand is in exactly one patch.
std::vector<Patch> CutPatches(const Mesh&, std::span<const PatchStrand> strands,
                              const PatchLimits& limits = {});

}  // namespace pelt
