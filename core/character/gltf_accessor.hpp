// Reading accessors, checked: index, type, component, range in view and buffer, sparse indices and
// finiteness are all tested before a byte is believed.
//
// Invariant: nothing is allocated before the count is known to fit the file's bytes.
// Source: glTF 2.0, 3.6 (accessors), 3.6.2.3 (sparse), 3.11 (normalised integers).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/character/gltf_document.hpp"

namespace pelt::gltf {

// Sets of component types.
enum ComponentSet : uint32_t {
  kSetF32 = 1,
  kSetU8 = 2,
  kSetU16 = 4,
  kSetU32 = 8,
  kSetI8 = 16,
  kSetI16 = 32,
  kSetUnsigned = kSetU8 | kSetU16 | kSetU32,
  kSetAny = 63,
};

enum class Scaling {
  kAsFlagged,   // integers are normalised where the accessor says so
  kNormalised,  // integers are always normalised: u8 255 is 1
};

// What a reader wants of an accessor.
struct Wanted {
  int components = 1;  // 16: MAT4
  uint32_t allowed = kSetF32;
  Scaling scaling = Scaling::kAsFlagged;
  bool finite = true;  // else what is not finite is kept, for the reader to repair
};

// Elements of the accessor. Throws Error (file, place, reason) for a bad accessor.
uint64_t CountElements(const Document& document, int accessor, const std::string& place);

// Of each accessor the first that has the same elements: exporters name the same bytes by several.
std::vector<int> FindSameAccessors(const Document& document);

// components * count floats, finite unless others are wanted. Throws Error as above.
std::vector<float> ReadFloats(const Document& document, int accessor, const Wanted& wanted,
                              const std::string& place);

// components * count unsigned integers; `wanted.allowed` must hold unsigned types only.
std::vector<uint32_t> ReadIntegers(const Document& document, int accessor, const Wanted& wanted,
                                   const std::string& place);

// Throws Error("<file>: <place>: <what>").
[[noreturn]] void Fail(const Document& document, const std::string& place, const std::string& what);

}  // namespace pelt::gltf
