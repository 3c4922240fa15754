// The vector value type every kernel is written on.
//
// A kernel is a template on V. V is `Vec<Isa>` (compiler vector extensions: SSE4, AVX2, AVX-512,
// AltiVec, NEON) or `ArrayVec<N>` (plain arrays: the reference). All of them run the same
// sequence of IEEE-754 single-precision operations on every lane, so all of them produce the same
// bits.
//
//   simd/vec.hpp        Vec<Isa>, its Mask and Int
//   simd/array_vec.hpp  ArrayVec<N>: the same on plain arrays
//   simd/maths.hpp      Floor, Rsqrt, Sqrt; Vec3 and unit frames
//   simd/records.hpp    16-byte records to columns and back; lanes of a row, side by side or picked
//   simd/words.hpp      scalar words, for sorting
//
// What breaks if the rules are ignored:
//  - No fused multiply-add, no hardware estimate, no reduction across lanes: each would make the
//    bits depend on the machine or on the lane count. Build with -ffp-contract=off.
//  - Everything here is always-inline and V carries its instruction set in its type. A function
//    that is not inlined would be merged by the linker across instruction sets, and an AVX body
//    could be reached on the SSE4 path (tests/porting/isa_leak_test.sh looks for that).
//
// The design proposed std::experimental::simd here. Compiler vector extensions are used instead:
// they have the shuffles that record transposition needs, leave no library function for the linker
// to merge in debug builds, and are the same source for g++ and clang.
#pragma once

#include "core/simd/array_vec.hpp"
#include "core/simd/maths.hpp"
#include "core/simd/records.hpp"
#include "core/simd/vec.hpp"
#include "core/simd/words.hpp"
