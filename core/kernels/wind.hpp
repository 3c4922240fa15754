// Wind at the chain roots: the day's wind with its gusts, and turbulence carried along by it, or sines along two axes
// in its place; and what force volumes push besides.
//
//   acceleration = response * (mean(t) + turbulence * noise(frequency * position + scroll(t))) + push(position)
//
// Everything that needs time (sums of sines, the travelled way of the noise) is worked out once a
// frame on the caller's thread by MakeWindParams; the kernel sees a place and a few numbers.
//
// Invariant: no wind gives exactly 0, and so does a place outside of all volumes. What breaks if scroll is not wrapped
// by the noise's period: after minutes the noise falls onto ever coarser floats.
#pragma once

#include <string_view>

#include "core/chunk.hpp"
#include "core/kernel.hpp"
#include "core/streams.hpp"
#include "core/surroundings.hpp"

namespace pelt {

// A wave along an axis.
struct WindSine {
  float strength, turns_per_m, phase;  // m/s; whole turns a metre; turns at 0 m, 0 to 1
};

enum ForceFlag : uint32_t { kForceBox = 1u << 0, kForcePulls = 1u << 1 };

// A force volume where it is in this frame.
struct PlacedForce {
  float own[3][4];  // rows that take a place to its own space, where it reaches from -1 to 1
  float push[3];    // m/s^2; or, with kForcePulls, the place that it pulls to, m
  float pull;       // m/s^2, with kForcePulls
  float steepness;  // share of its strength gained for each share of the way in from its surface
  uint32_t flags;   // ForceFlag
};

// `count` of them; zero behind, as frames are compared bit for bit.
struct ForceParams {
  uint32_t count = 0;
  PlacedForce force[kForceVolumesPerScene] = {};
};

struct WindParams {
  float direction_speed[3];  // mean wind of this frame, gusts included, m/s
  float turbulence;          // largest component that the noise adds, m/s
  float frequency;           // noise cells a metre
  float scroll[3];           // noise offset of this frame, cells, in [0, kPerlinPeriod)
  uint32_t published = 0;    // not 0: WindKind::kPublished, and `sine` blows along x and z
  WindSine sine[2] = {};
  ForceParams forces = {};  // of layers with kLayerPushed
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

namespace wind_detail {

// Sine of so many whole turns, within 5e-6: the Taylor series in a quarter of one. Beyond a million it is clamped.
template <class V>
PELT_INLINE V SineOfTurns(V turns) {
  const V limit(1048576.0f), half(0.5f), zero(0.0f);
  turns = Clamp(turns, -limit, limit);
  const V part = turns - Floor(turns + half);
  const V size = Abs(part);
  const V a = Min(size, half - size), square = a * a;
  V sum = square * V(42.058693945f) - V(76.705859753f);
  sum = sum * square + V(81.605249277f);
  sum = sum * square - V(41.341702240f);
  const V sine = a * (sum * square + V(6.283185307f));
  return Select(part < zero, zero - sine, sine);
}

// What all volumes together do at a place, m/s^2. Never -0, by which what is outside would lose bits.
template <class V>
__attribute__((noinline)) void FindPush(const ForceParams& params, const Vec3<V>& place,
                                        Vec3<V>& sum) {
  const V zero(0.0f), one(1.0f);
  const Vec3<V> none = {zero, zero, zero};
  sum = none;
  for (uint32_t f = 0; f < params.count; ++f) {
    const PlacedForce& force = params.force[f];
    V square = zero, out = zero;
    for (const auto& row : force.own) {
      const Vec3<V> axis = {V(row[0]), V(row[1]), V(row[2])};
      const V own = Dot(axis, place) + V(row[3]);
      square = square + own * own;
      out = Max(out, Abs(own));
    }
    if (!(force.flags & kForceBox)) out = Sqrt(square);
    const V share = Clamp((one - out) * V(force.steepness), zero, one);
    Vec3<V> push = {V(force.push[0]), V(force.push[1]), V(force.push[2])};
    if (force.flags & kForcePulls) {
      const Vec3<V> way = push - place;
      push = NormalizeOr(way, none) * V(force.pull);
    }
    const Vec3<V> felt = push * share;
    sum = sum + felt;
  }
}

}  // namespace wind_detail

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
    const bool pushed = (ports.layer->flags & kLayerPushed) != 0;
    for (uint32_t lane = 0; lane < lanes; lane += V::kLanes) {
      Vec3<V> wind = mean;
      if (params.turbulence != 0.0f) {
        const Vec3<V> place = Load3<V>(ports.roots->position, lane) * V(params.frequency) + scroll;
        wind = wind + PerlinVector(place) * V(params.turbulence);
      }
      if (params.published != 0) AddSines(params.sine, Load3<V>(ports.roots->position, lane), wind);
      Vec3<V> push, acceleration = wind * response;
      if (pushed) {
        wind_detail::FindPush(params.forces, Load3<V>(ports.roots->position, lane), push);
        acceleration = acceleration + push;
      }
      Store3<V>(ports.wind->acceleration, lane, acceleration);
    }
  }

 private:
  static PELT_INLINE void AddSines(const WindSine (&sine)[2], const Vec3<V>& place, Vec3<V>& wind) {
    const auto wave = [](const WindSine& of, V at) __attribute__((always_inline)) {
      const V turns = at * V(of.turns_per_m) + V(of.phase);
      return wind_detail::SineOfTurns(turns) * V(of.strength);
    };
    wind.x = wind.x + wave(sine[0], place.x);
    wind.z = wind.z + wave(sine[1], place.z);
  }
};

}  // namespace pelt
