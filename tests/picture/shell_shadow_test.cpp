// What shells keep of the sun: as much as the hairs that they stand for, each once.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "bench/picture/shadows.hpp"
#include "bench/shading/shading.hpp"
#include "core/random.hpp"
#include "tests/jobs/tiny_scene.hpp"

namespace pelt::testing {
namespace {

FurTexture SomeFur() {
  FurTexture fur{32, std::vector<uint8_t>(32 * 32)};
  for (uint32_t i = 0; i < fur.texels.size(); ++i)
    fur.texels[i] = MixBits(i) % 3 ? uint8_t(MixBits(i) >> 8) : uint8_t(0);
  return fur;
}

std::vector<Shell> SomeShells(uint32_t count) {
  std::vector<Shell> shells;
  for (uint32_t i = 0; i < count; ++i)
    shells.push_back({float(i + 1) / float(count), 1.0f, float(i) / float(count), 1.0f});
  return shells;
}

TEST(ShellShadow, EachHairCountsOnce) {
  const FurTexture fur = SomeFur();
  for (const uint32_t count : {1u, 5u, 12u, 40u}) {
    const std::vector<Shell> shells = SomeShells(count);
    const std::vector<ShadowShell> found = FindShadowShells(shells, fur);
    ASSERT_EQ(found.size(), std::min<size_t>(count, kShadowShells));
    EXPECT_EQ(found.back().height, 1.0f) << "the topmost";
    const auto lowest = std::ranges::find(shells, found.front().height, &Shell::height);
    ASSERT_NE(lowest, shells.end());
    for (const uint32_t stencil : {0u, 40u, 128u, 255u}) {
      float sum = 0.0f;
      for (const ShadowShell& shell : found) {
        EXPECT_GE(shell.covers[stencil], 0.0f);
        sum += shell.covers[stencil];
      }
      double drawn = 0.0;
      for (const uint8_t texel : fur.texels)
        drawn += double(
            ShellCoverage(float(texel) / 255.0f, float(stencil) / 255.0f, lowest->threshold));
      EXPECT_NEAR(sum, drawn / double(fur.texels.size()), 1e-4) << count << ' ' << stencil;
      EXPECT_EQ(sum == 0.0f, stencil == 0) << count;
    }
  }
}

TEST(ShellShadow, WhatIsAboutToGoCastsLess) {
  std::vector<Shell> shells = SomeShells(4);
  const float whole = FindShadowShells(shells, SomeFur()).back().covers[255];
  shells.back().fade = 0.25f;
  EXPECT_NEAR(FindShadowShells(shells, SomeFur()).back().covers[255], 0.25f * whole, 1e-6f);
}

// A triangle that covers a part lets the rest through, and one that covers nothing is not there.
TEST(ShellShadow, APartIsAPartOfTheMap) {
  const auto draw = [](const glm::vec3& covered) {
    ShadowMap map({0, 1, 0}, glm::vec3(0.0f), 1.0f, 64);
    map.AddTriangle({-1, 0, -1}, {1, 0, -1}, {-1, 0, 1}, covered);
    return std::vector(map.texels().begin(), map.texels().end());
  };
  const ShadowMap::Texel none;
  for (const ShadowMap::Texel& texel : draw(glm::vec3(0.0f))) ASSERT_EQ(texel, none);
  uint32_t covered = 0;
  for (const ShadowMap::Texel& texel : draw(glm::vec3(0.25f)))
    if (!(texel == none)) {
      ASSERT_EQ(texel.coverage, 64u);
      ++covered;
    }
  EXPECT_GT(covered, 1500u);
  uint32_t least = 255, most = 0;
  for (const ShadowMap::Texel& texel : draw({0.0f, 0.5f, 1.0f}))
    if (!(texel == none)) {
      least = std::min(least, texel.coverage);
      most = std::max(most, texel.coverage);
    }
  EXPECT_LT(least, 20u);
  EXPECT_GT(most, 235u);
}

}  // namespace
}  // namespace pelt::testing
