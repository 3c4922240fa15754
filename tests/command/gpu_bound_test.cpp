// What a GPU has to do at least: what is counted of a frame.
#include "bench/consoles/gpu_bound.hpp"

#include <gtest/gtest.h>

#include "bench/scenarios/scenarios.hpp"
#include "tests/run_frame.hpp"

namespace pelt {
namespace {

// The eye in the origin, towards -z.
View MakeTestView() {
  Camera camera;
  for (int i = 0; i < 3; ++i) camera.eye[i] = camera.target[i] = 0.0f;
  camera.target[2] = -1.0f;
  return MakeView(camera);
}

// Straight, 2 mm wide.
StrandCurve Straight(float x, float y, float z, float dx, float dy, float dz) {
  StrandCurve curve{};
  for (uint32_t i = 0; i < kRibbonPoints; ++i) {
    const float t = float(i) / float(kRibbonPoints - 1);
    const float point[4] = {x + t * dx, y + t * dy, z + t * dz, 0.002f};
    std::copy(point, point + 4, curve.point[i]);
  }
  return curve;
}

TEST(GpuBound, AStrandCoversItsLengthTimesItsWidth) {
  const View view = MakeTestView();
  const double px = double(view.pixels_per_unit_at_1m);
  EXPECT_NEAR(CoveredPixels(Straight(0, 0, -1, 0.1f, 0, 0), view), 0.1 * px * 0.002 * px,
              1e-3 * px);
  EXPECT_NEAR(CoveredPixels(Straight(0, 0, -1, 0.06f, 0.08f, 0), view), 0.1 * px * 0.002 * px,
              1e-3 * px);
  EXPECT_NEAR(CoveredPixels(Straight(0, 0, -2, 0.1f, 0, 0), view), 0.05 * px * 0.001 * px,
              1e-3 * px);
}

TEST(GpuBound, NothingIsCoveredAlongTheViewOrBesideIt) {
  const View view = MakeTestView();
  EXPECT_NEAR(CoveredPixels(Straight(0, 0, -1, 0, 0, -0.1f), view), 0.0, 1e-3);
  EXPECT_EQ(CoveredPixels(Straight(0, 0, 1, 0.1f, 0, 0), view), 0.0) << "behind the eye";
  EXPECT_EQ(CoveredPixels(Straight(9, 0, -1, 0.1f, 0, 0), view), 0.0);
}

TEST(GpuBound, PassesCountWhatThereIsToDraw) {
  Scenario scenario = LoadScenario("tiny");
  RunningScenario running(scenario, SceneOptions{});
  testing::RunFrame(running, 0);
  const View view = MakeView(scenario.PrepareFrame(0, running.scene()).camera);
  const std::vector<DrawPass> passes = FindDrawPasses(running.scene(), view);
  ASSERT_EQ(passes.size(), 2u);
  double made = 0, curved = 0, pieces = 0;
  for (const LayerDraw& draw : running.scene().Draws()) {
    const bool on_gpu = draw.output == Output::kInstances;
    (on_gpu ? curved : made) += draw.strand_count;
    pieces += double(draw.strand_count) * (on_gpu ? draw.pieces : 4);
  }
  ASSERT_GT(curved, 0.0);
  for (const DrawPass& pass : passes) {
    EXPECT_EQ(pass.vertices, 2 * (pieces + curved + made));
    EXPECT_EQ(pass.triangles, 2 * pieces);
  }
  EXPECT_EQ(passes[1].vertex_bytes, 64 * curved + 320 * made);
  EXPECT_EQ(passes[0].pixels, 0.0);
  EXPECT_GT(passes[1].pixels, 100.0);
}

}  // namespace
}  // namespace pelt
