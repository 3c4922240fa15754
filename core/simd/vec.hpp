// Vec<Isa>: the vector value on compiler vector extensions (SSE4, AVX2, AVX-512, AltiVec, NEON).
//
// Invariant: every operation is one IEEE-754 single-precision or 32-bit integer operation on each
// lane, the same as ArrayVec's. The instruction set is part of the type and so of every symbol that
// a kernel emits; two instruction sets never share a function body.
#pragma once

#include <cstdint>
#include <cstring>

#if defined(__SSE4_1__)
#include <immintrin.h>
#endif

// Under the address sanitizer a kernel inlined whole takes minutes to compile; those builds run on
// the machine that made them, so nothing can leak to a lesser one.
#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define PELT_INLINE inline
#define PELT_UNROLL
#define PELT_NO_UNROLL
#endif
#endif
#if defined(__SANITIZE_ADDRESS__) && !defined(PELT_INLINE)
#define PELT_INLINE inline
#endif
#if !defined(PELT_INLINE)
#define PELT_INLINE inline __attribute__((always_inline))
#endif

// Short loops over a kernel's own arrays, of up to 4 turns: as loops they go through memory. Longer
// ones (over chains of 8 links, whose arrays fit no registers) stay loops, of four turns at a time:
// laid out whole, the kernels of 8 links alone take as long to compile as all others. The other for
// bodies too long to have them several times. Under clang's sanitizers neither: their checks stand
// in the way, of which it warns.
#if defined(PELT_UNROLL)
#elif defined(__clang__)
#define PELT_UNROLL _Pragma("unroll(4)")
#define PELT_NO_UNROLL _Pragma("nounroll")
#else
#define PELT_UNROLL _Pragma("GCC unroll 4")
#define PELT_NO_UNROLL _Pragma("GCC unroll 1")
#endif

namespace pelt {

// Instruction-set tags. The tag is part of every kernel's symbol name.
struct IsaSse4 {
  static constexpr int kLanes = 4;
};
// The machine's own 128-bit vectors elsewhere than on x86: NEON, AltiVec.
struct IsaSimd128 {
  static constexpr int kLanes = 4;
};
struct IsaAvx2 {
  static constexpr int kLanes = 8;
};
struct IsaAvx512 {
  static constexpr int kLanes = 16;
};
// Fewer lanes of a set, for what would take too much of a stack with all of them.
template <class Isa, int kCount>
struct Narrow {
  static constexpr int kLanes = kCount;
};

namespace simd_detail {
template <int N>
struct Native;
#define PELT_NATIVE(N)                                      \
  template <>                                               \
  struct Native<N> {                                        \
    typedef float F __attribute__((vector_size(4 * N)));    \
    typedef int32_t I __attribute__((vector_size(4 * N)));  \
    typedef uint32_t U __attribute__((vector_size(4 * N))); \
    typedef uint8_t B __attribute__((vector_size(N)));      \
  }
PELT_NATIVE(4);
PELT_NATIVE(8);
PELT_NATIVE(16);
#undef PELT_NATIVE

using F4 = Native<4>::F;
}  // namespace simd_detail

template <class Isa>
struct Vec {
  static constexpr int kLanes = Isa::kLanes;
  using Raw = typename simd_detail::Native<kLanes>::F;
  using RawInt = typename simd_detail::Native<kLanes>::I;
  using RawUint = typename simd_detail::Native<kLanes>::U;

  // All bits set or clear in each lane.
  struct Mask {
    RawInt m;
    PELT_INLINE friend Mask operator&(Mask a, Mask b) { return {a.m & b.m}; }
    PELT_INLINE friend Mask operator|(Mask a, Mask b) { return {a.m | b.m}; }
    PELT_INLINE friend Mask operator!(Mask a) { return {~a.m}; }
    PELT_INLINE friend bool Any(Mask a) {
#if defined(__AVX512F__)
      if constexpr (kLanes == 16) return _mm512_test_epi32_mask(__m512i(a.m), __m512i(a.m)) != 0;
#endif
#if defined(__AVX__)
      if constexpr (kLanes == 8) return !_mm256_testz_si256(__m256i(a.m), __m256i(a.m));
#endif
#if defined(__SSE4_1__)
      if constexpr (kLanes == 4) return !_mm_testz_si128(__m128i(a.m), __m128i(a.m));
#endif
      int32_t any = 0;
      for (int i = 0; i < kLanes; ++i) any |= a.m[i];
      return any != 0;
    }
    PELT_INLINE friend bool AllSet(Mask a) { return !Any(!a); }
  };

