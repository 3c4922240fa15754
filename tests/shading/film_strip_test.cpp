// Film strips: silhouettes keep their coverage from the function to the smallest level of the texture, and strands show
// the ones that they were baked with.
#include <gtest/gtest.h>

#include <array>

#include "bench/picture/hairs.hpp"
#include "bench/picture/picture.hpp"
#include "bench/picture/strip_texture.hpp"
#include "bench/shading/shading.hpp"
#include "core/random.hpp"
#include "tests/jobs/tiny_scene.hpp"
#include "tests/run_frame.hpp"

namespace pelt::testing {
namespace {

constexpr uint32_t kStrips = 24;

TEST(FilmStrip, HasOneToEightHairs) {
  for (uint32_t strip = 0; strip < kStrips; ++strip) {
    uint32_t hairs = 0;
    bool covered = false;
    for (int i = 0; i < 4000; ++i) {
      const bool now =
          StripCoverage(strip, (float(i) + 0.5f) / 4000.0f, 0.02f, 1.0f / 4000.0f) > 0.5f;
      hairs += now && !covered;
      covered = now;
    }
    EXPECT_EQ(hairs, StripHairs(strip)) << strip;
    EXPECT_EQ(hairs, strip % 8 + 1) << strip;
  }
}

TEST(FilmStrip, StaysOnItsCardAndEndsAtItsTip) {
  for (uint32_t strip = 0; strip < kStrips; ++strip) {
    EXPECT_EQ(StripCoverage(strip, 0.5f, 1.0f, 1.0f), 0.0f) << strip;
    EXPECT_GT(StripCoverage(strip, 0.5f, 0.95f, 1.0f), 0.0f) << "one reaches the end";
    for (int i = 0; i <= 100; ++i)
      for (uint32_t hair = 0; hair < StripHairs(strip); ++hair) {
        const float along = float(i) / 100.0f, half = 0.5f * StripWidth(strip, hair, along);
        ASSERT_GE(StripCentre(strip, hair, along) - half, 0.0f) << strip << ' ' << along;
        ASSERT_LE(StripCentre(strip, hair, along) + half, 1.0f) << strip << ' ' << along;
      }
  }
}

// Of rows of places, the mean.
double MeanCoverage(uint32_t strip, int across, int along) {
  double sum = 0.0;
  for (int y = 0; y < along; ++y)
    for (int x = 0; x < across; ++x)
      sum += double(StripCoverage(strip, (float(x) + 0.5f) / float(across),
                                  (float(y) + 0.5f) / float(along), 1.0f / float(across)));
  return sum / (double(across) * along);
}

TEST(FilmStrip, CoversAsMuchHoweverCoarselyItIsLookedAt) {
  for (uint32_t strip = 0; strip < kStrips; ++strip) {
    const double share = double(StripShare(strip));
    EXPECT_NEAR(MeanCoverage(strip, 1, 2000), share, 1e-3) << strip;
    EXPECT_NEAR(MeanCoverage(strip, 16, 1000), share, 0.01) << strip;
    EXPECT_NEAR(MeanCoverage(strip, 256, 500), share, 0.01)
        << strip << ": hairs hide each other little";
  }
}

TEST(FilmStrip, TextureKeepsEachStripsCoverageInEveryLevel) {
  const StripTexture texture(kStrips);
  ASSERT_EQ(texture.levels(), 7u);
  for (uint32_t level = 0; level < texture.levels(); ++level) {
    const uint32_t width = StripTexture::kWidth >> level, height = StripTexture::kHeight >> level;
    ASSERT_EQ(texture.texels(level).size(), size_t(kStrips) * width * height);
    for (uint32_t strip = 0; strip < kStrips; ++strip) {
      double sum = 0.0;
      for (uint32_t y = 0; y < height; ++y)
        for (uint32_t x = 0; x < width; ++x)
          sum += texture.texels(level)[(size_t(y) * kStrips + strip) * width + x];
      EXPECT_NEAR(sum / (255.0 * width * height), MeanCoverage(strip, 64, 512), 0.5 / 255.0)
          << "level " << level << ", strip " << strip;
    }
  }
}

// An artist's strips of 6 x 5 texels: strip s is covered in 2 s + 1 columns, and red there.
TEST(FilmStrip, AnArtistsTextureKeepsEachStripInEveryLevel) {
  StrandTexture artists{.width = 18, .height = 5, .strips = 3, .rgba = {}};
  for (uint32_t i = 0; i < 18 * 5; ++i) {
    const uint8_t byte = i % 6 < 2 * (i % 18 / 6) + 1 ? 255 : 0;
    artists.rgba.insert(artists.rgba.end(), {byte, 0, byte, byte});
  }
  const StripTexture look(artists);
  artists.channels = StrandChannels::kWeather;
  const StripTexture weather(artists);
  ASSERT_EQ(look.levels(), 4u) << "8 x 8 and down to 1 x 1";
  for (uint32_t strip = 0; strip < 3; ++strip) {
    const float share = float(2 * strip + 1) / 6.0f;
    for (uint32_t level = 0; level < 4; ++level) {
      const float footprint = 1.0f / float(look.width(level));
      glm::vec4 sum(0.0f);
      for (float at = 0.5f * footprint; at < 1.0f; at += footprint)
        sum += look.Texel(strip, at, 0.5f, footprint) * footprint;
      EXPECT_NEAR(sum.w, share, 0.03f) << strip << ' ' << level;
    }
    EXPECT_GT(look.Texel(strip, 0.5f, 0.5f, 1.0f).x, 0.75f) << "of what is covered";
    const glm::vec2 dry(0.0f), wet(1.0f, 0.0f), dirty(1.0f, 1.0f);
    EXPECT_NEAR(look.CoverAt(strip, 0.5f, dirty), share, 0.03f);
    EXPECT_NEAR(weather.CoverAt(strip, 0.5f, dry), share, 0.03f);
    EXPECT_EQ(weather.CoverAt(strip, 0.5f, wet), 0.0f);
    EXPECT_NEAR(weather.CoverAt(strip, 0.5f, dirty), share, 0.03f);
  }
  EXPECT_EQ(look.CoverAt(7, 0.5f, {}), look.CoverAt(2, 0.5f, {})) << "nothing beyond the last";
}

TEST(FilmStrip, TextureIsSampledAsTheFunctionIs) {
  const StripTexture texture(kStrips);
  for (uint32_t strip = 0; strip < kStrips; ++strip)
    for (const float footprint : {1.0f / 64.0f, 0.25f, 1.0f}) {
      double error = 0.0, sampled = 0.0, exact = 0.0;
      for (uint32_t i = 0; i < 4000; ++i) {
        // Within the card by half a footprint, as beyond it there is none.
        const float across = 0.5f * footprint + (1.0f - footprint) * HashShare(2 * i);
        const float along = HashShare(2 * i + 1);
        const float got = texture.Sample(strip, across, along, footprint);
        const float wanted = StripCoverage(strip, across, along, footprint);
        error += std::abs(double(got - wanted));
        sampled += double(got);
        exact += double(wanted);
      }
      EXPECT_NEAR(sampled / exact, 1.0, 0.08) << strip << ' ' << footprint;
      if (footprint < 0.02f) {
        EXPECT_LT(error / 4000.0, 0.08) << strip << ": texels are mixed, edges softer";
      }
    }
}

// `tiny` with a strand of this width for each strand, of film strips that `strip_of` picks.
template <class StripOf>
Scenario CardScenario(float width, const StripOf& strip_of) {
  Scenario scenario = EveryOutputScenario();
  for (Groom& groom : scenario.grooms)
    for (StrandBlock& strands : groom.strands)
      for (uint32_t s = 0; s < kStrandsPerChunk; ++s) {
        strands.width[s] = width;
        strands.film_strip[s] = strip_of(s);
      }
  return scenario;
}

std::vector<std::byte> Draw(Scenario scenario) {
  RunningScenario running(scenario, {});
  RunFrame(running, 0);
  const Camera camera = scenario.PrepareFrame(0, running.scene()).camera;
  std::vector<std::string> notes;
  return DrawPicture(scenario, running.scene(), camera, VertexOrder::kSorted, {160, 120, 2}, notes);
}

// Mean difference of two pictures' bytes.
double Difference(const std::vector<std::byte>& a, const std::vector<std::byte>& b) {
  const auto read = [](const std::vector<std::byte>& png) {
    return ReadControlMap({reinterpret_cast<const uint8_t*>(png.data()), png.size()}, "picture");
  };
  const ControlMap left = read(a), right = read(b);
  double sum = 0.0;
  for (size_t i = 0; i < left.rgba.size(); ++i) sum += std::abs(left.rgba[i] - right.rgba[i]);
  return sum / double(left.rgba.size());
}

TEST(FilmStrip, CardsShowSilhouettesAndHairsDoNot) {
  const auto first = [](uint32_t) { return uint8_t(0); };
  const auto several = [](uint32_t s) { return uint8_t(s % 8); };
  const double differ =
      Difference(Draw(CardScenario(0.012f, first)), Draw(CardScenario(0.012f, several)));
  EXPECT_GT(differ, 0.03) << "more than by their shadows";
  EXPECT_EQ(Draw(CardScenario(0.0039f, first)), Draw(CardScenario(0.0039f, several)));
}

// In every output and both vertex orders.
TEST(FilmStrip, StrandsShowTheStripsThatTheyWereBakedWith) {
  Scenario scenario = CardScenario(
      0.006f, [](uint32_t s) { return uint8_t(MixBits(s) % 8 < 5 ? 3 : MixBits(s) % 256); });
  for (const VertexOrder order : {VertexOrder::kSorted, VertexOrder::kIndexBuffer}) {
    RunningScenario running(scenario, {.vertex_order = order});
    RunFrame(running, 0);
    std::array<uint32_t, 256> drawn{}, baked{};
    uint32_t count = 0;
    for (const auto& hairs : ReadHairs(running.scene(), order))
      for (const Hair& hair : hairs) {
        const auto& strands =
            *running.scene().memory().Of<&Streams::strands>(hair.number / kStrandsPerChunk);
        EXPECT_TRUE(hair.is_card);
        ++drawn[hair.film_strip];
        ++baked[strands.film_strip[hair.number % kStrandsPerChunk]];
        ++count;
      }
    EXPECT_EQ(drawn, baked);
    EXPECT_GT(count, 400u);
    EXPECT_NEAR(double(drawn[3]) / count, 5.0 / 8.0, 0.1);
  }
}

}  // namespace
}  // namespace pelt::testing
