// Cards of hairs by OpenGL: the software's silhouettes, and none of those with a fault planted in them. Skipped, and
// says why, where there is no OpenGL.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <functional>

#include "core/random.hpp"
#include "tests/picture/gl_pictures.hpp"

namespace pelt::testing {
namespace {

constexpr float kWide = 0.012f;

// Strands of this width, each with one of the first 24 film strips.
Scenario Cards(Scenario scenario, float width) {
  for (Groom& groom : scenario.grooms)
    for (StrandBlock& strands : groom.strands)
      for (uint32_t s = 0; s < kStrandsPerChunk; ++s) {
        strands.width[s] = width;
        strands.film_strip[s] = uint8_t(MixBits(s) % 24);
      }
  return scenario;
}

struct GlCardPicture : GlPicture {
  // Only what is read from hairs: the strips that OpenGL reads from vertices stay as they are.
  static PictureScene Planted(PictureScene scene, const std::function<void(Hair&)>& plant) {
    for (auto& hairs : scene.layers) std::ranges::for_each(hairs, plant);
    return scene;
  }
};

TEST_F(GlCardPicture, IsThatOfTheSoftwareForEveryOutputInBothOrders) {
  const Shown sorted(Cards(EveryOutputScenario(), kWide), VertexOrder::kSorted);
  const Shown indexed(Cards(EveryOutputScenario(), kWide), VertexOrder::kIndexBuffer);
  ASSERT_TRUE(sorted.scene().layers.front().front().is_card);
  ASSERT_EQ(CountStrips(sorted.scene().layers), 24u);
  const PictureScene near = Nearer(sorted.scene(), 0.4f);
  const std::vector<uint8_t> picture = renderer_->Draw(near, kSmall);
  EXPECT_EQ(picture, renderer_->Draw(Nearer(indexed.scene(), 0.4f), kSmall));
  const std::vector<uint8_t> software = SoftwareRenderer().Draw(near, kSmall);
  const double db = PsnrDb(picture, software);
  std::printf("cards of every output: %.1f dB between OpenGL and software\n", db);
  EXPECT_GE(db, kTwinDb);
  // What has no silhouettes, or those of another strip, is neither's picture.
  const struct {
    const char* name;
    std::function<void(Hair&)> plant;
  } kFaults[] = {
      {"no silhouettes", [](Hair& hair) { hair.is_card = false; }},
      {"the next strip", [](Hair& hair) { hair.film_strip = (hair.film_strip + 1) % 24; }},
      {"one strip for all", [](Hair& hair) { hair.film_strip = 7; }},
  };
  for (const auto& fault : kFaults) {
    const PictureScene planted = Planted(near, fault.plant);
    const double away = PsnrDb(picture, SoftwareRenderer().Draw(planted, kSmall));
    std::printf("%s: %.1f dB\n", fault.name, away);
    EXPECT_LT(away, db - 2.0) << fault.name;
  }
}

TEST_F(GlCardPicture, EachPlantedFaultIsSeen) {
  const Shown shown(Cards(BakedMonster(), kWide), VertexOrder::kSorted);
  const std::vector<uint8_t> right = renderer_->Draw(shown.scene(), kSmall);
  EXPECT_GE(PsnrDb(renderer_->Draw(shown.scene(), kSmall), right), kSameDb);
  const double db = PsnrDb(right, SoftwareRenderer().Draw(shown.scene(), kSmall));
  std::printf("a monster of cards: %.1f dB between OpenGL and software\n", db);
  EXPECT_GE(db, kTwinDb);
  const auto no_cards = [](Hair& hair) { hair.is_card = false; };
  const double hairs = PsnrDb(renderer_->Draw(Planted(shown.scene(), no_cards), kSmall), right);
  std::printf("no silhouettes: %.1f dB\n", hairs);
  EXPECT_LT(hairs, kTwinDb);
  PictureOptions buffered = kSmall;
  buffered.lighting_buffer = true;
  EXPECT_LT(PsnrDb(renderer_->Draw(Planted(shown.scene(), no_cards), buffered),
                   renderer_->Draw(shown.scene(), buffered)),
            kTwinDb);
}

// The sun's map has of a card what its silhouettes cover.
TEST_F(GlCardPicture, CastsTheShadowOfItsSilhouettes) {
  const Shown shown(Cards(BakedMonster(), kWide), VertexOrder::kSorted);
  const PictureScene& cards = shown.scene();
  const PictureScene hairs = Planted(cards, [](Hair& hair) { hair.is_card = false; });
  const auto covered = [&](const PictureScene& scene) {
    double sum = 0.0;
    for (const glm::vec4& texel : renderer_->DrawShadowMap(scene, 0)) sum += double(texel.a);
    return sum;
  };
  PictureScene bare = cards;
  for (auto& layer : bare.layers) layer.clear();
  const double skin = covered(bare), all = covered(hairs) - skin;
  const double share = (covered(cards) - skin) / all;
  double wanted = 0.0, count = 0.0;
  for (const auto& layer : cards.layers)
    for (const Hair& hair : layer) {
      const double area = double(hair.DepthOfLight());
      wanted += area * double(StripShare(hair.film_strip));
      count += area;
    }
  std::printf("cards cast %.3f of whole ones' shadow, silhouettes are %.3f\n", share,
              wanted / count);
  EXPECT_NEAR(share, wanted / count, 0.04);
}

// Below kCardWidth a strand is one hair, for any strip.
TEST_F(GlCardPicture, ThinHairsAreAsBefore) {
  const Shown thin(Cards(BakedMonster(), 0.0039f), VertexOrder::kSorted);
  Scenario other = Cards(BakedMonster(), 0.0039f);
  for (Groom& groom : other.grooms)
    for (StrandBlock& strands : groom.strands) std::ranges::fill(strands.film_strip, uint8_t(3));
  const Shown same(other, VertexOrder::kSorted);
  EXPECT_EQ(renderer_->Draw(thin.scene(), kSmall), renderer_->Draw(same.scene(), kSmall));
}

}  // namespace
}  // namespace pelt::testing
