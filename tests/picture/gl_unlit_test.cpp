// Unlit materials, KHR_materials_unlit: skin in its own colour, by both renderers.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "core/groom/surface_colour.hpp"
#include "tests/picture/gl_pictures.hpp"
#include "tests/picture/unlit_scenario.hpp"

namespace pelt::testing {
namespace {

PictureScene InTheDark(PictureScene scene) {
  scene.ForEachLook([](PictureLook& look) {
    look.light.sun = look.light.rim = glm::vec3(0.0f);
    std::ranges::fill(look.light.sky, glm::vec3(0.0f));
  });
  return scene;
}

// In any light; and with the light that falls on it where the material is not unlit.
void ExpectOwnColour(PictureRenderer& renderer) {
  const Shown unlit(UnlitScenario(true), VertexOrder::kSorted);
  const PictureScene bare = BareSkin(unlit.scene());
  const uint32_t shown = CountUnlit(renderer.Draw(bare, kSmall)),
                 dark = CountUnlit(renderer.Draw(InTheDark(bare), kSmall));
  std::printf("%s: %u pixels in their own colour, %u without light\n", renderer.Device().c_str(),
              shown, dark);
  EXPECT_GT(shown, 1500u);
  EXPECT_EQ(dark, shown);
  const Shown lit(UnlitScenario(false), VertexOrder::kSorted);
  EXPECT_LT(CountUnlit(renderer.Draw(BareSkin(lit.scene()), kSmall)), shown / 20);
}

TEST(UnlitPicture, HasItsOwnColour) {
  SoftwareRenderer software;
  ExpectOwnColour(software);
}

// Fur on an unlit character is lit, and the skin between it is not.
TEST(UnlitPicture, FurOnItIsLit) {
  SoftwareRenderer renderer;
  Scenario scenario = UnlitScenario(true);
  const Shown shown(scenario, VertexOrder::kSorted);
  PictureScene scene = shown.scene();
  scene.draws.clear();
  scene.layers.clear();
  for (Body& body : scene.bodies) std::ranges::fill(body.covered, 1.0f);
  const std::vector<uint8_t> furry = renderer.Draw(scene, kSmall);
  EXPECT_LT(CountUnlit(furry), CountUnlit(renderer.Draw(BareSkin(scene), kSmall)) / 2);
  EXPECT_LT(PsnrDb(renderer.Draw(InTheDark(scene), kSmall), furry), kTwinDb);
}

TEST_F(GlPicture, UnlitSkinIsThatOfTheSoftware) {
  ExpectOwnColour(*renderer_);
  const Shown unlit(UnlitScenario(true), VertexOrder::kSorted);
  for (const PictureScene& scene : {BareSkin(unlit.scene()), unlit.scene()}) {
    const std::vector<uint8_t> picture = renderer_->Draw(scene, kSmall);
    const double db = PsnrDb(picture, SoftwareRenderer().Draw(scene, kSmall));
    std::printf("unlit: %.1f dB between OpenGL and software\n", db);
    EXPECT_GE(db, kFurTwinDb);
  }
  // One that lights it is seen.
  const Shown lit(UnlitScenario(false), VertexOrder::kSorted);
  const double fault = PsnrDb(renderer_->Draw(BareSkin(lit.scene()), kSmall),
                              SoftwareRenderer().Draw(BareSkin(unlit.scene()), kSmall));
  std::printf("lit by one of them: %.1f dB\n", fault);
  EXPECT_LT(fault, kFurTwinDb);
}

}  // namespace
}  // namespace pelt::testing