  // 32-bit integers, wrapping. `>>` is logical (shifts in zeros).
  struct Int {
    RawInt i;
    PELT_INLINE Int() = default;
    PELT_INLINE Int(RawInt raw) : i(raw) {}
    PELT_INLINE Int(int32_t scalar) : i(RawInt{} + scalar) {}
    PELT_INLINE static Int Load(const int32_t* p) {
      RawInt r;
      std::memcpy(&r, p, sizeof r);
      return r;
    }
    PELT_INLINE static Int Load(const uint32_t* p) {
      RawInt r;
      std::memcpy(&r, p, sizeof r);
      return r;
    }
    // Widens kLanes unsigned bytes.
    PELT_INLINE static Int LoadBytes(const uint8_t* p) {
#if defined(__AVX512F__)
      // The masked form: g++ 12 warns inside its own unmasked one.
      if constexpr (kLanes == 16)
        return RawInt(_mm512_maskz_cvtepu8_epi32(
            0xffff, _mm_loadu_si128(reinterpret_cast<const __m128i*>(p))));
#endif
#if defined(__AVX2__)
      if constexpr (kLanes == 8)
        return RawInt(_mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(p))));
#endif
#if defined(__SSE4_1__)
      if constexpr (kLanes == 4) {
        int32_t four;
        std::memcpy(&four, p, 4);
        return RawInt(_mm_cvtepu8_epi32(_mm_cvtsi32_si128(four)));
      }
#endif
      RawInt r{};
      for (int l = 0; l < kLanes; ++l) r[l] = p[l];
      return r;
    }
    // first, first + 1, ... in lane order.
    PELT_INLINE static Int Iota(int32_t first) {
      RawInt r{};
      for (int l = 0; l < kLanes; ++l) r[l] = l;
      return r + first;
    }
    PELT_INLINE void Store(int32_t* p) const { std::memcpy(p, &i, sizeof i); }
    PELT_INLINE void Store(uint32_t* p) const { std::memcpy(p, &i, sizeof i); }
    PELT_INLINE int32_t operator[](int lane) const { return i[lane]; }
    PELT_INLINE friend Int operator+(Int a, Int b) { return RawInt(RawUint(a.i) + RawUint(b.i)); }
    PELT_INLINE friend Int operator-(Int a, Int b) { return RawInt(RawUint(a.i) - RawUint(b.i)); }
    PELT_INLINE friend Int operator*(Int a, Int b) { return RawInt(RawUint(a.i) * RawUint(b.i)); }
    PELT_INLINE friend Int operator&(Int a, Int b) { return a.i & b.i; }
    PELT_INLINE friend Int operator|(Int a, Int b) { return a.i | b.i; }
    PELT_INLINE friend Int operator^(Int a, Int b) { return a.i ^ b.i; }
    PELT_INLINE friend Int operator<<(Int a, int n) { return RawInt(RawUint(a.i) << n); }
    PELT_INLINE friend Int operator>>(Int a, int n) { return RawInt(RawUint(a.i) >> n); }
    PELT_INLINE friend Mask operator==(Int a, Int b) { return {a.i == b.i}; }
    PELT_INLINE friend Mask operator<(Int a, Int b) { return {a.i < b.i}; }
    PELT_INLINE friend Mask operator>(Int a, Int b) { return {a.i > b.i}; }
    PELT_INLINE friend Int Select(Mask m, Int a, Int b) { return m.m ? a.i : b.i; }
  };

  Raw v;
  PELT_INLINE Vec() = default;
  PELT_INLINE Vec(Raw raw) : v(raw) {}
  // x - 0 is x for every x, -0 included, so the compiler may drop it; 0 + x it may not.
  PELT_INLINE Vec(float scalar) : v(scalar - Raw{}) {}
  PELT_INLINE static Vec Load(const float* p) {
    Raw r;
    std::memcpy(&r, p, sizeof r);
    return r;
  }
  PELT_INLINE void Store(float* p) const { std::memcpy(p, &v, sizeof v); }
  PELT_INLINE float operator[](int lane) const { return v[lane]; }

  PELT_INLINE friend Vec operator+(Vec a, Vec b) { return a.v + b.v; }
  PELT_INLINE friend Vec operator-(Vec a, Vec b) { return a.v - b.v; }
  PELT_INLINE friend Vec operator*(Vec a, Vec b) { return a.v * b.v; }
  PELT_INLINE friend Vec operator/(Vec a, Vec b) { return a.v / b.v; }
  PELT_INLINE friend Vec operator-(Vec a) { return -a.v; }
  PELT_INLINE friend Mask operator<(Vec a, Vec b) { return {a.v < b.v}; }
  PELT_INLINE friend Mask operator>(Vec a, Vec b) { return {a.v > b.v}; }
  PELT_INLINE friend Mask operator<=(Vec a, Vec b) { return {a.v <= b.v}; }
  PELT_INLINE friend Mask operator>=(Vec a, Vec b) { return {a.v >= b.v}; }
  PELT_INLINE friend Mask operator==(Vec a, Vec b) { return {a.v == b.v}; }
  // Lane-wise m ? a : b.
  PELT_INLINE friend Vec Select(Mask m, Vec a, Vec b) { return m.m ? a.v : b.v; }
  // a < b ? a : b and a > b ? a : b: the second operand is returned for NaN and for equal zeros.
  PELT_INLINE friend Vec Min(Vec a, Vec b) { return a.v < b.v ? a.v : b.v; }
  PELT_INLINE friend Vec Max(Vec a, Vec b) { return a.v > b.v ? a.v : b.v; }
  PELT_INLINE friend Int Bits(Vec a) { return RawInt(a.v); }
  PELT_INLINE friend Vec FromBits(Int a) { return Raw(a.i); }
  // Rounds towards zero; |a| must be below 2^31.
  PELT_INLINE friend Int Truncate(Vec a) { return __builtin_convertvector(a.v, RawInt); }
  PELT_INLINE friend Vec ToFloat(Int a) { return __builtin_convertvector(a.i, Raw); }
};

// V, or as many lanes of its set as `kMost`.
template <class V, int kMost>
struct AtMostLanes {
  using Type = V;
};
template <class Isa, int kMost>
requires(Isa::kLanes > kMost) struct AtMostLanes<Vec<Isa>, kMost> {
  using Type = Vec<Narrow<Isa, kMost>>;
};

}  // namespace pelt
