// Making a mesh whole: welding, normals, tangents, degenerate triangles. Pure functions; all sums
// run in double and in the order of the triangles, so the bits do not depend on the machine.
//
// "Missing" is written as the zero vector: a mesh may have normals on one primitive and none on the
// next.
#pragma once

#include <cstddef>

#include "core/character/character.hpp"

namespace pelt {

// Numbers the vertices by the first part of the triangles that uses each, and within a part as they
// were: as if every part had brought its own. `part_ends`: the triangles up to each part's end.
// Returns where each vertex was.
std::vector<uint32_t> OrderByUse(const std::vector<size_t>& part_ends, Mesh* mesh);

// Merges vertices that agree in every attribute (bit for bit, but 0 and -0 are equal) and drops
// those no triangle uses. The first of equals stays; order is kept. Returns how many went.
size_t WeldVertices(Mesh* mesh);

// Removes triangles that name a vertex twice or have no area. Returns how many went.
size_t DropDegenerateTriangles(Mesh* mesh);

// Fills missing (zero) normals with the area-weighted sum over all triangles that touch the same
// position, so seams in UVs or materials do not show. Where that sum vanishes (a folded sheet) the
// largest triangle at the position decides. Returns how many were filled.
size_t GenerateNormals(Mesh* mesh);

// Fills missing (zero) tangents: along increasing u where the UVs say so, else a direction across
// the normal that is a fixed function of the normal. All tangents are made unit and orthogonal to
// the normal. Returns how many were filled.
size_t GenerateTangents(Mesh* mesh);

// Gives every vertex the mean, by area, of the normals at its position that are within `degrees` of its own, 0 to 180:
// where a mesh has hard edges, what grows on both sides of one then grows the same way. Returns how
// many changed.
size_t SmoothCreases(double degrees, Mesh* mesh);

// Gives every vertex that is marked in `lost` the joints and weights of the nearest vertex that it
// shares a triangle or its position with and that has some; those that then have some serve the
// next ones. Returns how many got some.
size_t BorrowWeights(Mesh* mesh, std::vector<uint8_t> lost);

// A unit vector orthogonal to the unit vector n, a fixed function of n: horizontal where there is
// a horizontal (y up), continuous except near the poles.
glm::dvec3 PickTangent(const glm::dvec3& n);

}  // namespace pelt
