// What light reaches a layer: lights and irradiance samples at the centre of its bounds, as real
// spherical harmonics up to degree 3 for each of three colours.
//
// Idea: the 16 coefficients are the lanes, so every light is one sum per lane and no lane is ever
// added to another. Each basis function is a product of a linear and a quadratic form of the
// direction, whose coefficients are rows of a table (Sloan, Stupid Spherical Harmonics Tricks,
// 2008, for the functions; order 00, 1-1, 10, 11, 2-2 .. 22, 3-3 .. 33, all signs positive). A
// light that is round about its direction d has c_lm = f_l Y_lm(d): f_l is 1 for a point, and for a
// ball or a half sphere what Funk and Hecke's theorem gives.
//
// The harmonics are of radiance. Lambert's irradiance over pi takes the bands times 1, 2/3, 1/4 and
// 0; Kajiya and Kay's diffuse lobe over pi^2 times 1, 0, -1/8 and 0. The last band is for wrapped
// and specular lobes.
//
// Invariant: samples and lights are added in index order; none of them divides by how many there
// are, so that one that fades out is the same as one that is not there.
#pragma once

#include <string_view>

#include "core/kernel.hpp"
#include "core/layer.hpp"
#include "core/streams.hpp"
#include "core/surroundings.hpp"

namespace pelt {

// Entries behind the counts are as by default.
struct LightLayerParams {
  Lighting lighting;
};

namespace light_layer_detail {

inline constexpr float kPi = 3.14159265f;
inline constexpr float kY00 = 0.282094792f;
// Nearer than a centimetre a point light is as bright as there.
inline constexpr float kNearest2 = 1.0e-4f;
// Squares of what lies within 1e15 m are finite.
inline constexpr float kFarthest2 = 1.0e30f;

// Y = (a + ax x + ay y + az z) (b + bxx x^2 + byy y^2 + bzz z^2 + by y + bz z + byz y z).
enum BasisRow { kA, kAx, kAy, kAz, kB, kBxx, kByy, kBzz, kBy, kBz, kByz, kBasisRows };
struct alignas(64) Basis {
  float row[kBasisRows][kHarmonics];
};

consteval Basis MakeBasis() {
  constexpr float k1 = 0.488602512f, k2 = 1.092548431f, k20 = 0.315391565f, k22 = 0.546274215f;
  constexpr float k30 = 0.373176333f, k31 = 0.457045799f, k32 = 1.445305721f, k33 = 0.590043590f;
  Basis b{};
  constexpr BasisRow kFirst[kHarmonics] = {kA, kAy, kAz, kAx, kAx, kAy, kA,  kAx,
                                           kA, kAy, kAx, kAy, kAz, kAx, kAz, kAx};
  for (uint32_t i = 0; i < kHarmonics; ++i) b.row[kFirst[i]][i] = 1.0f;
  const auto set = [&](uint32_t i, BasisRow row, float value) { b.row[row][i] = value; };
  set(0, kB, kY00);
  for (uint32_t i = 1; i < 4; ++i) set(i, kB, k1);
  set(4, kBy, k2);
  set(5, kBz, k2);
  set(6, kBzz, 3.0f * k20), set(6, kB, -k20);
  set(7, kBz, k2);
  set(8, kBxx, k22), set(8, kByy, -k22);
  set(9, kBxx, 3.0f * k33), set(9, kByy, -k33);
  set(10, kByz, 2.0f * k32);
  set(11, kBzz, 5.0f * k31), set(11, kB, -k31);
  set(12, kBzz, 5.0f * k30), set(12, kB, -3.0f * k30);
  set(13, kBzz, 5.0f * k31), set(13, kB, -k31);
  set(14, kBxx, k32), set(14, kByy, -k32);
  set(15, kBxx, k33), set(15, kByy, -3.0f * k33);
  return b;
}
// One for each vector: what is compiled for several instruction sets shares no symbol.
template <class V>
inline constexpr Basis kBasis = MakeBasis();

// The basis functions of lanes from `lane` on, in one direction.
template <class V>
PELT_INLINE V BasisAt(const Vec3<V>& d, uint32_t lane) {
  const auto row = [lane](BasisRow r) __attribute__((always_inline)) {
    return V::Load(kBasis<V>.row[r] + lane);
  };
  const V xx = d.x * d.x, yy = d.y * d.y, zz = d.z * d.z, yz = d.y * d.z;
  const V linear = row(kA) + row(kAx) * d.x + row(kAy) * d.y + row(kAz) * d.z;
  const V squares = row(kB) + row(kBxx) * xx + row(kByy) * yy + row(kBzz) * zz;
  const V mixed = row(kBy) * d.y + row(kBz) * d.z + row(kByz) * yz;
  return linear * (squares + mixed);
}

// One value for each degree, in the lanes of its functions.
template <class V>
PELT_INLINE V PerDegree(const V (&f)[4], uint32_t lane) {
  using I = typename V::Int;
  const I i = I::Iota(int32_t(lane));
  const V upper = Select(i < I(9), f[2], f[3]), lower = Select(i < I(1), f[0], f[1]);
  return Select(i < I(4), lower, upper);
}

template <class V>
struct Harmonics {
  static constexpr uint32_t kGroups = kHarmonics / V::kLanes;
  V sum[3][kGroups];

