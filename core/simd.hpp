// The vector value type every kernel is written on.
//
// A kernel is a template on V. V is `Vec<Isa>` (compiler vector extensions: SSE4, AVX2, AVX-512,
// AltiVec, NEON) or `ArrayVec<N>` (plain arrays: the reference twin). All of them run the same
// sequence of IEEE-754 single-precision operations on every lane, so all of them produce the same
// bits.
//
// What breaks if the rules are ignored:
//  - No fused multiply-add, no hardware estimate, no reduction across lanes: each would make the
//  bits depend
//    on the machine or on the lane count. Build with -ffp-contract=off.
//  - Everything here is always-inline and V carries its instruction set in its type. A function
//  that is not
//    inlined would be merged by the linker across instruction sets, and an AVX body could be
//    reached on the SSE4 path (tests/porting/isa_leak_test.sh looks for that).
//
// The design proposed std::experimental::simd here. Compiler vector extensions are used instead:
// they have the shuffles that record transposition needs, leave no library function for the linker
// to merge in debug builds, and are the same source for g++ and clang.
#pragma once

#include <cstdint>
#include <cstring>

#if defined(__SSE4_1__)
#include <immintrin.h>
#endif

#define PELT_INLINE inline __attribute__((always_inline))

namespace pelt {

// Instruction-set tags. The tag is part of every kernel's symbol name.
struct IsaSse4 {
  static constexpr int kLanes = 4;
};
struct IsaAvx2 {
  static constexpr int kLanes = 8;
};
struct IsaAvx512 {
  static constexpr int kLanes = 16;
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
      if constexpr (kLanes == 16) return _mm512_test_epi32_mask((__m512i)a.m, (__m512i)a.m) != 0;
#endif
#if defined(__AVX__)
      if constexpr (kLanes == 8) return !_mm256_testz_si256((__m256i)a.m, (__m256i)a.m);
#endif
#if defined(__SSE4_1__)
      if constexpr (kLanes == 4) return !_mm_testz_si128((__m128i)a.m, (__m128i)a.m);
#endif
      int32_t any = 0;
      for (int i = 0; i < kLanes; ++i) any |= a.m[i];
      return any != 0;
    }
    PELT_INLINE friend bool All(Mask a) { return !Any(!a); }
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
      if constexpr (kLanes == 16)
        return (RawInt)_mm512_cvtepu8_epi32(_mm_loadu_si128(reinterpret_cast<const __m128i*>(p)));
#endif
#if defined(__AVX2__)
      if constexpr (kLanes == 8)
        return (RawInt)_mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(p)));
#endif
#if defined(__SSE4_1__)
      if constexpr (kLanes == 4) {
        int32_t four;
        std::memcpy(&four, p, 4);
        return (RawInt)_mm_cvtepu8_epi32(_mm_cvtsi32_si128(four));
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
    PELT_INLINE friend Int operator+(Int a, Int b) { return (RawInt)((RawUint)a.i + (RawUint)b.i); }
    PELT_INLINE friend Int operator-(Int a, Int b) { return (RawInt)((RawUint)a.i - (RawUint)b.i); }
    PELT_INLINE friend Int operator*(Int a, Int b) { return (RawInt)((RawUint)a.i * (RawUint)b.i); }
    PELT_INLINE friend Int operator&(Int a, Int b) { return a.i & b.i; }
    PELT_INLINE friend Int operator|(Int a, Int b) { return a.i | b.i; }
    PELT_INLINE friend Int operator^(Int a, Int b) { return a.i ^ b.i; }
    PELT_INLINE friend Int operator<<(Int a, int n) { return (RawInt)((RawUint)a.i << n); }
    PELT_INLINE friend Int operator>>(Int a, int n) { return (RawInt)((RawUint)a.i >> n); }
    PELT_INLINE friend Mask operator==(Int a, Int b) { return {a.i == b.i}; }
    PELT_INLINE friend Mask operator<(Int a, Int b) { return {a.i < b.i}; }
    PELT_INLINE friend Mask operator>(Int a, Int b) { return {a.i > b.i}; }
    PELT_INLINE friend Int Select(Mask m, Int a, Int b) { return m.m ? a.i : b.i; }
  };

  Raw v;
  PELT_INLINE Vec() = default;
  PELT_INLINE Vec(Raw raw) : v(raw) {}
  PELT_INLINE Vec(float scalar) : v(Raw{} + scalar) {}
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
  PELT_INLINE friend Int Bits(Vec a) { return (RawInt)a.v; }
  PELT_INLINE friend Vec FromBits(Int a) { return (Raw)a.i; }
  // Rounds towards zero; |a| must be below 2^31.
  PELT_INLINE friend Int Truncate(Vec a) { return __builtin_convertvector(a.v, RawInt); }
  PELT_INLINE friend Vec ToFloat(Int a) { return __builtin_convertvector(a.i, Raw); }
};

