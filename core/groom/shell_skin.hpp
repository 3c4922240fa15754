// What a layer of shells is made of: the triangles that fur grows on, what each of their vertices
// knows of it, and whose the fins on their edges are.
//
// A triangle is a strand of the layer: chunks are cut, skinned, culled and measured as those of any
// other. It takes a place of its middle, which decides which chunk it is in and nothing that is drawn;
// what is drawn is at the vertices. Their fur is groomed at the vertex itself, with the artist's
// attributes there, so that a map is as fine as the mesh. The stencil, how much of the fur stands, is
// what the layer's masks and its density map leave at the vertex.
//
// Invariant: a triangle is in the layer if fur grows at one of its corners or in its middle, and in
// exactly one chunk. Vertices that differ in texture coordinates alone have one chain
// (chunk_builder.hpp), so that shells do not part along a seam.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/groom/attributes.hpp"
#include "core/groom/growth.hpp"
#include "core/groom/scatter.hpp"

namespace pelt {

// One for each triangle, in the mesh's order. Throws pelt::Error when the mesh has no texture
// coordinates, and when no triangle is left.
std::vector<ScatterPoint> PlaceShells(const Character&, const RestGeometry&, const FurSetup&,
                                      const LayerSetup&, const Growth&,
                                      ScatterDensity* density = nullptr);

struct ShellColours {
  uint32_t base = 0, tip = 0;  // 0xAABBGGRR; alpha of the base: the stencil
};

class ShellSkin {
 public:
  ShellSkin(const Mesh&, const RestGeometry&, const Growth&, const AttributeMaker&,
            std::span<const ScatterPoint> triangles);

  // Strands that stand on the triangles' corners, for the chains at their vertices.
  const std::vector<GroomedStrand>& corners() const { return corners_; }
  // Of a vertex of the mesh that some triangle has.
  ShellColours operator[](uint32_t vertex) const { return colours_[vertex]; }

 private:
  std::vector<GroomedStrand> corners_;
  std::vector<ShellColours> colours_;  // of each vertex of the mesh
};

// Which triangle of a layer of shells has the fin on an edge (core/chunk.hpp, FinEdgeBlock): a word for each of
// `triangles`, which are in the mesh's order. `duplicates`: FindSeamDuplicates of the mesh.
//
// An edge is known by its two vertices, those that differ in texture coordinates alone taken as one:
// across a seam, and across the border of two chunks, it is the same edge. Of its triangles that
// fur grows on the first of the mesh owns it; so does the only one of an edge where the mesh or the
// fur ends.
//
// Invariant: every edge of the layer is owned once. An edge between a vertex and itself, of a
// triangle that is none, has no owner.
std::vector<uint32_t> FindFinEdges(const Mesh&, std::span<const uint32_t> duplicates,
                                   std::span<const ScatterPoint> triangles);

}  // namespace pelt