  PELT_INLINE void Clear() {
    for (auto& colour : sum)
      for (V& group : colour) group = V(0.0f);
  }
  // What is round about `direction`: of each colour and degree f[colour][l].
  PELT_INLINE void Add(const Vec3<V>& direction, const V (&f)[3][4]) {
    for (uint32_t g = 0; g < kGroups; ++g) {
      const uint32_t lane = g * V::kLanes;
      const V basis = BasisAt(direction, lane);
      for (int k = 0; k < 3; ++k) {
        const V factor = PerDegree(f[k], lane);
        sum[k][g] = sum[k][g] + basis * factor;
      }
    }
  }
};

template <class V>
PELT_INLINE Vec3<V> Splat3(const float (&v)[3]) {
  return {V(v[0]), V(v[1]), V(v[2])};
}

// Over the square of the distance, and faded towards the light's range.
template <class V>
PELT_INLINE void AddLight(const SphereLight& light, const Vec3<V>& centre, Harmonics<V>& out) {
  const V zero(0.0f), one(1.0f);
  const Vec3<V> up = {zero, one, zero}, apart = Splat3<V>(light.position) - centre;
  const V distance2 = Min(Dot(apart, apart), V(kFarthest2));
  const V radius2(light.radius * light.radius);
  const V reach2 = Max(Max(distance2, radius2), V(kNearest2));
  V power = one / reach2;
  if (light.range > 0.0f) {
    const V left = Max(one - distance2 / V(light.range * light.range), zero);
    power = power * left * left;
  }
  // Cosine of half the angle that the ball takes up; 0 from its surface inwards.
  const V cosine2 = Max(one - radius2 / reach2, zero), cosine = Sqrt(cosine2);
  const V per_degree[4] = {V(2.0f) / (one + cosine), one, cosine, V(1.25f) * cosine2 - V(0.25f)};
  V f[3][4];
  for (int k = 0; k < 3; ++k)
    for (int l = 0; l < 4; ++l) f[k][l] = V(light.rgb[k]) * power * per_degree[l];
  out.Add(NormalizeOr(apart, up), f);
}

// Distance over falloff: a sample is in reach below 1.
template <class V>
PELT_INLINE V ShareOfFalloff(const IrradianceSample& sample, const Vec3<V>& centre) {
  const Vec3<V> apart = Splat3<V>(sample.position) - centre;
  return Sqrt(Min(Dot(apart, apart), V(kFarthest2))) / V(sample.falloff);
}

// All samples as one sky and one ground: weighted by the square of what is left to the falloff, over
// the sum of the weights. Out of reach of all, what is relatively nearest counts alone, which is
// what was left when the last one went out of reach.
template <class V>
PELT_INLINE void AddSamples(const Lighting& in, const Vec3<V>& centre, Harmonics<V>& out) {
  const V zero(0.0f), one(1.0f);
  V total = zero, nearest(3e38f);
  for (uint32_t s = 0; s < in.sample_count; ++s) {
    const V share = ShareOfFalloff(in.sample[s], centre), left = Max(one - share, zero);
    total = total + left * left;
    nearest = Min(share, nearest);
  }
  const auto in_reach = total > zero;
  Vec3<V> sky = {zero, zero, zero}, ground = sky, up = sky;
  V weights = zero;
  for (uint32_t s = 0; s < in.sample_count; ++s) {
    const IrradianceSample& sample = in.sample[s];
    const V share = ShareOfFalloff(sample, centre), left = Max(one - share, zero);
    const V alone = Select(share <= nearest, one, zero);
    const V weight = Select(in_reach, left * left, alone);
    weights = weights + weight;
    sky = sky + Splat3<V>(sample.sky) * weight;
    ground = ground + Splat3<V>(sample.ground) * weight;
    up = up + Splat3<V>(sample.up) * weight;
  }
  const V scale = one / weights;
  const Vec3<V> both = (sky + ground) * scale, more = (sky - ground) * scale;
  const V sums[3] = {both.x, both.y, both.z}, differences[3] = {more.x, more.y, more.z};
  V f[3][4];
  for (int k = 0; k < 3; ++k) {
    f[k][0] = sums[k] * V(2.0f * kPi);
    f[k][1] = differences[k] * V(kPi);
    f[k][2] = zero;
    f[k][3] = differences[k] * V(-0.25f * kPi);
  }
  out.Add(NormalizeOr(up, Vec3<V>{zero, one, zero}), f);
}

}  // namespace light_layer_detail

template <class V>
struct LightLayer {
  static constexpr std::string_view kName = "light_layer";
  using Params = LightLayerParams;
  struct Ports {
    In<&Streams::bounds> bounds;
    Out<&Streams::layer_light> light;
  };

  static void Run(const Params& params, const Ports& ports) {
    using namespace light_layer_detail;
    const Lighting& in = params.lighting;
    const BoundsBlock& box = *ports.bounds;
    const Vec3<V> low = Splat3<V>(box.low), high = Splat3<V>(box.high);
    const Vec3<V> centre = (low + high) * V(0.5f);
    Harmonics<V> harmonics;
    harmonics.Clear();
    if (in.sample_count > 0) AddSamples(in, centre, harmonics);
    for (uint32_t l = 0; l < in.light_count; ++l) AddLight(in.light[l], centre, harmonics);

    LayerLightBlock& out = *ports.light;
    for (int k = 0; k < 3; ++k) {
      for (uint32_t g = 0; g < Harmonics<V>::kGroups; ++g)
        harmonics.sum[k][g].Store(out.harmonics[k] + g * V::kLanes);
      out.ambient[k] = out.harmonics[k][0] * kY00;
      out.sun_direction[k] = in.sun_direction[k];
      out.sun_rgb[k] = in.sun_rgb[k];
      out.rim_direction[k] = in.rim_direction[k];
      out.rim_rgb[k] = in.rim_rgb[k];
    }
    out.rim_exponent = in.rim_exponent;
  }
};

}  // namespace pelt
