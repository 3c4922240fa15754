// Refuses to compile what would compute other bits. Included by every source that computes a value
// of a frame or a groom: the kernels (kernels/frame_table.cpp), the parameters, the baking.
//
// The bits are those of IEEE-754 single and double arithmetic, one rounded operation at a time, in
// the order written. Contraction of a * b + c leaves no trace for the preprocessor: configuring
// looks for it in what the compiler makes (float_probe.cmake), and for the rest of these again.
//
// Not included by public headers: a program that uses an installed Pelt may be built with any of
// these, as long as Pelt itself is not.
#pragma once

#if defined(__FAST_MATH__) || defined(_M_FP_FAST)
#error \
    "Pelt's bits need IEEE-754 arithmetic: -ffast-math (part of -Ofast; /fp:fast) reorders sums and drops signs of zero. Build Pelt without it."
#elif defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__ != 0
#error \
    "Pelt's bits need IEEE-754 arithmetic: -ffinite-math-only removes the checks for values that are not finite. Build Pelt without it."
#elif defined(__GNUC__) && !defined(__clang__) && defined(__GCC_IEC_559) && __GCC_IEC_559 == 0
#error \
    "Pelt's bits need IEEE-754 arithmetic: one of -funsafe-math-optimizations, -fassociative-math, -freciprocal-math, -fno-signed-zeros and -fsingle-precision-constant is on. Build Pelt without it."
#endif

#if defined(_M_FP_CONTRACT)
#error \
    "Pelt's bits need every operation rounded: /fp:contract fuses products and sums. Build Pelt with /fp:strict or without it."
#endif

#if defined(__FLT_EVAL_METHOD__) && __FLT_EVAL_METHOD__ != 0
#error \
    "Pelt's bits need float arithmetic in float (FLT_EVAL_METHOD 0): this target computes in a wider type. On 32-bit x86 build with -msse2 -mfpmath=sse."
#endif
