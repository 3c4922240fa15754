// The triangles of a primitive: lists, strips and fans.
// Source: glTF 2.0, 3.7.2.1 (topology types).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/character/gltf_accessor.hpp"

namespace pelt::gltf {

struct Triangles {
  std::vector<std::array<uint32_t, 3>> of;
  size_t corners = 0;                     // that were read
  size_t nowhere = 0;                     // left out: with a vertex that does not exist
  size_t unusable = 0;                    // left out: with a vertex that cannot be used
  size_t left_over = 0;                   // corners that made no whole triangle
  std::optional<uint32_t> first_nowhere;  // the first index of a vertex that does not exist
};

// Of a primitive with a vertex for each of `unusable`, which says whether it cannot be used. What a
// strip or fan turns back with, a triangle that names a vertex twice, is not among them. A fault
// where there are more than `limit`, or where what was left out leaves nothing.
Triangles ReadTriangles(const Document& document, const Primitive& primitive,
                        std::span<const uint8_t> unusable, uint64_t limit, const std::string& place,
                        Fault& fault);

}  // namespace pelt::gltf
