// Two vectors side by side, worn as one: how a kernel whose steps wait for each other keeps a core
// busy.
//
// A chain is solved point after point, so one group of strands is a long string of operations that
// each wait for the last. Unrolled<V> runs the same body on two groups at once; the compiler lays
// the two strings down alternately and the core overlaps them. Measured on the PBD solver: see
// bench/benchmarks/kernels/simulation_benchmark.cpp.
//
// Invariant: lane l of Unrolled<V> sees exactly the operations lane l of V would see. Nothing
// crosses from one half to the other, so the bits cannot depend on whether a body ran on V or on
// Unrolled<V>.
#pragma once

#include <algorithm>

#include "core/simd.hpp"

namespace pelt {

// For a type that records (V::SideBySide): what made `b` is the operation that made `a`, on the vector beside it.
namespace simd_detail {
template <class T>
PELT_INLINE uint32_t FirstOf(const T& a) {
  if constexpr (requires { a.id; })
    return a.id;
  else
    return FirstOf(a.a);
}
template <class T>
PELT_INLINE uint32_t LastOf(const T& a) {
  if constexpr (requires { a.id; })
    return a.id;
  else
    return LastOf(a.b);
}
template <class V, class T>
PELT_INLINE void NoteSides([[maybe_unused]] const T& a, [[maybe_unused]] const T& b) {
  if constexpr (requires { V::SideBySide(0u, 0u); }) V::SideBySide(LastOf(a), FirstOf(b));
}
}  // namespace simd_detail

template <class V>
struct Unrolled {
  static constexpr int kHalf = V::kLanes;
  static constexpr int kLanes = 2 * kHalf;

  struct Mask {
    typename V::Mask a, b;
    PELT_INLINE Mask() = default;
    PELT_INLINE Mask(typename V::Mask first, typename V::Mask second) : a(first), b(second) {
      simd_detail::NoteSides<V>(a, b);
    }
    PELT_INLINE friend Mask operator&(Mask x, Mask y) { return {x.a & y.a, x.b & y.b}; }
    PELT_INLINE friend Mask operator|(Mask x, Mask y) { return {x.a | y.a, x.b | y.b}; }
    PELT_INLINE friend Mask operator!(Mask x) { return {!x.a, !x.b}; }
    PELT_INLINE friend bool Any(Mask x) { return Any(x.a | x.b); }
    PELT_INLINE friend bool AllSet(Mask x) { return AllSet(x.a & x.b); }
  };

  struct Int {
    typename V::Int a, b;
    PELT_INLINE Int() = default;
    PELT_INLINE Int(int32_t scalar) : a(scalar), b(scalar) {}
    PELT_INLINE Int(typename V::Int first, typename V::Int second) : a(first), b(second) {
      simd_detail::NoteSides<V>(a, b);
    }
    PELT_INLINE static Int Iota(int32_t first) {
      return {V::Int::Iota(first), V::Int::Iota(first + kHalf)};
    }
    template <class T>
    PELT_INLINE static Int Load(const T* p) {
      return {V::Int::Load(p), V::Int::Load(p + kHalf)};
    }
    PELT_INLINE static Int LoadBytes(const uint8_t* p) {
      return {V::Int::LoadBytes(p), V::Int::LoadBytes(p + kHalf)};
    }
    template <class T>
    PELT_INLINE void Store(T* p) const {
      a.Store(p);
      b.Store(p + kHalf);
    }
    PELT_INLINE int32_t operator[](int lane) const {
      return lane < kHalf ? a[lane] : b[lane - kHalf];
    }
    PELT_INLINE friend Int operator+(Int x, Int y) { return {x.a + y.a, x.b + y.b}; }
    PELT_INLINE friend Int operator-(Int x, Int y) { return {x.a - y.a, x.b - y.b}; }
    PELT_INLINE friend Int operator*(Int x, Int y) { return {x.a * y.a, x.b * y.b}; }
    PELT_INLINE friend Int operator&(Int x, Int y) { return {x.a & y.a, x.b & y.b}; }
    PELT_INLINE friend Int operator|(Int x, Int y) { return {x.a | y.a, x.b | y.b}; }
    PELT_INLINE friend Int operator^(Int x, Int y) { return {x.a ^ y.a, x.b ^ y.b}; }
    PELT_INLINE friend Int operator<<(Int x, int n) { return {x.a << n, x.b << n}; }
    PELT_INLINE friend Int operator>>(Int x, int n) { return {x.a >> n, x.b >> n}; }
    PELT_INLINE friend Int Select(Mask m, Int x, Int y) {
      return {Select(m.a, x.a, y.a), Select(m.b, x.b, y.b)};
    }
    PELT_INLINE friend Mask operator==(Int x, Int y) { return {x.a == y.a, x.b == y.b}; }
    PELT_INLINE friend Mask operator<(Int x, Int y) { return {x.a < y.a, x.b < y.b}; }
  };

