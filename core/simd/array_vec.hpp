// ArrayVec<N>: the vector value on plain arrays. The reference, and the fallback for compilers
// without vector extensions.
//
// Invariant: lane for lane the same operations as Vec, written so that they can be checked by eye.
#pragma once

#include <cstdint>
#include <cstring>

#include "core/simd/vec.hpp"

namespace pelt {

// The reference: the same operations on a plain array, for machines and compilers without
// vectors.
template <int N>
struct ArrayVec {
  static constexpr int kLanes = N;

  struct Mask {
    bool m[N];
    inline friend Mask operator&(Mask a, Mask b) {
      for (int i = 0; i < N; ++i) a.m[i] = a.m[i] && b.m[i];
      return a;
    }
    inline friend Mask operator|(Mask a, Mask b) {
      for (int i = 0; i < N; ++i) a.m[i] = a.m[i] || b.m[i];
      return a;
    }
    inline friend Mask operator!(Mask a) {
      for (int i = 0; i < N; ++i) a.m[i] = !a.m[i];
      return a;
    }
    inline friend bool Any(Mask a) {
      for (int i = 0; i < N; ++i)
        if (a.m[i]) return true;
      return false;
    }
    inline friend bool AllSet(Mask a) { return !Any(!a); }
  };

#define PELT_LANEWISE(Type, name, a_, b_, field, expression) \
  inline friend Type name(Type a_, Type b_) {                \
    Type r;                                                  \
    for (int l = 0; l < N; ++l) r.field[l] = expression;     \
    return r;                                                \
  }
#define PELT_LANEWISE_COMPARE(Type, op, field)                     \
  inline friend Mask operator op(Type a, Type b) {                 \
    Mask r;                                                        \
    for (int l = 0; l < N; ++l) r.m[l] = a.field[l] op b.field[l]; \
    return r;                                                      \
  }

  struct Int {
    int32_t i[N];
    inline Int() = default;
    inline Int(int32_t scalar) {
      for (int l = 0; l < N; ++l) i[l] = scalar;
    }
    inline static Int Load(const int32_t* p) {
      Int r;
      std::memcpy(r.i, p, sizeof r.i);
      return r;
    }
    inline static Int Load(const uint32_t* p) {
      Int r;
      std::memcpy(r.i, p, sizeof r.i);
      return r;
    }
    inline static Int LoadBytes(const uint8_t* p) {
      Int r;
      for (int l = 0; l < N; ++l) r.i[l] = p[l];
      return r;
    }
    inline static Int Iota(int32_t first) {
      Int r;
      for (int l = 0; l < N; ++l) r.i[l] = first + l;
      return r;
    }
    inline void Store(int32_t* p) const { std::memcpy(p, i, sizeof i); }
    inline void Store(uint32_t* p) const { std::memcpy(p, i, sizeof i); }
    inline int32_t operator[](int lane) const { return i[lane]; }
    PELT_LANEWISE(Int, operator+, a, b, i, int32_t(uint32_t(a.i[l]) + uint32_t(b.i[l])))
    PELT_LANEWISE(Int, operator-, a, b, i, int32_t(uint32_t(a.i[l]) - uint32_t(b.i[l])))
    PELT_LANEWISE(Int, operator*, a, b, i, int32_t(uint32_t(a.i[l]) * uint32_t(b.i[l])))
    PELT_LANEWISE(Int, operator&, a, b, i, a.i[l] & b.i[l])
    PELT_LANEWISE(Int, operator|, a, b, i, a.i[l] | b.i[l])
    PELT_LANEWISE(Int, operator^, a, b, i, a.i[l] ^ b.i[l])
    inline friend Int operator<<(Int a, int n) {
      for (int l = 0; l < N; ++l) a.i[l] = int32_t(uint32_t(a.i[l]) << n);
      return a;
    }
    inline friend Int operator>>(Int a, int n) {
      for (int l = 0; l < N; ++l) a.i[l] = int32_t(uint32_t(a.i[l]) >> n);
      return a;
    }
    PELT_LANEWISE_COMPARE(Int, ==, i)
    PELT_LANEWISE_COMPARE(Int, <, i)
    PELT_LANEWISE_COMPARE(Int, >, i)
    inline friend Int Select(Mask m, Int a, Int b) {
      for (int l = 0; l < N; ++l) a.i[l] = m.m[l] ? a.i[l] : b.i[l];
      return a;
    }
  };

  float v[N];
  inline ArrayVec() = default;
  inline ArrayVec(float scalar) {
    for (int l = 0; l < N; ++l) v[l] = scalar;
  }
  inline static ArrayVec Load(const float* p) {
    ArrayVec r;
    std::memcpy(r.v, p, sizeof r.v);
    return r;
  }
  inline void Store(float* p) const { std::memcpy(p, v, sizeof v); }
  inline float operator[](int lane) const { return v[lane]; }
  PELT_LANEWISE(ArrayVec, operator+, a, b, v, a.v[l] + b.v[l])
  PELT_LANEWISE(ArrayVec, operator-, a, b, v, a.v[l] - b.v[l])
  PELT_LANEWISE(ArrayVec, operator*, a, b, v, a.v[l] * b.v[l])
  PELT_LANEWISE(ArrayVec, operator/, a, b, v, a.v[l] / b.v[l])
  inline friend ArrayVec operator-(ArrayVec a) {
    for (int l = 0; l < N; ++l) a.v[l] = -a.v[l];
    return a;
  }
  PELT_LANEWISE_COMPARE(ArrayVec, <, v)
  PELT_LANEWISE_COMPARE(ArrayVec, >, v)
  PELT_LANEWISE_COMPARE(ArrayVec, <=, v)
  PELT_LANEWISE_COMPARE(ArrayVec, >=, v)
  PELT_LANEWISE_COMPARE(ArrayVec, ==, v)
  inline friend ArrayVec Select(Mask m, ArrayVec a, ArrayVec b) {
    for (int l = 0; l < N; ++l) a.v[l] = m.m[l] ? a.v[l] : b.v[l];
    return a;
  }
  PELT_LANEWISE(ArrayVec, Min, a, b, v, a.v[l] < b.v[l] ? a.v[l] : b.v[l])
  PELT_LANEWISE(ArrayVec, Max, a, b, v, a.v[l] > b.v[l] ? a.v[l] : b.v[l])
#undef PELT_LANEWISE
#undef PELT_LANEWISE_COMPARE
  inline friend Int Bits(ArrayVec a) {
    Int r;
    std::memcpy(r.i, a.v, sizeof r.i);
    return r;
  }
  inline friend ArrayVec FromBits(Int a) {
    ArrayVec r;
    std::memcpy(r.v, a.i, sizeof r.v);
    return r;
  }
  inline friend Int Truncate(ArrayVec a) {
    Int r;
    for (int l = 0; l < N; ++l) r.i[l] = int32_t(a.v[l]);
    return r;
  }
  inline friend ArrayVec ToFloat(Int a) {
    ArrayVec r;
    for (int l = 0; l < N; ++l) r.v[l] = float(a.i[l]);
    return r;
  }
};

}  // namespace pelt
