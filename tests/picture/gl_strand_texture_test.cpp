// An artist's strand texture: both renderers show it, of strands of any width, by what its channels are and by the
// weather.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>
#include <utility>

#include "core/random.hpp"
#include "tests/picture/gl_pictures.hpp"

namespace pelt::testing {
namespace {

using Rgba = std::array<uint8_t, 4>;
using SharedTexture = std::shared_ptr<const StrandTexture>;

// Four strips; paint(strip, x, y) is a texel of 16 x 32.
template <class Paint>
SharedTexture PaintTexture(StrandChannels channels, const Paint& paint) {
  StrandTexture made{.width = 64, .height = 32, .strips = 4, .channels = channels, .rgba = {}};
  for (uint32_t y = 0; y < made.height; ++y)
    for (uint32_t x = 0; x < made.width; ++x)
      for (const uint8_t byte : paint(x / 16, x % 16, y)) made.rgba.push_back(byte);
  return std::make_shared<const StrandTexture>(std::move(made));
}
SharedTexture OfOneColour(const Rgba& texel) {
  return PaintTexture(StrandChannels::kLook, [&](uint32_t, uint32_t, uint32_t) { return texel; });
}

// Every layer of strands with the texture; they are a fraction of kCardWidth wide.
Scenario WithTexture(Scenario scenario, const SharedTexture& texture) {
  for (Groom& groom : scenario.grooms) {
    for (GroomLayer& layer : groom.layers)
      if (layer.params.output != Output::kShells) layer.strand_texture = texture;
    for (StrandBlock& strands : groom.strands)
      for (uint32_t s = 0; s < kStrandsPerChunk; ++s)
        strands.film_strip[s] = uint8_t(MixBits(s) % 4);
  }
  return scenario;
}

std::vector<uint8_t> SoftwareOf(const SharedTexture& texture) {
  const Shown shown(WithTexture(TinyScenario(), texture), VertexOrder::kSorted);
  return SoftwareRenderer().Draw(shown.scene(), kSmall);
}

TEST(StrandTexture, EachChannelOfALookIsSeenAtAnyWidth) {
  const std::vector<uint8_t> plain = SoftwareOf(nullptr);
  EXPECT_EQ(SoftwareOf(OfOneColour({0, 0, 0, 255})), plain) << "0, 0, 0, 255 is no texture";
  const auto change = [&](const char* name, const Rgba& texel) {
    const std::vector<uint8_t> picture = SoftwareOf(OfOneColour(texel));
    double mean = 0.0;
    for (size_t i = 0; i < plain.size(); ++i)
      mean += (picture[i] - plain[i]) / double(plain.size());
    std::printf("%-10s %+.3f\n", name, mean);
    return mean;
  };
  const double tinted = change("extra tint", {255, 0, 0, 255});
  EXPECT_LT(tinted, -0.1);
  EXPECT_GT(change("highlights", {0, 255, 0, 255}), 0.01);
  EXPECT_LT(change("shadow", {0, 0, 255, 255}), tinted) << "black is darker";
  const SharedTexture none = OfOneColour({255, 255, 255, 0});
  EXPECT_EQ(SoftwareOf(none), SoftwareOf(OfOneColour({0, 0, 0, 0}))) << "what is not covered";
}

// Where it is covered, of a strip with its number of columns.
Rgba Columns(uint32_t strip, uint32_t x, uint32_t y) {
  const bool covered = x % 4 <= strip && x < 15 - y / 4;
  return {uint8_t(8 * y), uint8_t(60 * strip), uint8_t(16 * x), uint8_t(covered ? 255 : 0)};
}

struct GlStrandTexture : GlPicture {};

TEST_F(GlStrandTexture, IsThatOfTheSoftwareForEveryOutputInBothOrders) {
  const auto shown = [](const SharedTexture& texture, VertexOrder order) {
    return Shown(WithTexture(EveryOutputScenario(), texture), order);
  };
  const SharedTexture texture = PaintTexture(StrandChannels::kLook, Columns);
  const Shown sorted = shown(texture, VertexOrder::kSorted),
              indexed = shown(texture, VertexOrder::kIndexBuffer);
  ASSERT_EQ(CountStrips(sorted.scene().layers), 0u) << "none of Pelt's own";
  const PictureScene near = Nearer(sorted.scene(), 0.4f);
  const std::vector<uint8_t> software = SoftwareRenderer().Draw(near, kSmall);
  const std::vector<uint8_t> picture = renderer_->Draw(near, kSmall);
  EXPECT_EQ(picture, renderer_->Draw(Nearer(indexed.scene(), 0.4f), kSmall));
  const double same = PsnrDb(picture, software);
  std::printf("artist's strips of every output: %.1f dB between OpenGL and software\n", same);
  EXPECT_GE(same, kTwinDb);
  // Neither without the texture, nor with the next strip, nor without what is no coverage.
  const auto next = [](uint32_t s, uint32_t x, uint32_t y) { return Columns((s + 2) % 4, x, y); };
  const auto plain = [](uint32_t s, uint32_t x, uint32_t y) {
    return Rgba{0, 0, 0, Columns(s, x, y)[3]};
  };
  const std::pair<const char*, SharedTexture> faults[] = {
      {"no texture", nullptr},
      {"another strip", PaintTexture(StrandChannels::kLook, next)},
      {"coverage alone", PaintTexture(StrandChannels::kLook, plain)}};
  for (const auto& [name, fault] : faults) {
    const Shown other = shown(fault, VertexOrder::kSorted);
    const double away = PsnrDb(renderer_->Draw(Nearer(other.scene(), 0.4f), kSmall), software);
    std::printf("%s: %.1f dB\n", name, away);
    EXPECT_LT(away, same - 0.5) << name;
  }
}

// Layers beside each other keep their own textures, and the others Pelt's strips.
TEST_F(GlStrandTexture, IsTheLayersAlone) {
  Scenario scenario = EveryOutputScenario();
  for (Groom& groom : scenario.grooms) {
    for (StrandBlock& strands : groom.strands) std::ranges::fill(strands.width, 0.012f);
    for (size_t l = 0; l < groom.layers.size(); l += 3)
      if (groom.layers[l].params.output != Output::kShells)
        groom.layers[l].strand_texture = PaintTexture(StrandChannels::kLook, Columns);
  }
  const Shown shown(scenario, VertexOrder::kSorted);
  ASSERT_GT(CountStrips(shown.scene().layers), 0u);
  const double same = PsnrDb(renderer_->Draw(shown.scene(), kSmall),
                             SoftwareRenderer().Draw(shown.scene(), kSmall));
  std::printf("artist's strips beside Pelt's: %.1f dB between OpenGL and software\n", same);
  EXPECT_GE(same, kTwinDb);
}

// Painted layers in full weather from the first frame on.
Scenario InWeather(Scenario scenario, float wetness, float dirt) {
  for (Groom& groom : scenario.grooms)
    for (GroomLayer& layer : groom.layers) layer.params.lit = layer.params.painted = true;
  const auto weather =
      std::make_shared<std::vector<Weather>>(scenario.actors.size(), Weather{wetness, dirt});
  scenario.more = [weather](uint32_t, FurScene&, FrameInput& input) { input.weather = *weather; };
  return scenario;
}

// Dry, wet and dirty strands show what the three channels say, as if each were the alpha of a look.
TEST_F(GlStrandTexture, OfWeatherIsTheChannelOfTheStrandsWeather) {
  const auto channel = [](size_t c, uint32_t strip, uint32_t x, uint32_t y) {
    return c == 0 ? Columns(strip, x, y)[3] : uint8_t(x > 5 * c ? 255 : 20 * strip);
  };
  const SharedTexture of_weather =
      PaintTexture(StrandChannels::kWeather, [&](uint32_t s, uint32_t x, uint32_t y) {
        return Rgba{channel(0, s, x, y), channel(1, s, x, y), channel(2, s, x, y), 7};
      });
  const Weather weathers[] = {{0.0f, 0.0f}, {1.0f, 0.0f}, {0.0f, 1.0f}};
  for (size_t c = 0; c < 3; ++c) {
    const SharedTexture look =
        PaintTexture(StrandChannels::kLook, [&](uint32_t s, uint32_t x, uint32_t y) {
          return Rgba{0, 0, 0, channel(c, s, x, y)};
        });
    const auto draw = [&](const SharedTexture& texture, const auto& take) {
      const Scenario base = InWeather(TinyScenario(), weathers[c].wetness, weathers[c].dirt);
      return take(Shown(WithTexture(base, texture), VertexOrder::kSorted).scene());
    };
    const auto software = [](const PictureScene& scene) {
      return SoftwareRenderer().Draw(scene, kSmall);
    };
    const auto gl = [](const PictureScene& scene) { return renderer_->Draw(scene, kSmall); };
    const std::vector<uint8_t> picture = draw(of_weather, software);
    EXPECT_EQ(picture, draw(look, software)) << c;
    EXPECT_GE(PsnrDb(draw(of_weather, gl), draw(look, gl)), kSameDb) << c;
    EXPECT_GE(PsnrDb(draw(of_weather, gl), picture), kTwinDb) << c;
    EXPECT_NE(picture, draw(PaintTexture(StrandChannels::kLook, Columns), software)) << c;
  }
}

// Strands here are thinner than a texel of the sun's map: a threshold of 1 cuts them all, and leaves the skin.
TEST_F(GlStrandTexture, ShadowsAreCutBelowTheLayersAlpha) {
  const auto covered = [](float shadow_alpha) {
    Scenario scenario = TinyScenario();
    for (Groom& groom : scenario.grooms)
      for (GroomLayer& layer : groom.layers) layer.params.look.shadow_alpha = shadow_alpha;
    const Shown shown(scenario, VertexOrder::kSorted);
    double sum = 0.0;
    for (const glm::vec4& texel : renderer_->DrawShadowMap(shown.scene(), 0))
      sum += double(texel.a);
    return sum;
  };
  const double all = covered(0.0f), some = covered(0.2f), cut = covered(1.0f);
  std::printf("of the sun's map: %.0f, %.0f from 0.2 on, %.0f from 1 on\n", all, some, cut);
  EXPECT_LT(cut, some);
  EXPECT_LT(some, all);
  EXPECT_GT(all - cut, 0.01 * cut);
}

}  // namespace
}  // namespace pelt::testing
