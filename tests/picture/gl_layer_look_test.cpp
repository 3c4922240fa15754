// [layer.look]: each layer takes light by its own, in both renderers.
#include <gtest/gtest.h>

#include <cstdio>

#include "tests/picture/gl_pictures.hpp"

namespace pelt::testing {
namespace {

// The monster, or its every output, whose layers have the look that change(look, layer) makes of the default one.
template <class Change>
Scenario WithLooks(Scenario scenario, const Change& change) {
  for (Groom& groom : scenario.grooms)
    for (size_t l = 0; l < groom.layers.size(); ++l) change(groom.layers[l].params.look, l);
  return scenario;
}

template <class Change>
std::vector<uint8_t> PictureOf(const Change& change) {
  const Shown shown(WithLooks(TinyScenario(), change), VertexOrder::kSorted);
  return SoftwareRenderer().Draw(shown.scene(), kSmall);
}

glm::dvec3 MeanColour(const std::vector<uint8_t>& rgb) {
  glm::dvec3 sum(0.0);
  for (size_t i = 0; i < rgb.size(); ++i) sum[int(i % 3)] += rgb[i];
  return sum / (double(rgb.size()) / 3.0);
}

TEST(LayerLook, EachTermIsSeen) {
  const std::vector<uint8_t> plain = PictureOf([](LayerLook&, size_t) {});
  const glm::dvec3 mean = MeanColour(plain);
  const glm::dvec3 tinted = MeanColour(PictureOf([](LayerLook& look, size_t) {
    look.tint = {1.0f, 0.3f, 0.1f};
  }));
  EXPECT_LT(tinted.g, mean.g - 0.5);
  EXPECT_LT(tinted.b, mean.b - 0.5);
  EXPECT_NEAR(tinted.r, mean.r, 0.5);
  // Each value moved to the bound that is farther off.
  for (const LayerLookEntry& entry : kLayerLookEntries) {
    const std::vector<uint8_t> other = PictureOf([&](LayerLook& look, size_t) {
      float& value = look.*entry.member;
      value = value > 0.5f * float(entry.high) ? float(entry.low) : float(entry.high);
    });
    size_t changed = 0;
    for (size_t i = 0; i < plain.size(); ++i) changed += plain[i] != other[i];
    std::printf("%-20s %zu bytes are others\n", std::string(entry.key).c_str(), changed);
    EXPECT_GT(changed, 200u) << entry.key;
  }
}

TEST(LayerLook, IsTheLayersAlone) {
  const Shown shown(WithLooks(TinyScenario(),
                              [](LayerLook& look, size_t l) { look.specular = l == 0 ? 2 : 0.1f; }),
                    VertexOrder::kSorted);
  const PictureScene& scene = shown.scene();
  ASSERT_GT(scene.draws.size(), 1u);
  for (size_t i = 0; i < scene.draws.size(); ++i) {
    EXPECT_EQ(scene.layer_looks[i].hair.primary, scene.draws[i].layer == 0 ? 2.0f : 0.1f);
    EXPECT_EQ(scene.draws[i].look->specular, scene.layer_looks[i].hair.primary);
  }
  for (const PictureLook& body : scene.body_looks)
    EXPECT_EQ(body.hair.primary, LayerLook{}.specular);
}

// On the skin too, where the light is the skin's.
TEST(LayerLook, IsItsReliefs) {
  Scenario scenario = EveryOutputScenario();
  std::vector<LayerSetup>& layers = scenario.setups[scenario.actors[0].groom].layers;
  layers[1].params.look.specular = 3.0f;
  const Shown shown(scenario, VertexOrder::kSorted, {layers[0].name, layers[1].name});
  PictureScene scene = shown.scene();
  ASSERT_EQ(scene.relief_looks[0].size(), 2u);
  EXPECT_EQ(scene.relief_looks[0][0].hair.primary, LayerLook{}.specular);
  EXPECT_EQ(scene.relief_looks[0][1].hair.primary, 3.0f);
  const std::vector<uint8_t> shining = SoftwareRenderer().Draw(scene, kSmall);
  scene.relief_looks[0][1].hair.primary = LayerLook{}.specular;
  EXPECT_NE(SoftwareRenderer().Draw(scene, kSmall), shining);
}

TEST_F(GlPicture, LooksOfLayersAreThoseOfTheSoftware) {
  const auto other = [](LayerLook& look, size_t l) {
    look.tint = {1.0f, l % 2 ? 0.4f : 1.2f, 0.7f};
    look.specular = 0.5f;
    look.second_exponent = 12.0f;
    look.rim = 2.0f;
    look.scatter = 0.9f;
  };
  for (const VertexOrder order : {VertexOrder::kSorted, VertexOrder::kIndexBuffer}) {
    const Shown shown(WithLooks(EveryOutputScenario(), other), order),
        plain(EveryOutputScenario(), order);
    const std::vector<uint8_t> software = SoftwareRenderer().Draw(shown.scene(), kSmall);
    const double same = PsnrDb(renderer_->Draw(shown.scene(), kSmall), software),
                 fault = PsnrDb(renderer_->Draw(plain.scene(), kSmall), software);
    std::printf("looks: %.1f dB between OpenGL and software, %.1f with the default\n", same, fault);
    EXPECT_GE(same, kFurTwinDb);
    EXPECT_LT(fault, kFurTwinDb);
  }
}

}  // namespace
}  // namespace pelt::testing
