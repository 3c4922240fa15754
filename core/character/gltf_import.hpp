// glTF 2.0 in: a skinned, animated character from .glb or .gltf bytes.
//
// What comes out is whole: finite, weights summing to 1, joints parent-first, key times ascending.
// What had to be repaired, left out or guessed is in Character::notes, one sentence each: all that
// three.js, Blender and the like repair or drop. What leaves no character to read is one Error:
// "<file>: <place>: <reason>". Neither is longer than 300 bytes. Hostile bytes neither crash nor
// hang it, and its memory is bounded by the file's size.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "core/character/character.hpp"

namespace pelt {

// `name` stands for the file in messages and becomes Character::name. Buffers in other files are
// errors here: bytes have no folder. Units are the file's own.
Character ImportGltf(std::span<const std::byte> bytes, const std::string& name);

// Reads `path`; buffers in other files are found beside it. Character::name is the file's name
// without folder and extension.
Character ImportGltfFile(const std::string& path);

}  // namespace pelt
