// A look at a glTF's JSON before a parser sees it. tinygltf copies the binary chunk once for every
// buffer without a URI, recurses into extras and indexes buffers by image views unchecked: a small
// file could eat the memory or the stack. So nesting is bounded, buffers without a URI are counted,
// and top-level members that are not ours are renamed, which hides them from it.
//
// This is a scanner, not a parser: text that is not JSON passes and is refused later.
#pragma once

#include <span>
#include <string>

namespace pelt::gltf {

inline constexpr int kMaxJsonDepth = 64;
inline constexpr int kMaxBuffers = 256;

// Masks in place. Returns an empty string, or why the text must not be parsed (reason with byte
// offset, without the file's name).
std::string GuardJson(std::span<char> json);

}  // namespace pelt::gltf
