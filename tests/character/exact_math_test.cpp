// exact:: against libm with a stated tolerance, and its bits against a digest taken once: the bits
// are the promise.
#include "core/exact_math.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <set>

#include "core/random.hpp"

namespace pelt {
namespace {

constexpr double kRelative = 1e-14;

void ExpectClose(double got, double want, double scale, double x) {
  EXPECT_LE(std::abs(got - want), kRelative * scale) << "x = " << x << " got " << got;
}

TEST(ExactMath, AgreesWithLibm) {
  Random random(1);
  for (int i = 0; i < 200000; ++i) {
    const double wide = random.Uniform(-1e6, 1e6);
    const double near = random.Uniform(-10.0, 10.0);
    for (double x : {wide, near, near * 1e-8}) {
      ExpectClose(exact::Sin(x), std::sin(x), 1.0, x);
      ExpectClose(exact::Cos(x), std::cos(x), 1.0, x);
      ExpectClose(exact::Atan(x), std::atan(x), std::abs(std::atan(x)), x);
    }
    ExpectClose(exact::Tan(near), std::tan(near), 1.0 + std::tan(near) * std::tan(near), near);
    const double e = random.Uniform(-700.0, 700.0);
    ExpectClose(exact::Exp(e), std::exp(e), std::exp(e), e);
    const double positive = std::exp(e);
    ExpectClose(exact::Log(positive), std::log(positive), std::abs(std::log(positive)), positive);
    const double unit = random.Uniform(-1.0, 1.0);
    ExpectClose(exact::Acos(unit), std::acos(unit), std::acos(unit), unit);
    ExpectClose(exact::Asin(unit), std::asin(unit), std::abs(std::asin(unit)), unit);
    const double y = random.Uniform(-5.0, 5.0), x = random.Uniform(-5.0, 5.0);
    ExpectClose(exact::Atan2(y, x), std::atan2(y, x), std::abs(std::atan2(y, x)), x);
    const double base = random.Uniform(0.0, 10.0);
    ExpectClose(exact::Pow(base, y), std::pow(base, y),
                std::pow(base, y) * (1.0 + std::abs(y * std::log(base))), base);
  }
}

TEST(ExactMath, Edges) {
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(exact::Sin(0.0), 0.0);
  EXPECT_EQ(exact::Cos(0.0), 1.0);
  EXPECT_TRUE(std::isnan(exact::Sin(infinity)));
  EXPECT_TRUE(std::isnan(exact::Cos(NAN)));
  EXPECT_EQ(exact::Exp(0.0), 1.0);
  EXPECT_EQ(exact::Exp(800.0), infinity);
  EXPECT_EQ(exact::Exp(-800.0), 0.0);
  ExpectClose(exact::Exp(-740.0), std::exp(-740.0), 1e-300, -740.0);
  EXPECT_EQ(exact::Log(1.0), 0.0);
  EXPECT_EQ(exact::Log(0.0), -infinity);
  EXPECT_TRUE(std::isnan(exact::Log(-1.0)));
  ExpectClose(exact::Log(5e-320), std::log(5e-320), 700.0, 5e-320);
  EXPECT_EQ(exact::Acos(1.0), 0.0);
  EXPECT_EQ(exact::Acos(2.0), 0.0);
  EXPECT_EQ(exact::Acos(-1.5), exact::kPi);
  EXPECT_EQ(exact::Atan2(0.0, 0.0), 0.0);
  EXPECT_EQ(exact::Atan2(0.0, -1.0), exact::kPi);
  EXPECT_EQ(exact::Atan(infinity), exact::kPi / 2);
  EXPECT_EQ(exact::Floor(-0.5), -1.0);
  EXPECT_EQ(exact::Floor(2.0), 2.0);
  EXPECT_EQ(exact::Floor(1e300), 1e300);
  EXPECT_EQ(exact::Pow(0.0, 2.0), 0.0);
  EXPECT_EQ(exact::Pow(0.0, 0.0), 1.0);
}

// Any compiler, optimisation level and machine must reach the same digest.
TEST(ExactMath, BitsAreFixed) {
  Random random(7);
  uint64_t digest = 0;
  auto add = [&digest](double v) { digest = MixSeed(digest, std::bit_cast<uint64_t>(v)); };
  for (int i = 0; i < 10000; ++i) {
    const double x = random.Uniform(-100.0, 100.0);
    add(exact::Sin(x));
    add(exact::Cos(x));
    add(exact::Tan(x));
    add(exact::Exp(x));
    add(exact::Log(x * x + 0.01));
    add(exact::Atan2(x, 3.0));
    add(exact::Acos(x * 0.01));
    add(exact::Pow(x * x + 0.01, 0.37));
  }
  EXPECT_EQ(digest, 10598435094958948624ull);
}

TEST(Random, IsUniformAndFixed) {
  // Reference values of SplitMix64 from seed 0, as published with the generator.
  Random random(0);
  EXPECT_EQ(random.U64(), 0xe220a8397b1dcdafull);
  EXPECT_EQ(random.U64(), 0x6e789e6aa1b965f4ull);
  EXPECT_EQ(random.U64(), 0x06c45d188009454full);
  double sum = 0.0, sum_of_squares = 0.0;
  uint32_t bins[10] = {};
  for (int i = 0; i < 100000; ++i) {
    const double u = random.Uniform();
    ASSERT_GE(u, 0.0);
    ASSERT_LT(u, 1.0);
    sum += u;
    sum_of_squares += u * u;
    const uint32_t bin = random.Below(10);
    ASSERT_LT(bin, 10u);
    ++bins[bin];
  }
  EXPECT_NEAR(sum / 100000, 0.5, 0.005);
  EXPECT_NEAR(sum_of_squares / 100000, 1.0 / 3, 0.005);
  for (uint32_t count : bins) EXPECT_NEAR(count, 10000, 500);
}

TEST(Random, MixedSeedsDiffer) {
  std::set<uint64_t> seen;
  for (uint64_t seed = 0; seed < 100; ++seed)
    for (uint64_t purpose = 0; purpose < 100; ++purpose) seen.insert(MixSeed(seed, purpose));
  EXPECT_EQ(seen.size(), 10000u);
}

}  // namespace
}  // namespace pelt
