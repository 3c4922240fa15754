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

// Where and why something cannot be read; the first that is said counts. What does without goes on
// with a note, which is no exception: where there are none (the page), a throw ends the program.
struct Fault {
  std::string text;

  explicit operator bool() const { return !text.empty(); }
  // false, for those who return it.
  bool Say(const std::string& place, const std::string& what) {
    if (text.empty()) text = place + ": " + what;
    return false;
  }
};

// Elements of the accessor; 0 for a bad one, which `fault` then describes.
uint64_t CountElements(const Document& document, int accessor, const std::string& place,
                       Fault& fault);

// Of each accessor the first that has the same elements: exporters name the same bytes by several.
std::vector<int> FindSameAccessors(const Document& document);

// components * count floats, finite unless others are wanted; none for a bad accessor, as above.
std::vector<float> ReadFloats(const Document& document, int accessor, const Wanted& wanted,
                              const std::string& place, Fault& fault);

// The same of unsigned integers, regardless of what the type says of their sign.
std::vector<uint32_t> ReadIntegers(const Document& document, int accessor, const Wanted& wanted,
                                   const std::string& place, Fault& fault);

// Throws Error("<file>: <place>: <what>").
[[noreturn]] void Fail(const Document& document, const std::string& place, const std::string& what);

}  // namespace pelt::gltf
