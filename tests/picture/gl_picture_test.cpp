// The picture by OpenGL against the one in software, against itself, and against faults planted in it. Skipped, and
// says why, where there is no OpenGL.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <random>
#include <set>

#include "bench/picture/png.hpp"
#include "tests/picture/gl_pictures.hpp"

namespace pelt::testing {
namespace {

// Layers' hairs in another order; `sequence` has the places of each as they are to be.
class Reordered {
 public:
  template <class Change>
  Reordered(const PictureScene& scene, const Change& change) : scene(scene) {
    orders_.reserve(scene.draws.size());
    for (size_t layer = 0; layer < scene.draws.size(); ++layer) {
      std::vector<uint32_t> places(scene.layers[layer].size());
      for (uint32_t i = 0; i < places.size(); ++i) places[i] = i;
      change(places);
      std::vector<uint32_t>& order = orders_.emplace_back();
      for (size_t i = 0; i < places.size(); ++i) {
        order.push_back(scene.draws[layer].order[places[i]]);
        this->scene.layers[layer][i] = scene.layers[layer][places[i]];
      }
      this->scene.draws[layer].order = order;
    }
  }
  PictureScene scene;

 private:
  std::vector<std::vector<uint32_t>> orders_;
};

TEST_F(GlPicture, IsThatOfTheSoftware) {
  const double db =
      PsnrDb(renderer_->Draw(Monster(), kSmall), SoftwareRenderer().Draw(Monster(), kSmall));
  std::printf("monster, 320 x 240: %.1f dB between OpenGL and software\n", db);
  EXPECT_GE(db, kFurTwinDb);
}

TEST_F(GlPicture, IsThatOfTheSoftwareForEveryOutputInBothOrders) {
  const Shown sorted(EveryOutputScenario(), VertexOrder::kSorted);
  const Shown indexed(EveryOutputScenario(), VertexOrder::kIndexBuffer);
  std::set<Output> outputs;
  for (const LayerDraw& draw : sorted.scene().draws) outputs.insert(draw.output);
  ASSERT_EQ(outputs.size(), kOutputCount);
  const std::vector<uint8_t> picture = renderer_->Draw(sorted.scene(), kSmall);
  EXPECT_EQ(picture, renderer_->Draw(indexed.scene(), kSmall));
  const double db = PsnrDb(picture, SoftwareRenderer().Draw(sorted.scene(), kSmall));
  std::printf("every output, 320 x 240: %.1f dB between OpenGL and software\n", db);
  EXPECT_GE(db, kTwinDb);
}

// What is in front hides the rest in any order of drawing.
TEST_F(GlPicture, LayersHideEachOtherInAnyOrder) {
  PictureScene scene = Monster();
  std::ranges::reverse(scene.draws);
  std::ranges::reverse(scene.layers);
  const double db = PsnrDb(renderer_->Draw(scene, kSmall), SoftwareRenderer().Draw(scene, kSmall));
  std::printf("last layer first: %.1f dB between OpenGL and software\n", db);
  EXPECT_GE(db, kFurTwinDb);
}

// Normals from look records are those of the roots, but for 16 bits.
TEST_F(GlPicture, LookRecordsHaveTheRootsNormals) {
  Scenario scenario = BakedMonster();
  for (LayerParams* layer : LayersOf(scenario)) layer->lit = true;
  for (const VertexOrder order : {VertexOrder::kSorted, VertexOrder::kIndexBuffer}) {
    const Shown lit(scenario, order);
    for (const LayerDraw& draw : lit.scene().draws) ASSERT_FALSE(draw.looks.empty());
    EXPECT_GE(PsnrDb(renderer_->Draw(lit.scene(), kSmall), renderer_->Draw(Monster(), kSmall)),
              kSameDb);
  }
}

// A checkered character without fur, of which the image has its upper half darker: turned over, it would be seen.
Scenario Checkered() {
  Scenario scenario = TinyScenario();
  std::vector<uint8_t> rgb;
  for (uint32_t i = 0; i < 32 * 32; ++i) {
    const bool upper = i / 32 < 16, odd = (i / 4 + i / 128) % 2;
    for (const int channel : {odd ? 230 : 40, upper ? 60 : 160, 90})
      rgb.push_back(uint8_t(channel));
  }
  const std::vector<std::byte> png = EncodePng(rgb, 32, 32, 3);
  for (Character& character : scenario.characters) {
    character.images = {{png.begin(), png.end()}};
    Mesh& mesh = character.mesh;
    mesh.looks.assign(mesh.materials.size(),
                      {.stated = true, .base_colour = {0.9f, 0.8f, 1.0f}, .image = 0});
    mesh.uv.clear();
    for (const glm::vec3& p : mesh.position) mesh.uv.push_back({3.0f * p.x, 1.5f * p.y});
  }
  return scenario;
}

TEST_F(GlPicture, SkinHasItsImage) {
  const Shown shown(Checkered(), VertexOrder::kSorted);
  PictureScene bare = shown.scene();
  bare.draws.clear();
  bare.layers.clear();
  for (Body& body : bare.bodies) std::ranges::fill(body.covered, 0.0f);
  const std::vector<uint8_t> picture = renderer_->Draw(bare, kSmall);
  const double db = PsnrDb(picture, SoftwareRenderer().Draw(bare, kSmall));
  std::printf("an image on the skin: %.1f dB between OpenGL and software\n", db);
  EXPECT_GE(db, kTwinDb);
  const Shown plain(TinyScenario(), VertexOrder::kSorted);
  for (size_t b = 0; b < bare.bodies.size(); ++b)
    bare.bodies[b].surface = plain.scene().bodies[b].surface;
  EXPECT_LT(PsnrDb(picture, renderer_->Draw(bare, kSmall)), kTwinDb);
}

TEST_F(GlPicture, IsTheSameAgain) {
  const std::vector<uint8_t> picture = renderer_->Draw(Monster(), kSmall);
  EXPECT_GE(PsnrDb(renderer_->Draw(Monster(), kSmall), picture), kSameDb);
  renderer_.reset();
  renderer_ = std::make_unique<GlRenderer>(GlRenderer::Open().OrThrow());
  EXPECT_GE(PsnrDb(renderer_->Draw(Monster(), kSmall), picture), kSameDb);
}

TEST_F(GlPicture, EachPlantedFaultIsSeen) {
  const std::vector<uint8_t> right = renderer_->Draw(Monster(), kSmall);
  const struct {
    const char* name;
    void (*plant)(PictureLook& look);
  } kFaults[] = {
      {"no sun", [](PictureLook& look) { look.light.sun = glm::vec3(0.0f); }},
      {"no sky", [](PictureLook& look) { std::ranges::fill(look.light.sky, glm::vec3(0.0f)); }},
      {"no rim", [](PictureLook& look) { look.light.rim = glm::vec3(0.0f); }},
      {"no secondary lobe", [](PictureLook& look) { look.hair.secondary = 0.0f; }},
      {"no scattering", [](PictureLook& look) { look.hair.scatter = 0.0f; }},
      {"no self-shadow", [](PictureLook& look) { look.shadow.strength = 0.0f; }},
      {"no depth shadow", [](PictureLook& look) { look.depth_floor = 1.0f; }},
  };
  const auto hold = [&](const char* name, const PictureScene& scene) {
    const double db = PsnrDb(renderer_->Draw(scene, kSmall), right);
    std::printf("%s: %.1f dB\n", name, db);
    EXPECT_LT(db, kSameDb) << name;
  };
  for (const auto& fault : kFaults) {
    PictureScene scene = Monster();
    scene.ForEachLook(fault.plant);
    hold(fault.name, scene);
  }
  hold("reversed order",
       Reordered(Monster(), [](auto& places) { std::ranges::reverse(places); }).scene);
}

TEST_F(GlPicture, ShadowMapsForgetTheOrder) {
  const std::vector<glm::vec4> forwards = renderer_->DrawShadowMap(Monster(), 0);
  const auto count = [&](auto is) { return std::ranges::count_if(forwards, is); };
  ASSERT_GT(count([](const glm::vec4& t) { return t.a == 0.0f; }), 1000);
  ASSERT_GT(count([](const glm::vec4& t) { return t.a > 0.0f && t.a < 255.0f; }), 300);
  ASSERT_GT(count([](const glm::vec4& t) { return t.a > 512.0f; }), 1000);  // many hairs deep
  ASSERT_EQ(count([](const glm::vec4& t) { return t.r != t.g || t.r != t.b; }), 0);
  const Reordered backwards(Monster(), [](auto& places) { std::ranges::reverse(places); });
  EXPECT_TRUE(renderer_->DrawShadowMap(backwards.scene, 0) == forwards);
  std::mt19937 random(15);
  const Reordered shuffled(Monster(), [&](auto& places) { std::ranges::shuffle(places, random); });
  EXPECT_TRUE(renderer_->DrawShadowMap(shuffled.scene, 0) == forwards);
  // The comparison sees one hair less.
  const Reordered without(Monster(), [](auto& places) { places.back() = places.front(); });
  EXPECT_FALSE(renderer_->DrawShadowMap(without.scene, 0) == forwards);
}

// EyePet's way: another light on the same hairs.
TEST_F(GlPicture, LightingBufferIsAnotherLightOfTheSamePicture) {
  PictureOptions buffered = kSmall;
  buffered.lighting_buffer = true;
  // Each twice: the driver compiles before the first time.
  const auto draw = [&](const PictureOptions& options, double& ms) {
    renderer_->Draw(Monster(), options);
    const std::clock_t start = std::clock();
    std::vector<uint8_t> rgb = renderer_->Draw(Monster(), options);
    ms = 1e3 * double(std::clock() - start) / double(CLOCKS_PER_SEC);
    return rgb;
  };
  double buffered_ms = 0.0, direct_ms = 0.0;
  const std::vector<uint8_t> picture = draw(buffered, buffered_ms);
  const double db = PsnrDb(picture, draw(kSmall, direct_ms));
  std::printf("lighting buffer: %.1f dB; %.0f ms of one core, and %.0f without it\n", db,
              buffered_ms, direct_ms);
  EXPECT_LT(db, kSameDb);
  EXPECT_GE(db, 18.0);
  EXPECT_GE(PsnrDb(picture, renderer_->Draw(Monster(), buffered)), kSameDb);
  // What is behind everything is what the outlines have.
  PictureScene scene = Monster();
  scene.ForEachLook([](PictureLook& look) { look.light.rim = glm::vec3(0.0f); });
  EXPECT_LT(PsnrDb(picture, renderer_->Draw(scene, buffered)), kSameDb);
}

// What is too large is refused in words.
TEST_F(GlPicture, RefusesWhatTheDriverCannotDraw) {
  try {
    renderer_->Draw(Monster(), {4096, 16, 64});
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("samples a side"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace pelt::testing