// The reference twin: the same operations on a plain array, for machines and compilers without
// vectors.
template <int N>
struct ArrayVec {
  static constexpr int kLanes = N;

  struct Mask {
    bool m[N];
    PELT_INLINE friend Mask operator&(Mask a, Mask b) {
      for (int i = 0; i < N; ++i) a.m[i] = a.m[i] && b.m[i];
      return a;
    }
    PELT_INLINE friend Mask operator|(Mask a, Mask b) {
      for (int i = 0; i < N; ++i) a.m[i] = a.m[i] || b.m[i];
      return a;
    }
    PELT_INLINE friend Mask operator!(Mask a) {
      for (int i = 0; i < N; ++i) a.m[i] = !a.m[i];
      return a;
    }
    PELT_INLINE friend bool Any(Mask a) {
      for (int i = 0; i < N; ++i)
        if (a.m[i]) return true;
      return false;
    }
    PELT_INLINE friend bool All(Mask a) { return !Any(!a); }
  };

#define PELT_LANEWISE(Type, name, a_, b_, field, expression) \
  PELT_INLINE friend Type name(Type a_, Type b_) {           \
    Type r;                                                  \
    for (int l = 0; l < N; ++l) r.field[l] = expression;     \
    return r;                                                \
  }
#define PELT_LANEWISE_COMPARE(Type, op, field)                     \
  PELT_INLINE friend Mask operator op(Type a, Type b) {            \
    Mask r;                                                        \
    for (int l = 0; l < N; ++l) r.m[l] = a.field[l] op b.field[l]; \
    return r;                                                      \
  }

  struct Int {
    int32_t i[N];
    PELT_INLINE Int() = default;
    PELT_INLINE Int(int32_t scalar) {
      for (int l = 0; l < N; ++l) i[l] = scalar;
    }
    PELT_INLINE static Int Load(const int32_t* p) {
      Int r;
      std::memcpy(r.i, p, sizeof r.i);
      return r;
    }
    PELT_INLINE static Int Load(const uint32_t* p) {
      Int r;
      std::memcpy(r.i, p, sizeof r.i);
      return r;
    }
    PELT_INLINE static Int LoadBytes(const uint8_t* p) {
      Int r;
      for (int l = 0; l < N; ++l) r.i[l] = p[l];
      return r;
    }
    PELT_INLINE static Int Iota(int32_t first) {
      Int r;
      for (int l = 0; l < N; ++l) r.i[l] = first + l;
      return r;
    }
    PELT_INLINE void Store(int32_t* p) const { std::memcpy(p, i, sizeof i); }
    PELT_INLINE void Store(uint32_t* p) const { std::memcpy(p, i, sizeof i); }
    PELT_INLINE int32_t operator[](int lane) const { return i[lane]; }
    PELT_LANEWISE(Int, operator+, a, b, i, int32_t(uint32_t(a.i[l]) + uint32_t(b.i[l])))
    PELT_LANEWISE(Int, operator-, a, b, i, int32_t(uint32_t(a.i[l]) - uint32_t(b.i[l])))
    PELT_LANEWISE(Int, operator*, a, b, i, int32_t(uint32_t(a.i[l]) * uint32_t(b.i[l])))
    PELT_LANEWISE(Int, operator&, a, b, i, a.i[l] & b.i[l])
    PELT_LANEWISE(Int, operator|, a, b, i, a.i[l] | b.i[l])
    PELT_LANEWISE(Int, operator^, a, b, i, a.i[l] ^ b.i[l])
    PELT_INLINE friend Int operator<<(Int a, int n) {
      for (int l = 0; l < N; ++l) a.i[l] = int32_t(uint32_t(a.i[l]) << n);
      return a;
    }
    PELT_INLINE friend Int operator>>(Int a, int n) {
      for (int l = 0; l < N; ++l) a.i[l] = int32_t(uint32_t(a.i[l]) >> n);
      return a;
    }
    PELT_LANEWISE_COMPARE(Int, ==, i)
    PELT_LANEWISE_COMPARE(Int, <, i)
    PELT_LANEWISE_COMPARE(Int, >, i)
    PELT_INLINE friend Int Select(Mask m, Int a, Int b) {
      for (int l = 0; l < N; ++l) a.i[l] = m.m[l] ? a.i[l] : b.i[l];
      return a;
    }
  };

