// light_layer against published values, and against a quadrature over all directions in double.
#include "core/kernels/light_layer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <functional>
#include <numbers>

#include "tests/kernels/run_kernel.hpp"

namespace pelt::test {
namespace {

constexpr double kPi = std::numbers::pi;
using Direction = std::array<double, 3>;

// By Legendre's recurrences: shares nothing with the kernel's table.
double HarmonicAt(int l, int m, const Direction& d) {
  const int n = std::abs(m);
  double below = 0.0, p = 1.0, ratio = 1.0;
  for (int k = 1; k <= n; ++k) p *= 2 * k - 1;
  for (int k = n + 1; k <= l; ++k) {
    const double next = ((2 * k - 1) * d[2] * p - (k + n - 1) * below) / (k - n);
    below = p;
    p = next;
  }
  for (int k = l - n + 1; k <= l + n; ++k) ratio /= k;
  const auto turn = std::pow(std::complex<double>(d[0], d[1]), n);
  const double round = n == 0 ? 1.0 : std::numbers::sqrt2 * (m > 0 ? turn.real() : turn.imag());
  return std::sqrt((2 * l + 1) / (4.0 * kPi) * ratio) * p * round;
}

std::array<double, 16> HarmonicsAt(const Direction& d) {
  std::array<double, 16> out{};
  for (int l = 0, i = 0; l < 4; ++l)
    for (int m = -l; m <= l; ++m) out[size_t(i++)] = HarmonicAt(l, m, d);
  return out;
}

std::array<float, 16> Basis(float x, float y, float z) {
  using V = ArrayVec<4>;
  std::array<float, 16> out;
  for (uint32_t lane = 0; lane < 16; lane += V::kLanes)
    light_layer_detail::BasisAt<V>({V(x), V(y), V(z)}, lane).Store(out.data() + lane);
  return out;
}

// Of a radiance, by 65,536 directions on a spiral.
std::array<double, 16> Project(const std::function<double(const Direction&)>& radiance) {
  constexpr int kCount = 65536;
  std::array<double, 16> sum{};
  for (int i = 0; i < kCount; ++i) {
    const double z = 1.0 - (2 * i + 1.0) / kCount, across = std::sqrt(1.0 - z * z);
    const double turn = kPi * (3.0 - std::sqrt(5.0)) * i;
    const Direction d = {across * std::cos(turn), across * std::sin(turn), z};
    const double value = radiance(d);
    if (value == 0.0) continue;
    const auto at = HarmonicsAt(d);
    for (size_t c = 0; c < 16; ++c) sum[c] += value * at[c] * 4.0 * kPi / kCount;
  }
  return sum;
}

template <class V>
LayerLightBlock LightOf(const LightLayerParams& params, const BoundsBlock& bounds) {
  return OutputOf<LightLayer<V>, LayerLightBlock>(&params, bounds);
}

// Around the origin.
LayerLightBlock Light(const Lighting& lighting, const float (&centre)[3] = {0.0f, 0.0f, 0.0f}) {
  BoundsBlock bounds;
  Poison(bounds);
  for (int k = 0; k < 3; ++k) {
    bounds.low[k] = centre[k] - 0.5f;
    bounds.high[k] = centre[k] + 0.5f;
  }
  return LightOf<ArrayVec<4>>({lighting}, bounds);
}

Lighting OneLight(const SphereLight& light) {
  Lighting in;
  in.light_count = 1;
  in.light[0] = light;
  return in;
}

Lighting OneSample(const IrradianceSample& sample) {
  Lighting in;
  in.sample_count = 1;
  in.sample[0] = sample;
  return in;
}

Lighting Full(uint32_t seed) {
  std::mt19937 random(seed);
  const auto fill = [&](auto& v, float low, float high) {
    for (float& number : v) number = Uniform(random, low, high);
  };
  Lighting in;
  in.light_count = kLightsPerScene;
  in.sample_count = kIrradianceSamplesPerScene;
  for (SphereLight& light : in.light) {
    fill(light.position, -2.0f, 2.0f);
    fill(light.rgb, 0.0f, 3.0f);
    light.radius = Uniform(random, 0.0f, 1.0f);
    light.range = Uniform(random, 2.0f, 9.0f);
  }
  for (IrradianceSample& sample : in.sample) {
    fill(sample.position, -3.0f, 3.0f);
    fill(sample.sky, 0.0f, 1.0f);
    fill(sample.ground, 0.0f, 1.0f);
    sample.falloff = Uniform(random, 2.0f, 6.0f);
  }
  return in;
}

// ---- The basis ----------------------------------------------------------------------------------

TEST(LightLayer, TheBasisHasItsPublishedValues) {
  const float along_z[] = {0.282095f, 0, 0.488603f, 0, 0, 0, 0.630783f, 0, 0, 0, 0, 0, 0.746353f};
  const float slanted[] = {0.282095f, 0.209401f, 0.418802f,  0.139601f, 0.133781f, 0.401344f,
                           0.379757f, 0.267563f, -.055742f,  0.015482f, 0.303388f, 0.523671f,
                           0.215420f, 0.349114f, -0.126412f, -0.079131f};
  const auto z = Basis(0, 0, 1), s = Basis(2.0f / 7, 3.0f / 7, 6.0f / 7);
  for (size_t i = 0; i < 16; ++i) {
    EXPECT_NEAR(z[i], i < std::size(along_z) ? along_z[i] : 0.0f, 1e-5f) << i;
    EXPECT_NEAR(s[i], slanted[i], 1e-5f) << i;
  }
}

// The squares of a degree's functions sum to the same in every direction.
TEST(LightLayer, TheBasisKeepsTheAdditionTheorem) {
  std::mt19937 random(5);
  for (int trial = 0; trial < 1000; ++trial) {
    Direction d;
    for (double& c : d) c = double(Uniform(random, -1.0f, 1.0f));
    const double length = std::hypot(d[0], d[1], d[2]);
    for (double& c : d) c /= length;
    const auto at = Basis(float(d[0]), float(d[1]), float(d[2]));
    const auto expected = HarmonicsAt(d);
    for (size_t i = 0; i < 16; ++i) ASSERT_NEAR(double(at[i]), expected[i], 1e-6);
    for (int l = 0, i = 0; l < 4; ++l) {
      double squares = 0.0;
      for (int m = -l; m <= l; ++m, ++i) squares += double(at[size_t(i)]) * double(at[size_t(i)]);
      ASSERT_NEAR(squares, (2 * l + 1) / (4.0 * kPi), 1e-6);
    }
  }
}

// ---- Lights -------------------------------------------------------------------------------------

// What a surface receives from a light of irradiance 1, by the angle from it.
TEST(LightLayer, APointLightGivesItsIrradiance) {
  const auto block = Light(OneLight({{0, 0, 2}, 0, {4, 8, 0}, 0}));
  const double factor[] = {kPi, 2.0 * kPi / 3.0, kPi / 4.0, 0.0};
  const std::pair<double, double> published[] = {
      {1.0, 1.0625}, {0.5, 0.46094}, {0.0, 0.09375}, {-0.5, -0.03906}, {-1.0, 0.0625}};
  for (const auto& [cosine, expected] : published) {
    const auto at = HarmonicsAt({std::sqrt(1.0 - cosine * cosine), 0.0, cosine});
    double sum[3] = {};
    for (int l = 0, i = 0; l < 4; ++l)
      for (int m = -l; m <= l; ++m, ++i)
        for (int k = 0; k < 3; ++k)
          sum[k] += factor[l] * at[size_t(i)] * double(block.harmonics[k][i]);
    EXPECT_NEAR(sum[0], expected, 1e-5) << cosine;
    EXPECT_NEAR(sum[1], 2.0 * expected, 2e-5) << cosine;
    EXPECT_EQ(sum[2], 0.0);
  }
}

// Radiance 1 needs the irradiance pi R^2 at 1 m.
SphereLight BallOfRadianceOne(float radius, const std::array<float, 3>& at) {
  const float rgb = float(kPi) * radius * radius;
  return {{at[0], at[1], at[2]}, radius, {rgb, rgb, rgb}, 0};
}

TEST(LightLayer, ABallHasItsPublishedValues) {
  const auto block = Light(OneLight(BallOfRadianceOne(0.5f, {0, 0, 2})));
  const float zonal[] = {0.056283f, 0.095937f, 0.119921f, 0.135097f};
  for (int l = 0; l < 4; ++l) EXPECT_NEAR(block.harmonics[0][l * l + l], zonal[l], 1e-5f) << l;
  EXPECT_NEAR(block.harmonics[0][3], 0.0f, 1e-6f);
}

TEST(LightLayer, ABallIsWhatAQuadratureFinds) {
  for (const float radius : {0.5f, 1.0f, 2.0f, 2.9f}) {
    const std::array<float, 3> at = {1.0f, -2.0f, 2.0f};  // 3 m
    const auto block = Light(OneLight(BallOfRadianceOne(radius, at)));
    const double cosine = std::sqrt(1.0 - double(radius * radius) / 9.0);
    const auto expected = Project([&](const Direction& d) {
      const double along = (d[0] - 2.0 * d[1] + 2.0 * d[2]) / 3.0;
      return along > cosine ? 1.0 : 0.0;
    });
    for (size_t i = 0; i < 16; ++i)
      EXPECT_NEAR(double(block.harmonics[2][i]), expected[i], 1e-3) << radius << " " << i;
  }
}

// A ball of any size, seen from its surface or from within, fills half of all directions.
TEST(LightLayer, WithinABallItsLightGrowsNoMore) {
  const auto half = Project([](const Direction& d) { return d[2] > 0.0 ? 1.0 : 0.0; });
  for (const float distance : {2.0f, 1.0f, 0.25f}) {
    const auto block = Light(OneLight(BallOfRadianceOne(2.0f, {0, 0, distance})));
    for (size_t i = 0; i < 16; ++i)
      EXPECT_NEAR(double(block.harmonics[0][i]), half[i], 1e-3) << distance;
  }
  const auto inside = Light(OneLight({{0, 0, 0}, 0, {1, 1, 1}, 0}));
  for (const float c : inside.harmonics[0]) EXPECT_TRUE(std::isfinite(c));
}

TEST(LightLayer, ALightEndsAtItsRange) {
  const auto mean = [](float range) {
    return Light(OneLight({{0, 2, 0}, 0, {1, 1, 1}, range})).ambient[0];
  };
  const float endless = mean(0.0f);
  EXPECT_NEAR(endless, 0.25 / (4.0 * kPi), 1e-7);
  EXPECT_NEAR(mean(4.0f), 0.5625f * endless, 1e-7f);
  EXPECT_EQ(mean(2.0f), 0.0f);
  EXPECT_EQ(mean(1.0f), 0.0f);
}

// ---- Samples ------------------------------------------------------------------------------------

TEST(LightLayer, AHalfSphereHasItsPublishedValues) {
  const auto block = Light(OneSample({{}, 1.0f, {1, 0, 2}, {0, 1, 2}, {0, 0, 1}}));
  const float zonal[] = {1.772454f, 1.534990f, 0.0f, -0.586184f};
  for (int l = 0; l < 4; ++l) {
    const int i = l * l + l;
    EXPECT_NEAR(block.harmonics[0][i], zonal[l], 1e-5f);
    EXPECT_NEAR(block.harmonics[1][i], l == 0 ? zonal[l] : -zonal[l], 1e-5f);
    EXPECT_NEAR(block.harmonics[2][i], l == 0 ? 4.0f * zonal[l] : 0.0f, 1e-5f);
  }
  EXPECT_NEAR(block.ambient[0], 0.5f, 1e-6f);
  EXPECT_NEAR(block.ambient[2], 2.0f, 1e-6f);
}

TEST(LightLayer, SamplesWeighByTheirFalloff) {
  Lighting in;
  in.sample_count = 2;
  in.sample[0] = {{1, 0, 0}, 4.0f, {1, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  in.sample[1] = {{0, 0, -3}, 4.0f, {0, 1, 0}, {0, 1, 0}, {0, 1, 0}};
  const auto block = Light(in);
  EXPECT_NEAR(block.ambient[0], 0.9f, 1e-5f);
  EXPECT_NEAR(block.ambient[1], 0.1f, 1e-5f);
}

TEST(LightLayer, OutOfReachTheNearestSampleCounts) {
  Lighting in;
  in.sample_count = 2;
  in.sample[0] = {{9, 0, 0}, 4.0f, {1, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  in.sample[1] = {{0, 0, -5}, 4.0f, {0, 1, 0}, {0, 1, 0}, {0, 1, 0}};
  EXPECT_NEAR(Light(in).ambient[0], 0.0f, 1e-6f);
  EXPECT_NEAR(Light(in).ambient[1], 1.0f, 1e-6f);
  // It goes out of reach without a jump.
  const float inside = Light(in, {0.0f, 0.0f, -1.001f}).ambient[1];
  const float outside = Light(in, {0.0f, 0.0f, -0.999f}).ambient[1];
  EXPECT_NEAR(inside, outside, 1e-5f);
}

// ---- All of it ----------------------------------------------------------------------------------

TEST(LightLayer, OrderDoesNotMatter) {
  const Lighting in = Full(1);
  Lighting other = in;
  std::reverse(std::begin(other.light), std::end(other.light));
  std::reverse(std::begin(other.sample), std::end(other.sample));
  const auto a = Light(in), b = Light(other);
  for (int k = 0; k < 3; ++k)
    for (uint32_t i = 0; i < kHarmonics; ++i)
      EXPECT_NEAR(a.harmonics[k][i], b.harmonics[k][i], 1e-5f) << k << " " << i;
}

// Nothing divides by how many there are.
TEST(LightLayer, WhatIsDarkOrFarIsAsIfItWereNotThere) {
  Lighting in = Full(2);
  in.light_count = in.sample_count = 5;
  const auto without = Light(in);
  in.light[5] = {{1, 1, 1}, 0.1f, {0, 0, 0}, 0.0f};
  in.light[6] = {{50, 0, 0}, 0.1f, {9, 9, 9}, 20.0f};
  in.sample[5] = {{50, 0, 0}, 20.0f, {9, 9, 9}, {9, 9, 9}, {1, 0, 0}};
  in.light_count = 7;
  in.sample_count = 6;
  const auto with = Light(in);
  EXPECT_EQ(std::memcmp(&with, &without, sizeof with), 0);
}

TEST(LightLayer, SunAndRimAreHandedOn) {
  Lighting in;
  in.sun_direction[0] = 0.6f, in.sun_direction[1] = 0.8f;
  in.sun_rgb[1] = 3.0f;
  in.rim_direction[2] = 1.0f, in.rim_direction[1] = 0.0f;
  in.rim_rgb[2] = -0.5f;
  in.rim_exponent = 4.0f;
  const auto block = Light(in);
  EXPECT_EQ(std::memcmp(block.sun_direction, in.sun_direction, 12), 0);
  EXPECT_EQ(std::memcmp(block.sun_rgb, in.sun_rgb, 12), 0);
  EXPECT_EQ(std::memcmp(block.rim_direction, in.rim_direction, 12), 0);
  EXPECT_EQ(std::memcmp(block.rim_rgb, in.rim_rgb, 12), 0);
  EXPECT_EQ(block.rim_exponent, 4.0f);
  for (const auto& colour : block.harmonics)
    for (const float c : colour) EXPECT_EQ(c, 0.0f);
}

TEST(LightLayer, SameBlockOnEveryVector) {
  for (uint32_t seed = 0; seed < 20; ++seed) {
    const LightLayerParams params{Full(seed)};
    BoundsBlock bounds{};
    bounds.high[1] = 0.1f * float(seed);
    ExpectOnEveryVector(
        LightOf<ArrayVec<4>>(params, bounds), [&]<class V> { return LightOf<V>(params, bounds); },
        seed);
  }
}

}  // namespace
}  // namespace pelt::test
