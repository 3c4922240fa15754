// Wind at the chain roots: the day's wind with its gusts, and turbulence carried along by it.
//
//   acceleration = response * (mean(t) + turbulence * noise(frequency * position + scroll(t)))
//
// Everything that needs time (sums of sines, the travelled way of the noise) is worked out once a
// frame on the caller's thread by MakeWindParams; the kernel sees a place and a few numbers.
//
// Invariant: no wind gives exactly 0. What breaks if scroll is not wrapped by the noise's period:
// after minutes the noise falls onto ever coarser floats.
#pragma once

#include <string_view>

#include "core/chunk.hpp"
#include "core/kernel.hpp"
#include "core/streams.hpp"
#include "core/surroundings.hpp"

namespace pelt {

struct WindParams {
  float direction_speed[3];  // mean wind of this frame, gusts included, m/s
  float turbulence;          // largest component that the noise adds, m/s
  float frequency;           // noise cells a metre
  float scroll[3];           // noise offset of this frame, cells, in [0, kPerlinPeriod)
};

// Wind of the moment `time_s` (0 or later), in core/wind_setup.cpp. Exact for weeks: phases are
// wrapped in double. Still air (velocity and turbulence 0) is all zeros. The noise travels at the
// mean velocity, so a change of velocity in mid-run makes it jump; gusts do not.
// `origin`: of the places it is asked at, world, m.
WindParams MakeWindParams(const WindSetup& setup, double time_s,
                          const double (&origin)[3] = {0.0, 0.0, 0.0});

// ---- Gradient noise of three components ------------------------------------------------------
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

inline constexpr int32_t kPerlinPeriod = 256;  // lattice cells, a power of two, at most 256

namespace wind_detail {

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

}  // namespace wind_detail

// Noise at p, in lattice cells. Beyond a million cells p is clamped: floats are too coarse there.
template <class V>
PELT_INLINE Vec3<V> PerlinVector(Vec3<V> p) {
  using Int = typename V::Int;
  using wind_detail::CornerRamps;
  using wind_detail::Lerp;
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

  const V u = wind_detail::QuinticFade(f.x);
  const V v = wind_detail::QuinticFade(f.y);
  const V w = wind_detail::QuinticFade(f.z);
  // Every corner and plane is named, so that no compiler computes them in another order
  // (pricing/trace.hpp).
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

// ---- The kernel ---------------------------------------------------------------------------------

// Lanes are mesh vertices with kVertexChains, strands otherwise.
template <class V, bool kVertexChains>
struct Wind {
  static constexpr std::string_view kName = kVertexChains ? "wind_vertices" : "wind_strands";
  using Params = WindParams;
  using Of = ChainStreams<4, kVertexChains>;  // those of strands are the same for all points
  struct Ports {
    In<Of::kState> state;
    Shared<&Streams::layers> layer;
    In<Of::kRoots> roots;
    Out<Of::kWind> wind;
  };

  static void Run(const Params& params, const Ports& ports) {
    const uint32_t live = kVertexChains ? ports.state->live_chains : ports.state->live_strands;
    const uint32_t lanes = RoundUpToLaneGroups(live);
    const V response(ports.layer->wind_response);
    const Vec3<V> mean = {V(params.direction_speed[0]), V(params.direction_speed[1]),
                          V(params.direction_speed[2])};
    const Vec3<V> scroll = {V(params.scroll[0]), V(params.scroll[1]), V(params.scroll[2])};
    for (uint32_t lane = 0; lane < lanes; lane += V::kLanes) {
      Vec3<V> wind = mean;
      if (params.turbulence != 0.0f) {
        const Vec3<V> place = Load3<V>(ports.roots->position, lane) * V(params.frequency) + scroll;
        wind = wind + PerlinVector(place) * V(params.turbulence);
      }
      Store3<V>(ports.wind->acceleration, lane, wind * response);
    }
  }
};

}  // namespace pelt
