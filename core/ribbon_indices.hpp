// Triangle lists for ribbon vertices (RibbonVertexBlock): four quads per hair, two triangles per quad,
// counter-clockwise as the camera sees them.
//
//   2i+2 --- 2i+3     vertices of a hair, in memory order: left and right of point 0, of point 1,
//   ...
//     |   \   |       quad i: (2i, 2i+1, 2i+2) (2i+2, 2i+1, 2i+3)
//    2i --- 2i+1      hair h of the buffer begins at vertex h * kRibbonVerticesPerHair
//
// Vertices in draw order need one index buffer for ever (WriteRibbonIndices); vertices in strand
// order are drawn through one that follows the order (WriteSortedRibbonIndices), written each
// frame.
#pragma once

#include <cstdint>
#include <span>

#include "core/chunk.hpp"

namespace pelt {

inline constexpr uint32_t kRibbonVerticesPerHair = kRibbonPoints * 2;
inline constexpr uint32_t kRibbonIndicesPerHair = (kRibbonPoints - 1) * 6;

// Indices of hairs 0, 1, 2, ... as many as fill `indices` (its size is a multiple of
// kRibbonIndicesPerHair; a rest is left as it is).
void WriteRibbonIndices(std::span<uint32_t> indices);

// Indices of the hairs of a layer in drawing order (LayerDraw::order), for vertices that lie in
// strand order from vertex `first_vertex` on. Returns the number of indices written; stops at the
// end of either span.
uint32_t WriteSortedRibbonIndices(std::span<const uint32_t> order, uint32_t first_vertex,
                                  std::span<uint32_t> indices);

}  // namespace pelt
