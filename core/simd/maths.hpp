// Exact maths and three-component vectors on any vector value V.
//
// Invariant: built from plus, minus, times, compare and integer operations alone, so the bits are
// the same on every machine. What breaks if ignored: a hardware estimate or a fused multiply-add
// in here changes every digest.
#pragma once

#include <cstdint>

#include "core/simd/vec.hpp"

namespace pelt {

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
  // A type that records takes it as one operation, of the same bits.
  if constexpr (requires { V::ReciprocalRoot(a); }) return V::ReciprocalRoot(a);
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

// ---- Three-component vectors of V -----------------------------------------------------------

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
  // x * a + y * b + z * c. Written as three products of vectors, the compiler would choose which of
  // them is computed first, and with it what a recorded kernel costs (pricing/trace.hpp).
  PELT_INLINE friend Vec3 Combine(Vec3 x, V a, Vec3 y, V b, Vec3 z, V c) {
    return {x.x * a + y.x * b + z.x * c, x.y * a + y.y * b + z.y * c, x.z * a + y.z * b + z.z * c};
  }
};

template <class V>
PELT_INLINE Vec3<V> Select(typename V::Mask m, Vec3<V> a, Vec3<V> b) {
  return {Select(m, a.x, b.x), Select(m, a.y, b.y), Select(m, a.z, b.z)};
}

// ---- Unit frames ----------------------------------------------------------------------------
//
// The usual lane costs one reciprocal square root. A lane whose squares would leave the range of
// floats, or whose direction is lost, takes the long way; the branch only skips work, so the bits
// of a lane never depend on its neighbours.

namespace simd_detail {
// a scaled so that its largest component is +-1 (or a itself where it is 0).
template <class V>
PELT_INLINE Vec3<V> ScaleToOne(Vec3<V> a) {
  // Halved first: the reciprocal of the largest floats is below the normal range.
  const Vec3<V> h = a * V(0.5f);
  const V largest = Max(Max(Abs(h.x), Abs(h.y)), Abs(h.z));
  const V divisor = Select(largest > V(1e-37f), largest, V(1.0f));
  return {h.x / divisor, h.y / divisor, h.z / divisor};
}
}  // namespace simd_detail

// a / |a|, or `fallback` where a is 0 (no component above 2e-37). Any finite a, however long.
template <class V>
PELT_INLINE Vec3<V> NormalizeOr(Vec3<V> a, Vec3<V> fallback) {
  const V squared = Dot(a, a);
  const typename V::Mask usual = (squared > V(1e-30f)) & (squared < V(1e38f));
  Vec3<V> unit = a * Rsqrt(squared);
  if (!AllSet(usual)) {
    const Vec3<V> scaled = simd_detail::ScaleToOne(a);
    const V length_squared = Dot(scaled, scaled);  // 0, tiny, or in [1, 3]
    const Vec3<V> rare =
        Select<V>(length_squared > V(0.5f), scaled * Rsqrt(length_squared), fallback);
    unit = Select<V>(usual, unit, rare);
  }
  return unit;
}

// The unit vector across the unit normal `n` that is nearest to `t`; where t is 0 or along n, some
// unit vector across n.
template <class V>
PELT_INLINE Vec3<V> UnitAcross(Vec3<V> n, Vec3<V> t) {
  const V along = Dot(n, t);
  const Vec3<V> across = t - n * along;
  const V squared = Dot(across, across);
  // Below a tenth of the part along n, cancellation would leave the result visibly off square.
  const typename V::Mask usual =
      (squared > Max(V(1e-2f) * along * along, V(1e-30f))) & (squared < V(1e38f));
  Vec3<V> unit = across * Rsqrt(squared);
  if (!AllSet(usual)) {
    const Vec3<V> scaled = simd_detail::ScaleToOne(t);
    Vec3<V> rare = scaled - n * Dot(n, scaled);
    const typename V::Mask lost = Dot(rare, rare) < V(1e-10f);
    // The axis x or y that leans less on n.
    const typename V::Mask use_x = Abs(n.x) < V(0.6f);
    const V one(1.0f), zero(0.0f);
    const Vec3<V> axis = {Select(use_x, one, zero), Select(use_x, zero, one), zero};
    rare = Select<V>(lost, axis, rare);
    rare = rare * Rsqrt(Dot(rare, rare));
    rare = rare - n * Dot(n, rare);
    rare = rare * Rsqrt(Dot(rare, rare));
    unit = Select<V>(usual, unit, rare);
  }
  return unit;
}

// `v` turned as the least turn that takes unit vector `from` to unit vector `to` turns it; half a
// turn is ambiguous and made about some axis.
template <class V>
PELT_INLINE Vec3<V> TurnLeast(Vec3<V> from, Vec3<V> to, Vec3<V> v) {
  constexpr float kLeastCosine = 1.0e-3f;  // and one
  const Vec3<V> axis = Cross(from, to);
  const V cosine = Dot(from, to);
  const Vec3<V> across = Cross(axis, v);
  const V along = Dot(axis, v) / Max(V(1.0f) + cosine, V(kLeastCosine));
  return v * cosine + across + axis * along;
}

// d turned towards the unit vector u until u . d is `least`, `most` at most, where it is less.
template <class V>
PELT_INLINE void LeanAlong(Vec3<V> u, V least, float most, V allowed, Vec3<V>& d) {
  const V wanted = Clamp(least, V(-1.0f), V(most));
  const typename V::Mask inside = Dot(u, d) < Min(least, V(most)) - allowed;
  if (!Any(inside)) return;
  const Vec3<V> across = UnitAcross(u, d);
  const Vec3<V> along = u * wanted;
  const Vec3<V> turned = along + across * Sqrt(Max(V(1.0f) - wanted * wanted, V(0.0f)));
  d = Select<V>(inside, turned, d);
}

}  // namespace pelt
