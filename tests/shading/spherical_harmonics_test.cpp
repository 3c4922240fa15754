// bench/shading/shaders/spherical_harmonics.glsl against values that were worked out apart from it.
#include <gtest/gtest.h>

#include <array>
#include <glm/gtc/constants.hpp>

#include "bench/shading/shading.hpp"

namespace pelt {
namespace {

constexpr float kShNear = 1e-5f;
using Basis = std::array<float, 16>;

Basis BasisAt(const glm::vec3& d) {
  Basis y;
  ShBasis(d, y.data());
  return y;
}

// Directions all over the sphere, evenly (a spiral of golden angles).
template <class Visit>
void ForDirections(int count, Visit visit) {
  for (int i = 0; i < count; ++i) {
    const float z = 1.0f - (2.0f * float(i) + 1.0f) / float(count);
    const float angle = 2.39996323f * float(i), r = std::sqrt(1.0f - z * z);
    visit(glm::vec3(r * std::cos(angle), r * std::sin(angle), z));
  }
}

void ExpectBands(const glm::vec4& got, const glm::vec4& wanted) {
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(got[i], wanted[i], kShNear) << "band " << i;
}

TEST(SphericalHarmonics, HasItsValues) {
  const Basis up = BasisAt({0.0f, 0.0f, 1.0f});
  Basis wanted{};
  wanted[0] = 0.282095f, wanted[2] = 0.488603f, wanted[6] = 0.630783f, wanted[12] = 0.746353f;
  for (size_t i = 0; i < 16; ++i) EXPECT_NEAR(up[i], wanted[i], kShNear) << i;
  const Basis aslant = BasisAt(glm::vec3(2.0f, 3.0f, 6.0f) / 7.0f);
  const Basis wanted_aslant{0.282095f, 0.209401f, 0.418802f,  0.139601f, 0.133781f, 0.401344f,
                            0.379757f, 0.267563f, -0.055742f, 0.015482f, 0.303388f, 0.523671f,
                            0.215420f, 0.349114f, -0.126412f, -0.079131f};
  for (size_t i = 0; i < 16; ++i) EXPECT_NEAR(aslant[i], wanted_aslant[i], kShNear) << i;
}

TEST(SphericalHarmonics, SumsOfSquaresAreTheSameInAllDirections) {
  ForDirections(200, [](const glm::vec3& d) {
    const Basis y = BasisAt(d);
    glm::vec4 sum(0.0f);
    for (int i = 0; i < 16; ++i)
      sum[i < 1 ? 0 : i < 4 ? 1 : i < 9 ? 2 : 3] += y[size_t(i)] * y[size_t(i)];
    ExpectBands(sum, {0.079577f, 0.238732f, 0.397887f, 0.557042f});
  });
}

float Reflected(const std::array<glm::vec3, 16>& sh, const glm::vec3& d, const glm::vec4& bands) {
  return ShLight(sh.data(), d, bands).x;
}

TEST(SphericalHarmonics, ConstantLightOf1Gives1) {
  std::array<glm::vec3, 16> sh{};
  sh[0] = glm::vec3(std::sqrt(4.0f * glm::pi<float>()));
  ForDirections(50, [&](const glm::vec3& d) {
    EXPECT_NEAR(Reflected(sh, d, kShLambert), 1.0f, kShNear);
    EXPECT_NEAR(Reflected(sh, d, kShHair), 1.0f, kShNear);
  });
}

TEST(SphericalHarmonics, SunComesBackAsBandsAllow) {
  const glm::vec3 d = glm::vec3(2.0f, 3.0f, 6.0f) / 7.0f;
  const glm::vec3 side = glm::normalize(glm::cross(d, glm::vec3(0.0f, 1.0f, 0.0f)));
  std::array<glm::vec3, 16> sh{};
  ShAddZonal(d, ShDelta(), glm::vec3(1.0f), sh.data());
  constexpr std::array<std::array<float, 2>, 5> kValues{
      {{1.0f, 1.0625f}, {0.5f, 0.46094f}, {0.0f, 0.09375f}, {-0.5f, 0.0f}, {-1.0f, 0.0625f}}};
  for (const auto& [along, wanted] : kValues)  // at -0.5 the bands give -0.03906
    EXPECT_NEAR(Reflected(sh, d * along + side * std::sqrt(1.0f - along * along), kShLambert),
                wanted, kShNear)
        << along;
}

// By counting directions, as the definition has it: what a hair of this tangent makes of a sun.
TEST(SphericalHarmonics, HairLightIsTheLobesIntegral) {
  const glm::vec3 sun = glm::vec3(2.0f, 3.0f, 6.0f) / 7.0f;
  std::array<glm::vec3, 16> sh{};
  ShAddZonal(sun, ShHemisphere(), glm::vec3(1.0f), sh.data());
  for (const glm::vec3& tangent : {sun, glm::vec3(1.0f, 0.0f, 0.0f)}) {
    double sum = 0.0;
    int count = 0;
    ForDirections(20000, [&](const glm::vec3& d) {
      ++count;
      if (glm::dot(d, sun) <= 0.0f) return;
      const float along = glm::dot(d, tangent);
      sum += std::sqrt(1.0f - along * along);
    });
    const double pi = glm::pi<double>();
    EXPECT_NEAR(Reflected(sh, tangent, kShHair), sum * 4.0 * pi / count / (pi * pi), 1e-3);
  }
}

TEST(SphericalHarmonics, LightsHaveTheirZonalCoefficients) {
  EXPECT_NEAR(glm::degrees(std::asin(0.25f)), 14.4775f, 1e-4f);
  ExpectBands(ShDisc(std::asin(0.25f)), {0.056283f, 0.095937f, 0.119921f, 0.135097f});
  ExpectBands(ShHemisphere(), {1.772454f, 1.534990f, 0.0f, -0.586184f});
  std::array<glm::vec3, 16> sh{};  // irradiance, pi sin^2; the bands give nearly that
  const glm::vec3 d(0.0f, 0.0f, 1.0f);
  ShAddZonal(d, ShDisc(std::asin(0.25f)), glm::vec3(1.0f), sh.data());
  EXPECT_NEAR(Reflected(sh, d, kShLambert) * glm::pi<float>(), 0.196350f, 0.02f);
}

TEST(SphericalHarmonics, WindowsAndLobesHaveTheirFactors) {
  ExpectBands(ShWindow(4.0f), {1.0f, 0.853553f, 0.5f, 0.146447f});
  ExpectBands(ShWindow(6.0f), {1.0f, 0.933013f, 0.75f, 0.5f});
  ExpectBands(ShWrapped(0.5f), {4.712389f, 2.356194f, 0.294524f, -0.147262f});
  ExpectBands(ShGloss(28.0f), {0.216662f, 0.209440f, 0.195694f, 0.176715f});
  ExpectBands(ShWrapped(0.0f) / glm::pi<float>(), kShLambert);
}

}  // namespace
}  // namespace pelt
