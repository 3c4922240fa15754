// Gradient noise of three components, for wind.
//
// Perlin's construction ("Improving noise", 2002): a pseudo-random gradient at every point of the
// unit lattice, the eight ramps around a place blended with 6t^5 - 15t^4 + 10t^3. The gradients are
// the eight diagonals of a cube, so that a ramp is three sign changes and two additions. One hash a
// corner serves all three components: the second and third take the same three signs turned
// cyclically, which leaves each pair of components uncorrelated over a cell (tested). No tables: a
// table would be a gather.
//
// Invariants: each component lies in [-1, 1] (the blend of |x| + |y| + |z| never exceeds 3/2), is 0
// at every lattice point, is twice differentiable, and repeats every kPerlinPeriod cells, so that a
// scrolling offset may be wrapped there. What breaks if the period changes: wind jumps at the wrap.
#pragma once

#include <cstdint>

#include "core/simd/maths.hpp"

namespace pelt {

inline constexpr int32_t kPerlinPeriod = 256;  // lattice cells, a power of two, at most 256

namespace simd_detail {

template <class V>
PELT_INLINE V Lerp(V a, V b, V t) {
  return a + t * (b - a);
}

template <class V>
PELT_INLINE Vec3<V> Lerp(Vec3<V> a, Vec3<V> b, V t) {
  return {Lerp(a.x, b.x, t), Lerp(a.y, b.y, t), Lerp(a.z, b.z, t)};
}

template <class V>
PELT_INLINE V QuinticFade(V t) {
  return t * t * t * (t * (t * V(6.0f) - V(15.0f)) + V(10.0f));
}

// The three ramps of one corner at offset (x, y, z) from it, signs from the top three bits of
// `hash`.
template <class V>
PELT_INLINE Vec3<V> CornerRamps(typename V::Int hash, V x, V y, V z) {
  using Int = typename V::Int;
  const Int sign(INT32_MIN);
  const Int a = hash & sign, b = (hash << 1) & sign, c = (hash << 2) & sign;
  const auto flip = [](V value, Int by) { return FromBits(Bits(value) ^ by); };
  return {flip(x, a) + flip(y, b) + flip(z, c), flip(x, b) + flip(y, c) + flip(z, a),
          flip(x, c) + flip(y, a) + flip(z, b)};
}

}  // namespace simd_detail

// Noise at p, in lattice cells. Beyond a million cells p is clamped: floats are too coarse there.
template <class V>
PELT_INLINE Vec3<V> PerlinVector(Vec3<V> p) {
  using Int = typename V::Int;
  using simd_detail::CornerRamps;
  using simd_detail::Lerp;
  const V limit(1048576.0f), one(1.0f);
  p = {Clamp(p.x, -limit, limit), Clamp(p.y, -limit, limit), Clamp(p.z, -limit, limit)};
  const Vec3<V> cell = {Floor(p.x), Floor(p.y), Floor(p.z)};
  const Vec3<V> f = p - cell;
  const Vec3<V> g = {f.x - one, f.y - one, f.z - one};

  // Lattice coordinates of both sides, wrapped, each in bits of its own.
  const Int wrap(kPerlinPeriod - 1), next(1);
  const Int ix = Truncate(cell.x), iy = Truncate(cell.y), iz = Truncate(cell.z);
  const Int x0 = ix & wrap, x1 = (ix + next) & wrap;
  const Int y0 = (iy & wrap) << 8, y1 = ((iy + next) & wrap) << 8;

  // Columns and planes are hashed first, corners from them. The last multiplication must see two
  // well-mixed words: with a bare z, neighbouring planes came out correlated.
  const auto mix = [](Int key) __attribute__((always_inline)) {
    Int h = key * Int(int32_t(0x9e3779b1u));
    h = (h ^ (h >> 15)) * Int(int32_t(0x85ebca6bu));
    return h ^ (h >> 13);
  };
  const auto corner = [](Int column, Int plane) {
    return (column ^ plane) * Int(int32_t(0xc2b2ae35u));
  };
  const Int salt(1 << 16);  // keeps planes apart from columns
  const Int z0 = mix((iz & wrap) | salt), z1 = mix(((iz + next) & wrap) | salt);
  const Int c00 = mix(x0 | y0), c10 = mix(x1 | y0), c01 = mix(x0 | y1), c11 = mix(x1 | y1);

  const V u = simd_detail::QuinticFade(f.x);
  const V v = simd_detail::QuinticFade(f.y);
  const V w = simd_detail::QuinticFade(f.z);
  // Every corner and plane is named, so that no compiler computes them in another order
  // (pricing/written_order.hpp).
  const auto blend_plane = [&](Int z, V fz) __attribute__((always_inline)) {
    const Vec3<V> r00 = CornerRamps<V>(corner(c00, z), f.x, f.y, fz);
    const Vec3<V> r10 = CornerRamps<V>(corner(c10, z), g.x, f.y, fz);
    const Vec3<V> near = Lerp(r00, r10, u);
    const Vec3<V> r01 = CornerRamps<V>(corner(c01, z), f.x, g.y, fz);
    const Vec3<V> r11 = CornerRamps<V>(corner(c11, z), g.x, g.y, fz);
    const Vec3<V> far = Lerp(r01, r11, u);
    return Lerp(near, far, v);
  };
  const Vec3<V> lower = blend_plane(z0, f.z), upper = blend_plane(z1, g.z);
  return Lerp(lower, upper, w) * V(2.0f / 3.0f);
}

}  // namespace pelt
