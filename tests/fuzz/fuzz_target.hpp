// What a fuzz target is: one file format, read as hostile bytes, and what reads well used as its
// user would use it. Targets are linked to libFuzzer (tests/fuzz/run.sh) and, as ordinary tests, to
// corpus_test.cpp, which runs the seed corpus and seeded mutations of it.
//
// Invariant: for any bytes, a target neither crashes nor hangs, throws nothing but pelt::Error
// (which it catches), and holds at most MemoryBound(size) of heap at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace pelt::fuzz {

// Defined by each target.
void ReadHostile(std::span<const std::byte> input);

// Heap bytes at one time for an input of `size` bytes: what the caps of the formats allow (a glTF
// mesh and a clip at their largest, a scene of one groom) plus what a byte of input can unfold to.
constexpr size_t MemoryBound(size_t size) { return (size_t{64} << 20) + 64 * size; }

}  // namespace pelt::fuzz