  V a, b;
  PELT_INLINE Unrolled() = default;
  PELT_INLINE Unrolled(float scalar) : a(scalar), b(scalar) {}
  PELT_INLINE Unrolled(V first, V second) : a(first), b(second) { simd_detail::NoteSides<V>(a, b); }
  PELT_INLINE static Unrolled LoadPicked(const float* row, const int32_t* lanes) {
    PickedLanes<V> first, second;
    std::copy_n(lanes, kHalf, first.lane);
    std::copy_n(lanes + kHalf, kHalf, second.lane);
    return {LoadLanes<V>(row, first), LoadLanes<V>(row, second)};
  }
  PELT_INLINE static Unrolled Load(const float* p) { return {V::Load(p), V::Load(p + kHalf)}; }
  PELT_INLINE void Store(float* p) const {
    a.Store(p);
    b.Store(p + kHalf);
  }
  PELT_INLINE friend Unrolled operator+(Unrolled x, Unrolled y) { return {x.a + y.a, x.b + y.b}; }
  PELT_INLINE friend Unrolled operator-(Unrolled x, Unrolled y) { return {x.a - y.a, x.b - y.b}; }
  PELT_INLINE friend Unrolled operator*(Unrolled x, Unrolled y) { return {x.a * y.a, x.b * y.b}; }
  PELT_INLINE friend Unrolled operator/(Unrolled x, Unrolled y) { return {x.a / y.a, x.b / y.b}; }
  PELT_INLINE friend Unrolled operator-(Unrolled x) { return {-x.a, -x.b}; }
  PELT_INLINE friend Mask operator<(Unrolled x, Unrolled y) { return {x.a < y.a, x.b < y.b}; }
  PELT_INLINE friend Mask operator>(Unrolled x, Unrolled y) { return {x.a > y.a, x.b > y.b}; }
  PELT_INLINE friend Mask operator<=(Unrolled x, Unrolled y) { return {x.a <= y.a, x.b <= y.b}; }
  PELT_INLINE friend Mask operator>=(Unrolled x, Unrolled y) { return {x.a >= y.a, x.b >= y.b}; }
  PELT_INLINE friend Unrolled Select(Mask m, Unrolled x, Unrolled y) {
    return {Select(m.a, x.a, y.a), Select(m.b, x.b, y.b)};
  }
  PELT_INLINE friend Unrolled Min(Unrolled x, Unrolled y) { return {Min(x.a, y.a), Min(x.b, y.b)}; }
  PELT_INLINE friend Unrolled Max(Unrolled x, Unrolled y) { return {Max(x.a, y.a), Max(x.b, y.b)}; }
  PELT_INLINE friend Int Truncate(Unrolled x) { return {Truncate(x.a), Truncate(x.b)}; }
  PELT_INLINE friend Unrolled ToFloat(Int x) { return {ToFloat(x.a), ToFloat(x.b)}; }
  PELT_INLINE static void SideBySide(uint32_t a, uint32_t b) requires requires {
    V::SideBySide(a, b);
  }
  { V::SideBySide(a, b); }
  // What core/simd/maths.hpp asks for.
  PELT_INLINE static Unrolled ReciprocalRoot(Unrolled x) requires requires {
    V::ReciprocalRoot(x.a);
  }
  { return {V::ReciprocalRoot(x.a), V::ReciprocalRoot(x.b)}; }
  // What core/simd/records.hpp asks for.
  template <int kFirst, class AddressOfLane>
  PELT_INLINE static Unrolled LoadHalves(const AddressOfLane& address) {
    return {LoadRecords<V, kFirst>(address),
            LoadRecords<V, kFirst>([&](int lane) { return address(lane + kHalf); })};
  }
  template <int kFirst, class AddressOfLane>
  PELT_INLINE static void StoreHalves(Unrolled x, const AddressOfLane& address) {
    StoreRecords<kFirst>(x.a, address);
    StoreRecords<kFirst>(x.b, [&](int lane) { return address(lane + kHalf); });
  }
  template <int kFirst>
  PELT_INLINE static Unrolled SplatHalves(Unrolled x) {
    return {SplatInFours<kFirst>(x.a), SplatInFours<kFirst>(x.b)};
  }
  PELT_INLINE static void Transpose(Unrolled& a, Unrolled& b, Unrolled& c, Unrolled& d) {
    TransposeFours(a.a, b.a, c.a, d.a);
    TransposeFours(a.b, b.b, c.b, d.b);
  }
  PELT_INLINE friend Int Bits(Unrolled x) { return {Bits(x.a), Bits(x.b)}; }
  PELT_INLINE friend Unrolled FromBits(Int x) { return {FromBits(x.a), FromBits(x.b)}; }
};

// As many groups at once as a machine's registers hold of any kernel's: where there are many, four.
template <class V>
concept HasManyRegisters = requires {
  V::kHasManyRegisters;
};
template <class V>
struct AtOnce {
  using Type = V;
};
template <HasManyRegisters V>
struct AtOnce<V> {
  using Type = Unrolled<Unrolled<V>>;
};
template <HasManyRegisters V, int kMost>
requires(4 * V::kLanes > kMost) struct AtMostLanes<Unrolled<Unrolled<V>>, kMost> {
  using Type = V;
};

}  // namespace pelt
