// Skin that alpha cuts holes into, finer than the mesh: neither it nor fur is drawn there, by both renderers.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "tests/picture/bald_scenario.hpp"
#include "tests/picture/gl_pictures.hpp"

namespace pelt::testing {
namespace {

// Unlit and green but for the holes.
Scenario HolesScenario(bool holes) {
  Scenario scenario =
      BaldScenario("density = 4000\nlength = 0.05\nwidth = 0.01\nbase_colour = '#222222'\n", true);
  std::vector<uint8_t> rgba;
  for (uint32_t y = 0; y < kBaldSide; ++y)
    for (uint32_t x = 0; x < kBaldSide; ++x)
      for (const int channel : {0, 180, 0, IsBaldTexel(x, y) ? 0 : 255})
        rgba.push_back(uint8_t(channel));
  Character& character = scenario.characters[scenario.actors[0].character];
  character.images = {EncodePng(rgba, kBaldSide, kBaldSide, 4)};
  character.mesh.looks.assign(character.mesh.materials.size(), {.stated = true,
                                                                .unlit = true,
                                                                .image = 0,
                                                                .alpha_cutoff = holes ? 0.5f : 0.0f,
                                                                .alpha_image = 0});
  FurSetup& setup = scenario.setups[0];
  setup.layers[0].mask.bald.map = nullptr;
  scenario.grooms = {BakeForActor(scenario, setup)};
  return scenario;
}

PictureScene SkinAlone(const Shown& shown) {
  PictureScene scene = Nearer(shown.scene(), 0.6f);
  scene.draws.clear();
  scene.layers.clear();
  return scene;
}

uint32_t CountGreen(const std::vector<uint8_t>& rgb) {
  uint32_t count = 0;
  for (size_t i = 0; i < rgb.size(); i += 3) count += rgb[i + 1] > 2 * rgb[i] + 40;
  return count;
}

TEST(HolesPicture, NeitherSkinNorFurIsInThem) {
  const Shown shown(HolesScenario(true), VertexOrder::kSorted),
      whole(HolesScenario(false), VertexOrder::kSorted);
  PictureScene scene = SkinAlone(shown);
  ASSERT_EQ(scene.bodies[0].mapped.size(), 1u);
  const Body& body = scene.bodies[0];
  uint32_t holes = 0, covered = 0;
  for (uint32_t t = 0; t < body.character->mesh.triangles.size(); ++t) {
    const SurfacePoint at{t, {0.4f, 0.3f, 0.3f}};
    if (!body.surface->IsHole(at)) continue;
    ++holes;
    covered += CoveredAt(body, at) > 0.1f;
  }
  EXPECT_GT(holes, 100u);
  EXPECT_LT(covered, holes / 10);
  SoftwareRenderer renderer;
  PictureScene other = SkinAlone(whole);
  for (PictureScene* bare : {&scene, &other})
    for (Body& b : bare->bodies) {
      std::ranges::fill(b.covered, 0.0f);
      b.mapped.clear();
    }
  const uint32_t green = CountGreen(renderer.Draw(scene, kSmall)),
                 all = CountGreen(renderer.Draw(other, kSmall));
  std::printf("%u green pixels with holes, %u without\n", green, all);
  EXPECT_GT(green, all / 4);
  // Through the holes of one side those of the other are seen, and its skin.
  EXPECT_LT(green, all - all / 8);
}

TEST_F(GlPicture, HolesAreThoseOfTheSoftware) {
  const Shown shown(HolesScenario(true), VertexOrder::kSorted),
      whole(HolesScenario(false), VertexOrder::kSorted);
  const std::vector<uint8_t> picture = renderer_->Draw(SkinAlone(shown), kSmall);
  const double db = PsnrDb(picture, SoftwareRenderer().Draw(SkinAlone(shown), kSmall)),
               closed = PsnrDb(renderer_->Draw(SkinAlone(whole), kSmall),
                               SoftwareRenderer().Draw(SkinAlone(shown), kSmall));
  std::printf("holes: %.1f dB between OpenGL and software, %.1f where one has none\n", db, closed);
  EXPECT_GE(db, kFurTwinDb);
  EXPECT_LT(closed, kFurTwinDb - 5.0);
}

}  // namespace
}  // namespace pelt::testing