  float v[N];
  PELT_INLINE ArrayVec() = default;
  PELT_INLINE ArrayVec(float scalar) {
    for (int l = 0; l < N; ++l) v[l] = scalar;
  }
  PELT_INLINE static ArrayVec Load(const float* p) {
    ArrayVec r;
    std::memcpy(r.v, p, sizeof r.v);
    return r;
  }
  PELT_INLINE void Store(float* p) const { std::memcpy(p, v, sizeof v); }
  PELT_INLINE float operator[](int lane) const { return v[lane]; }
  PELT_LANEWISE(ArrayVec, operator+, a, b, v, a.v[l] + b.v[l])
  PELT_LANEWISE(ArrayVec, operator-, a, b, v, a.v[l] - b.v[l])
  PELT_LANEWISE(ArrayVec, operator*, a, b, v, a.v[l] * b.v[l])
  PELT_LANEWISE(ArrayVec, operator/, a, b, v, a.v[l] / b.v[l])
  PELT_INLINE friend ArrayVec operator-(ArrayVec a) {
    for (int l = 0; l < N; ++l) a.v[l] = -a.v[l];
    return a;
  }
  PELT_LANEWISE_COMPARE(ArrayVec, <, v)
  PELT_LANEWISE_COMPARE(ArrayVec, >, v)
  PELT_LANEWISE_COMPARE(ArrayVec, <=, v)
  PELT_LANEWISE_COMPARE(ArrayVec, >=, v)
  PELT_LANEWISE_COMPARE(ArrayVec, ==, v)
  PELT_INLINE friend ArrayVec Select(Mask m, ArrayVec a, ArrayVec b) {
    for (int l = 0; l < N; ++l) a.v[l] = m.m[l] ? a.v[l] : b.v[l];
    return a;
  }
  PELT_LANEWISE(ArrayVec, Min, a, b, v, a.v[l] < b.v[l] ? a.v[l] : b.v[l])
  PELT_LANEWISE(ArrayVec, Max, a, b, v, a.v[l] > b.v[l] ? a.v[l] : b.v[l])
#undef PELT_LANEWISE
#undef PELT_LANEWISE_COMPARE
  PELT_INLINE friend Int Bits(ArrayVec a) {
    Int r;
    std::memcpy(r.i, a.v, sizeof r.i);
    return r;
  }
  PELT_INLINE friend ArrayVec FromBits(Int a) {
    ArrayVec r;
    std::memcpy(r.v, a.i, sizeof r.v);
    return r;
  }
  PELT_INLINE friend Int Truncate(ArrayVec a) {
    Int r;
    for (int l = 0; l < N; ++l) r.i[l] = int32_t(a.v[l]);
    return r;
  }
  PELT_INLINE friend ArrayVec ToFloat(Int a) {
    ArrayVec r;
    for (int l = 0; l < N; ++l) r.v[l] = float(a.i[l]);
    return r;
  }
};

// ---- Exact maths shared by every V
// -------------------------------------------------------------------

// Clears the sign.
template <class V>
PELT_INLINE V Abs(V a) {
  return FromBits(Bits(a) & typename V::Int(0x7fffffff));
}

template <class V>
PELT_INLINE V Clamp(V a, V low, V high) {
  return Min(Max(a, low), high);
}

// Largest integer not above a; |a| must be below 2^31.
template <class V>
PELT_INLINE V Floor(V a) {
  const V t = ToFloat(Truncate(a));
  return Select(t > a, t - V(1.0f), t);
}

// 1 / sqrt(a) for normal positive a, relative error below 2e-7. An integer seed (3.4 % off), one
// step of third order and one of second: plain multiplies and subtractions, so the bits are the
// same everywhere; hardware estimates differ between vendors. For a = 0 it returns a large finite
// number, so that a * Rsqrt(a) is 0.
template <class V>
PELT_INLINE V Rsqrt(V a) {
  using I = typename V::Int;
  V y = FromBits(I(0x5f375a86) - (Bits(a) >> 1));
  const V e = V(1.0f) - a * y * y;
  y = y + y * e * (V(0.5f) + V(0.375f) * e);
  return y + y * V(0.5f) * (V(1.0f) - a * y * y);
}

// sqrt(a), relative error below 3e-7; 0 for a = 0.
template <class V>
PELT_INLINE V Sqrt(V a) {
  return a * Rsqrt(a);
}

// ---- Three-component vectors of V
// --------------------------------------------------------------------

template <class V>
struct Vec3 {
  V x, y, z;
  PELT_INLINE friend Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  PELT_INLINE friend Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  PELT_INLINE friend Vec3 operator*(Vec3 a, V s) { return {a.x * s, a.y * s, a.z * s}; }
  PELT_INLINE friend V Dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
  PELT_INLINE friend Vec3 Cross(Vec3 a, Vec3 b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
  }
  PELT_INLINE friend Vec3 Normalize(Vec3 a) { return a * Rsqrt(Dot(a, a)); }
};

