// Fins in pictures: an outline that is fuller, and the same by both renderers.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>

#include "tests/picture/gl_pictures.hpp"

namespace pelt::testing {
namespace {

constexpr PictureOptions kSquare{240, 240, 2};

// The layer of shells of `tiny` alone, near enough that one sees between its few shells.
class Head {
 public:
  Head() : scenario_(MakeScenarioOfShells()), running_(scenario_, {}) {
    FrameInput input = running_.Prepare(0, {}, scenario_.base.lod);
    LookAtHead(input.camera);
    EXPECT_TRUE(running_.TryBegin(input));
    EXPECT_EQ(SerialExecutor().Run(running_.scene().CurrentFrame()), nullptr);
    std::vector<std::string> notes;
    scene_ = GatherPicture(scenario_, running_.scene(), input.camera, VertexOrder::kSorted, notes);
    KeepShells();
  }
  const PictureScene& scene() const { return scene_; }
  PictureScene WithoutFins() const {
    PictureScene scene = scene_;
    scene.draws[0].shells.fins = {};
    return scene;
  }
  // The bodies far above what is looked at.
  PictureScene WithoutAnything() const {
    PictureScene scene = WithoutShells();
    for (Body& body : scene.bodies) {
      for (glm::vec3& at : body.position) at.y += 1000.0f;
      body.eyes.clear();
    }
    return scene;
  }
  PictureScene WithoutShells() const {
    PictureScene scene = scene_;
    scene.draws[0].shells.shell = {};
    return scene;
  }

 private:
  static Scenario MakeScenarioOfShells() {
    Scenario scenario = TinyScenario();
    AddShells(scenario);
    scenario.grooms[0].layers.back().params.shells = 3;
    scenario.grooms[0].layers.back().params.fur_texture_size = 128;
    return scenario;
  }
  static void LookAtHead(Camera& camera) {
    const float eye[3] = {0.5f, 0.6f, 1.2f}, target[3] = {0.0f, 0.85f, 0.0f};
    std::copy_n(eye, 3, camera.eye);
    std::copy_n(target, 3, camera.target);
    camera.vertical_fov_rad = 0.6f;
  }
  // Of all parallel lists the place of the shells.
  void KeepShells() {
    size_t at = 0;
    while (scene_.draws[at].output != Output::kShells) ++at;
    const auto keep = [at](auto& list) { list = {list[at]}; };
    keep(scene_.draws);
    keep(scene_.layers);
    keep(scene_.textures);
    keep(scene_.growth);
    keep(scene_.actors);
    keep(scene_.layer_looks);
  }

  Scenario scenario_;
  RunningScenario running_;
  PictureScene scene_{};
};

const Head& TheHead() {
  static const Head head;
  return head;
}

using Pixels = std::vector<uint8_t>;

// Of each pixel the channel that differs most.
std::vector<int> Differences(const Pixels& a, const Pixels& b) {
  std::vector<int> differs(a.size() / 3, 0);
  for (size_t i = 0; i < a.size(); ++i)
    differs[i / 3] = std::max(differs[i / 3], std::abs(int(a[i]) - int(b[i])));
  return differs;
}

// How much fur there is before the background, beside the skin: by how many whole pixels it differs.
struct Outline {
  uint32_t pixels = 0;
  double with = 0.0, without = 0.0;
};

// `bare` has no fur, and `empty` nothing at all.
Outline FindOutline(const Pixels& with, const Pixels& without, const Pixels& bare,
                    const Pixels& empty) {
  constexpr int kSkin = 2, kFur = 6;
  const std::vector<int> skin = Differences(bare, empty), all = Differences(with, empty),
                         shells = Differences(without, empty);
  Outline outline;
  for (size_t i = 0; i < skin.size(); ++i) {
    if (skin[i] > kSkin || std::max(all[i], shells[i]) <= kFur) continue;
    ++outline.pixels;
    outline.with += all[i] / 255.0;
    outline.without += shells[i] / 255.0;
  }
  return outline;
}

void ExpectFullerOutline(const Outline& outline, const char* renderer) {
  std::printf("%s: an outline of %u pixels, filled to %.1f by shells and to %.1f with fins\n",
              renderer, outline.pixels, outline.without, outline.with);
  EXPECT_GT(outline.pixels, 500u);
  EXPECT_GT(outline.with, 1.02 * outline.without);
}

template <class Renderer>
Outline OutlineBy(Renderer& renderer) {
  return FindOutline(renderer.Draw(TheHead().scene(), kSquare),
                     renderer.Draw(TheHead().WithoutFins(), kSquare),
                     renderer.Draw(TheHead().WithoutShells(), kSquare),
                     renderer.Draw(TheHead().WithoutAnything(), kSquare));
}

TEST(FinPicture, HasAFullerOutline) {
  SoftwareRenderer renderer;
  ExpectFullerOutline(OutlineBy(renderer), "software");
}

TEST(FinPicture, IsTheSameByOpenGl) {
  Result<GlRenderer> opened = GlRenderer::Open();
  if (!opened) GTEST_SKIP() << opened.error();
  ExpectFullerOutline(OutlineBy(*opened), "OpenGL");
  SoftwareRenderer software;
  const Pixels twin = software.Draw(TheHead().scene(), kSquare);
  const Pixels without = opened->Draw(TheHead().WithoutFins(), kSquare);
  const double shells = PsnrDb(without, software.Draw(TheHead().WithoutFins(), kSquare));
  const double fins = PsnrDb(opened->Draw(TheHead().scene(), kSquare), twin);
  const double missing = PsnrDb(without, twin);
  std::printf(
      "between OpenGL and software: %.1f dB with shells, %.1f with fins, %.1f where one "
      "leaves them out\n",
      shells, fins, missing);
  EXPECT_GT(fins, shells - 1.0);
  EXPECT_LT(missing, fins - 3.0);
}

// Shells as instances of one draw: the same bytes as with a draw for each, and what that gains.
TEST(ShellInstances, AreTheSamePicture) {
  Result<GlRenderer> opened = GlRenderer::Open();
  if (!opened) GTEST_SKIP() << opened.error();
  std::array<Shell, 40> shells;
  for (size_t i = 0; i < shells.size(); ++i) {
    const float height = float(i + 1) / float(shells.size());
    shells[i] = {height, 0.5f + 0.5f * height, float(i) / float(shells.size()), 1.0f};
  }
  PictureScene scene = TheHead().WithoutFins();
  scene.draws[0].shells.shell = shells;
  const PictureScene bare = TheHead().WithoutShells();
  const auto draw = [&](const PictureScene& drawn, bool one_by_one) {
    PictureOptions options = kSquare;
    options.shells_one_by_one = one_by_one;
    return opened->Draw(drawn, options);
  };
  EXPECT_EQ(draw(scene, true), draw(scene, false));
  EXPECT_NE(draw(scene, true), draw(bare, false));
  // Alternately, so that what else the machine does meets all three.
  double ms[3] = {};
  for (int i = 0; i < 3 * 20; ++i) {
    const auto start = std::chrono::steady_clock::now();
    draw(i % 3 == 2 ? bare : scene, i % 3 == 0);
    ms[i % 3] +=
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  }
  std::printf("%s, %zu shells: as instances %.3f of the time with a draw for each\n",
              opened->Device().c_str(), shells.size(), (ms[1] - ms[2]) / (ms[0] - ms[2]));
}

}  // namespace
}  // namespace pelt::testing
