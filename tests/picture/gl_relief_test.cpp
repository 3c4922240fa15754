// Relief by OpenGL: the software's picture, and none of those with a fault planted in it. Skipped, and says why, where
// there is no OpenGL.
#include <gtest/gtest.h>

#include <cstdio>
#include <ctime>

#include "tests/picture/gl_pictures.hpp"

namespace pelt::testing {
namespace {

// Of a close look at fur on skin; both renderers sample the same places.
constexpr double kReliefTwinDb = 40.0;

struct GlReliefPicture : GlPicture {
  // So near that its relief is more than a colour.
  static const PictureScene& Furry() {
    static const Shown shown(BakedMonster(), VertexOrder::kSorted, {"all"});
    static const PictureScene kNear = Nearer(shown.scene(), 0.45f);
    return kNear;
  }
};

TEST_F(GlReliefPicture, IsThatOfTheSoftware) {
  ASSERT_TRUE(Furry().bodies[0].relief);
  renderer_->Draw(Furry(), kSmall);  // the driver compiles before the first time
  const std::clock_t start = std::clock();
  const std::vector<uint8_t> picture = renderer_->Draw(Furry(), kSmall);
  const double ms = 1e3 * double(std::clock() - start) / double(CLOCKS_PER_SEC);
  const std::vector<uint8_t> software = SoftwareRenderer().Draw(Furry(), kSmall);
  const double db = PsnrDb(picture, software);
  std::printf("relief: %.1f dB between OpenGL and software, %.0f ms of one core\n", db, ms);
  EXPECT_GE(db, kReliefTwinDb);
  EXPECT_GE(PsnrDb(picture, renderer_->Draw(Furry(), kSmall)), kSameDb);
  // Without relief neither is the other.
  PictureScene bare = Furry();
  bare.bodies[0].relief = nullptr;
  EXPECT_LT(PsnrDb(renderer_->Draw(bare, kSmall), software), kReliefTwinDb);
}

// Of relief in few steps, each option is seen, and as the software has it.
TEST_F(GlReliefPicture, IsThatOfTheSoftwareInEachWay) {
  const struct {
    const char* name;
    void (*change)(PictureScene& scene);
  } kWays[] = {
      {"jitter", [](PictureScene& scene) { scene.relief.frame = 3; }},
      {"wind",
       [](PictureScene& scene) {
         scene.relief.march.wind = {0.03f, 0.0f, 0.02f};
         scene.relief.march.pan = {0.3f, 0.1f};
       }},
      {"steps in colours", [](PictureScene& scene) { scene.relief.shows_steps = true; }},
      {"highlights of its own",
       [](PictureScene& scene) {
         for (PictureLook& look : scene.relief_looks[0]) look.hair.primary = 4.0f;
       }},
  };
  PictureScene few = Furry();
  few.relief.march.least = 2.0f;
  few.relief.march.most = 3.0f;
  const std::vector<uint8_t> plain = renderer_->Draw(few, kSmall);
  EXPECT_LT(PsnrDb(plain, renderer_->Draw(Furry(), kSmall)), kSameDb);
  for (const auto& way : kWays) {
    PictureScene scene = few;
    way.change(scene);
    const std::vector<uint8_t> picture = renderer_->Draw(scene, kSmall);
    const double twin = PsnrDb(picture, SoftwareRenderer().Draw(scene, kSmall)),
                 apart = PsnrDb(picture, plain);
    std::printf("%s: %.1f dB to the software's, %.1f to relief without\n", way.name, twin, apart);
    EXPECT_GT(twin, apart + 1.0) << way.name;
    EXPECT_LT(apart, kSameDb) << way.name;
  }
}

// One layer on the skin, the others as hairs over it.
TEST_F(GlReliefPicture, LayersThatAreNotNamedKeepTheirHairs) {
  const Shown body(BakedMonster(), VertexOrder::kIndexBuffer, {"body"});
  const std::vector<uint8_t> picture = renderer_->Draw(body.scene(), kSmall);
  const double db = PsnrDb(picture, SoftwareRenderer().Draw(body.scene(), kSmall));
  std::printf("relief of one layer: %.1f dB between OpenGL and software\n", db);
  EXPECT_GE(db, kFurTwinDb);
  EXPECT_LT(PsnrDb(picture, renderer_->Draw(Monster(), kSmall)), kTwinDb);
  const Shown all(BakedMonster(), VertexOrder::kIndexBuffer, {"all"});
  EXPECT_LT(PsnrDb(picture, renderer_->Draw(all.scene(), kSmall)), kTwinDb);
}

TEST_F(GlReliefPicture, EachPlantedFaultIsSeen) {
  const std::vector<uint8_t> right = renderer_->Draw(Furry(), kSmall);
  const struct {
    const char* name;
    void (*plant)(PictureScene& scene);
  } kFaults[] = {
      {"no relief", [](PictureScene& scene) { scene.bodies[0].relief = nullptr; }},
      {"combed across",
       [](PictureScene& scene) { std::swap(scene.bodies[0].axes.u, scene.bodies[0].axes.v); }},
      {"combed backwards",
       [](PictureScene& scene) {
         for (auto* axis : {&scene.bodies[0].axes.u, &scene.bodies[0].axes.v})
           for (glm::vec3& v : *axis) v = -v;
       }},
      {"tips coloured as roots",
       [](PictureScene& scene) { scene.bodies[0].fur_tip = scene.bodies[0].fur; }},
      {"no shade below",
       [](PictureScene& scene) {
         for (PictureLook& look : scene.relief_looks[0]) look.depth_floor = 1.0f;
       }},
      {"no highlights",
       [](PictureScene& scene) {
         for (PictureLook& look : scene.relief_looks[0])
           look.hair.primary = look.hair.secondary = 0.0f;
       }},
      {"no self-shadow", [](PictureScene& scene) { scene.look.shadow.strength = 0.0f; }},
  };
  for (const auto& fault : kFaults) {
    PictureScene scene = Furry();
    fault.plant(scene);
    const double db = PsnrDb(renderer_->Draw(scene, kSmall), right);
    std::printf("%s: %.1f dB\n", fault.name, db);
    EXPECT_LT(db, kSameDb) << fault.name;
  }
}

}  // namespace
}  // namespace pelt::testing