template <class V>
PELT_INLINE Vec3<V> Select(typename V::Mask m, Vec3<V> a, Vec3<V> b) {
  return {Select(m, a.x, b.x), Select(m, a.y, b.y), Select(m, a.z, b.z)};
}

// Loads kLanes values from each of three rows (x, y, z) of one block, starting at `lane`.
template <class V, int S>
PELT_INLINE Vec3<V> Load3(const float (&rows)[3][S], uint32_t lane) {
  return {V::Load(rows[0] + lane), V::Load(rows[1] + lane), V::Load(rows[2] + lane)};
}
template <class V, int S>
PELT_INLINE void Store3(float (&rows)[3][S], uint32_t lane, Vec3<V> a) {
  a.x.Store(rows[0] + lane);
  a.y.Store(rows[1] + lane);
  a.z.Store(rows[2] + lane);
}

// ---- 16-byte records: the one irregular access
// ------------------------------------------------------- A record is four floats. Records are
// loaded whole, blended whole and transposed four at a time: measured against element-by-element
// loads (6.7 ns) and hardware gathers (3.6 ns) this costs 3.1 ns for nine values.

struct Record4 {
  simd_detail::F4 r;
};

PELT_INLINE Record4 LoadRecord(const float* p) {
  Record4 out;
  std::memcpy(&out.r, p, 16);
  return out;
}
PELT_INLINE void StoreRecord(float* p, Record4 a) { std::memcpy(p, &a.r, 16); }
PELT_INLINE Record4 operator+(Record4 a, Record4 b) { return {a.r + b.r}; }
PELT_INLINE Record4 operator*(Record4 a, float s) { return {a.r * (simd_detail::F4{} + s)}; }

// Four records in, four columns out (and back: it is its own inverse).
PELT_INLINE void Transpose4(Record4& a, Record4& b, Record4& c, Record4& d) {
  const auto ab_lo = __builtin_shufflevector(a.r, b.r, 0, 4, 1, 5);
  const auto ab_hi = __builtin_shufflevector(a.r, b.r, 2, 6, 3, 7);
  const auto cd_lo = __builtin_shufflevector(c.r, d.r, 0, 4, 1, 5);
  const auto cd_hi = __builtin_shufflevector(c.r, d.r, 2, 6, 3, 7);
  a.r = __builtin_shufflevector(ab_lo, cd_lo, 0, 1, 4, 5);
  b.r = __builtin_shufflevector(ab_lo, cd_lo, 2, 3, 6, 7);
  c.r = __builtin_shufflevector(ab_hi, cd_hi, 0, 1, 4, 5);
  d.r = __builtin_shufflevector(ab_hi, cd_hi, 2, 3, 6, 7);
}

// Calls record(lane) -> Record4 for each of kLanes lanes and returns the four columns as V.
template <class V, class RecordOfLane>
PELT_INLINE void GatherColumns(RecordOfLane record, V& x, V& y, V& z, V& w) {
  static_assert(V::kLanes % 4 == 0);
  alignas(64) float column[4][V::kLanes];
  for (int l = 0; l < V::kLanes; l += 4) {
    Record4 a = record(l), b = record(l + 1), c = record(l + 2), d = record(l + 3);
    Transpose4(a, b, c, d);
    StoreRecord(column[0] + l, a);
    StoreRecord(column[1] + l, b);
    StoreRecord(column[2] + l, c);
    StoreRecord(column[3] + l, d);
  }
  x = V::Load(column[0]);
  y = V::Load(column[1]);
  z = V::Load(column[2]);
  w = V::Load(column[3]);
}

// Writes the lanes of four columns as kLanes records; address(lane) -> float* to 16 bytes.
template <class V, class AddressOfLane>
PELT_INLINE void ScatterRecords(AddressOfLane address, V x, V y, V z, V w) {
  static_assert(V::kLanes % 4 == 0);
  alignas(64) float column[4][V::kLanes];
  x.Store(column[0]);
  y.Store(column[1]);
  z.Store(column[2]);
  w.Store(column[3]);
  for (int l = 0; l < V::kLanes; l += 4) {
    Record4 a = LoadRecord(column[0] + l), b = LoadRecord(column[1] + l);
    Record4 c = LoadRecord(column[2] + l), d = LoadRecord(column[3] + l);
    Transpose4(a, b, c, d);
    StoreRecord(address(l), a);
    StoreRecord(address(l + 1), b);
    StoreRecord(address(l + 2), c);
    StoreRecord(address(l + 3), d);
  }
}

}  // namespace pelt
