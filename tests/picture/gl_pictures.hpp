// What tests of OpenGL's pictures have in common: the renderer, frames to draw, and how far two pictures are apart.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "bench/picture/gl_renderer.hpp"
#include "tests/jobs/tiny_scene.hpp"
#include "tests/picture/order_error.hpp"

namespace pelt::testing {

inline constexpr PictureOptions kSmall{320, 240, 2};
// Other drivers, and other rasterisers of the same driver, are above; each planted fault is below.
inline constexpr double kSameDb = 52.0;
// Triangles against hairs painted by distance: another rasteriser, the same picture. Where next to nothing but fur is
// seen there is less between them; skin is lit per pixel by the one and at its corners by the other.
inline constexpr double kTwinDb = 30.0, kFurTwinDb = 45.0;

class Shown {
 public:
  Shown(Scenario drawn, VertexOrder order, const std::vector<std::string>& relief = {})
      : scenario_(std::move(drawn)), running_(scenario_, {.vertex_order = order}) {
    RunFrame(running_, 0);
    std::vector<std::string> notes;
    const Camera camera = scenario_.PrepareFrame(0, running_.scene()).camera;
    scene_ = GatherPicture(scenario_, running_.scene(), camera, order, notes, relief);
  }
  const PictureScene& scene() const { return scene_; }

 private:
  Scenario scenario_;
  RunningScenario running_;
  PictureScene scene_{};
};

inline const Scenario& BakedMonster() {
  static const Scenario kBaked = LoadScenario("monster");
  return kBaked;
}
inline const PictureScene& Monster() {
  static const Shown shown(BakedMonster(), VertexOrder::kIndexBuffer);
  return shown.scene();
}

// Seen from this share of the distance.
inline PictureScene Nearer(PictureScene scene, float share) {
  for (int k = 0; k < 3; ++k)
    scene.camera.eye[k] = glm::mix(scene.camera.target[k], scene.camera.eye[k], share);
  return scene;
}

inline double PsnrDb(const std::vector<uint8_t>& a, const std::vector<uint8_t>& b) {
  EXPECT_EQ(a.size(), b.size());
  double squares = 0.0;
  for (size_t i = 0; i < a.size(); ++i) {
    const double off = (double(a[i]) - double(b[i])) / 255.0;
    squares += off * off;
  }
  return PictureError{.mean_square = squares / double(a.size())}.PsnrDb();
}

// Skips, and says why, where there is no OpenGL.
struct GlPicture : ::testing::Test {
  static void SetUpTestSuite() {
    Result<GlRenderer> opened = GlRenderer::Open();
    if (opened)
      renderer_ = std::make_unique<GlRenderer>(*std::move(opened));
    else
      missing_ = opened.error();
  }
  static void TearDownTestSuite() { renderer_.reset(); }
  void SetUp() override {
    if (!renderer_) GTEST_SKIP() << missing_;
  }

  static inline std::unique_ptr<GlRenderer> renderer_;
  static inline std::string missing_;
};

}  // namespace pelt::testing
