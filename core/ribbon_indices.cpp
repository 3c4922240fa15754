#include "core/ribbon_indices.hpp"

namespace pelt {
namespace {

void WriteHair(uint32_t first_vertex, uint32_t* out) {
  for (uint32_t quad = 0; quad + 1 < kRibbonPoints; ++quad) {
    const uint32_t left = first_vertex + 2 * quad;
    const uint32_t corners[6] = {left, left + 1, left + 2, left + 2, left + 1, left + 3};
    for (uint32_t corner : corners) *out++ = corner;
  }
}

}  // namespace

void WriteRibbonIndices(std::span<uint32_t> indices) {
  const uint32_t hairs = uint32_t(indices.size() / kRibbonIndicesPerHair);
  for (uint32_t hair = 0; hair < hairs; ++hair)
    WriteHair(hair * kRibbonVerticesPerHair, indices.data() + size_t(hair) * kRibbonIndicesPerHair);
}

uint32_t WriteSortedRibbonIndices(std::span<const uint32_t> order, uint32_t first_vertex,
                                  std::span<uint32_t> indices) {
  const size_t room = indices.size() / kRibbonIndicesPerHair;
  const size_t hairs = room < order.size() ? room : order.size();
  for (size_t i = 0; i < hairs; ++i)
    WriteHair(first_vertex + order[i] * kRibbonVerticesPerHair,
              indices.data() + i * kRibbonIndicesPerHair);
  return uint32_t(hairs * kRibbonIndicesPerHair);
}

}  // namespace pelt
