// Which triangle of a layer of shells has the fin on an edge (core/chunk.hpp, FinEdgeBlock).
//
// An edge is known by its two vertices, those that differ in texture coordinates alone taken as one:
// across a seam, and across the border of two chunks, it is the same edge. Of its triangles that
// fur grows on the first of the mesh owns it; so does the only one of an edge where the mesh or the
// fur ends.
//
// Invariant: every edge of the layer is owned once. An edge between a vertex and itself, of a
// triangle that is none, has no owner.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/character/character.hpp"
#include "core/groom/scatter.hpp"

namespace pelt {

// A word for each of `triangles`, which are in the mesh's order. `duplicates`: FindSeamDuplicates of
// the mesh.
std::vector<uint32_t> FindFinEdges(const Mesh&, std::span<const uint32_t> duplicates,
                                   std::span<const ScatterPoint> triangles);

}  // namespace pelt
