// [lights] of a fur setup: every key lands, mistakes are reported at their line, and a frame takes it.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "core/groom/fur_setup.hpp"
#include "tests/error_from.hpp"

namespace pelt::test {
namespace {

FurSetup Read(const std::string& lights) {
  return ReadFurSetup("[[layer]]\nname = 'x'\n" + lights, "fur.toml", "");
}
std::string ReadError(const std::string& lights) {
  return ErrorFrom([&] { Read(lights); });
}

constexpr const char* kAll = R"([lights]
sun = { direction = [0, 3, 4], colour = [1.8, 1.6, 1.4] }
rim = { direction = [-2, 0, 0], colour = [-0.5, 0, 0.25], exponent = 2 }
light = [
  { position = [1, 2, 3], radius = 0.5, colour = [4, 5, 6], range = 7 },
  { position = [0, 0, 0] },
]
[[lights.sample]]
position = [3, 2, 1]
falloff = 8
sky = [0.5, 0.6, 0.7]
ground = [0.1, 0.2, 0.3]
up = [0, 0, 2]
)";

void ExpectVec(const float (&found)[3], const glm::vec3& wanted) {
  for (int k = 0; k < 3; ++k) EXPECT_FLOAT_EQ(found[k], wanted[k]) << k;
}

TEST(LightSetup, EveryKeyReachesTheFrame) {
  const FurSetup setup = Read(kAll);
  ASSERT_TRUE(setup.lights);
  const Lighting in = MakeLighting(*setup.lights);
  ASSERT_EQ(in.light_count, 2u);
  ExpectVec(in.light[0].position, {1, 2, 3});
  EXPECT_EQ(in.light[0].radius, 0.5f);
  ExpectVec(in.light[0].rgb, {4, 5, 6});
  EXPECT_EQ(in.light[0].range, 7.0f);
  ExpectVec(in.light[1].rgb, {1, 1, 1});
  ASSERT_EQ(in.sample_count, 1u);
  ExpectVec(in.sample[0].position, {3, 2, 1});
  EXPECT_EQ(in.sample[0].falloff, 8.0f);
  ExpectVec(in.sample[0].sky, {0.5f, 0.6f, 0.7f});
  ExpectVec(in.sample[0].ground, {0.1f, 0.2f, 0.3f});
  ExpectVec(in.sample[0].up, {0, 0, 1});
  ExpectVec(in.sun_direction, {0, 0.6f, 0.8f});
  ExpectVec(in.sun_rgb, {1.8f, 1.6f, 1.4f});
  ExpectVec(in.rim_direction, {-1, 0, 0});
  ExpectVec(in.rim_rgb, {-0.5f, 0, 0.25f});
  EXPECT_EQ(in.rim_exponent, 2.0f);
}

TEST(LightSetup, WhatIsNotSaidIsDark) {
  EXPECT_FALSE(Read("").lights);
  const Lighting in = MakeLighting(*Read("[lights]\n").lights);
  EXPECT_EQ(in.light_count + in.sample_count, 0u);
  ExpectVec(in.sun_rgb, glm::vec3(0.0f));
  ExpectVec(in.rim_rgb, glm::vec3(0.0f));
}

TEST(LightSetup, MistakesAreToldAtTheirLine) {
  const std::pair<const char*, const char*> cases[] = {
      {"[lights]\nligt = 3", "fur.toml:4: unknown key 'lights.ligt'; did you mean 'lights.light'?"},
      {"[lights]\nlight = 3", "fur.toml:4: key 'lights.light': expected a list"},
      {"[lights]\nlight = [{}]", "fur.toml:4: key 'lights.light[0].position': is needed here"},
      {"[lights]\n\nlight = [{ position = [0, 0, 0], radius = -1 }]",
       "fur.toml:5: key 'lights.light[0].radius': -1 is out of bounds; allowed are 0 to 1000 m"},
      {"[lights]\nlight = [{ position = [0, 0, 0], color = [1, 1, 1] }]",
       "fur.toml:4: unknown key 'lights.light[0].color'; did you mean 'lights.light[0].colour'?"},
      {"[lights.sun]\ncolour = [1, -1, 1]", "fur.toml:4: key 'lights.sun.colour': -1 is out of"},
      {"[lights.sun]\ncolour = [1, 1]", "fur.toml:4: key 'lights.sun.colour': has 2 entries"},
      {"[lights]\nsun = {}", "fur.toml:4: key 'lights.sun.colour': is needed here and missing"},
      {"[lights.sun]\ncolour = [1, 1, 1]\ndirection = [0, 0, 0]",
       "key 'lights.sun': direction is zero"},
      {"[lights.rim]\nexponent = nan", "fur.toml:4: key 'lights.rim.exponent': is not a finite"},
      {"[[lights.sample]]\nposition = [0, 0, 0]\nup = [0, 0, 0]",
       "key 'lights.sample[0]': up is zero"},
      {"[[lights.sample]]\nposition = [0, 0, 0]\nfalloff = 0",
       "fur.toml:5: key 'lights.sample[0].falloff': 0 is out of bounds"},
  };
  for (const auto& [text, wanted] : cases)
    EXPECT_NE(ReadError(text).find(wanted), std::string::npos) << text << "\n" << ReadError(text);
}

TEST(LightSetup, NoMoreThanASceneHolds) {
  std::string lights = "[lights]\nlight = [";
  for (uint32_t l = 0; l < kLightsPerScene; ++l) lights += "{ position = [0, 0, 0] }, ";
  EXPECT_EQ(ReadError(lights + "]"), "");
  EXPECT_NE(ReadError(lights + "{ position = [0, 0, 0] }]").find("has 9 entries; 0 to 8"),
            std::string::npos);
}

// With the layers around them or without, regardless of what those say.
TEST(LightSetup, IsReadWithoutTheLayers) {
  const std::string broken = "[[layer]]\nlenght = { map = 'missing.png' }\n";
  for (const std::string& text : {std::string(kAll), broken + kAll}) {
    const LightsSetup lights = ReadLights(text, "lights.toml");
    ASSERT_EQ(lights.lights.size(), 2u);
    EXPECT_EQ(lights.lights[0].position, glm::vec3(1, 2, 3));
    ASSERT_EQ(lights.samples.size(), 1u);
    EXPECT_EQ(lights.sun.colour, glm::vec3(1.8f, 1.6f, 1.4f));
  }
  const auto error_of = [](const std::string& text) {
    return ErrorFrom([&] { ReadLights(text, "lights.toml"); });
  };
  EXPECT_EQ(error_of(broken), "lights.toml:1: there is no [lights] in it");
  EXPECT_EQ(error_of(""), "lights.toml:1: there is no [lights] in it");
  EXPECT_EQ(error_of("\n[lihgts.sun]\ncolour = [1, 1, 1]\n"),
            "lights.toml:2: unknown key 'lihgts'; did you mean 'lights'?");
  EXPECT_NE(error_of("[lights.sun]\ncolour = [1, 1]\n").find("lights.toml:2: key 'lights.sun.col"),
            std::string::npos);
  EXPECT_NE(error_of("[lights\n").find("lights.toml:1: not valid TOML"), std::string::npos);
}

}  // namespace
}  // namespace pelt::test
