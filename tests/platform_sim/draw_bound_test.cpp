// The GPUs' lower bounds against what was worked out by hand.
#include "platform_sim/gpu/draw_bound.hpp"

#include <gtest/gtest.h>

namespace pelt {
namespace {

constexpr GpuParameters kXenos = {};

// The cast's 59,279 drawn strands: eight pieces each, six in the shadow map.
DrawPass CastStrands() {
  return {"strands", 59279.0 * 18, 59279.0 * 18 * 100, 59279.0 * 16,
          203e3,     203e3 * 10,   59279.0 * 64};
}
DrawPass CastShadows() {
  return {"shadow map", 59279.0 * 14, 59279.0 * 14 * 45, 59279.0 * 12, 0.0, 0.0, 59279.0 * 64};
}

TEST(DrawBound, XenosHasTheCastInSixMilliseconds) {
  const DrawBound strands = BoundPass(kXenos, CastStrands()),
                  shadows = BoundPass(kXenos, CastShadows());
  EXPECT_NEAR(strands.at_least_ms + shadows.at_least_ms, 6.1, 0.1);
  EXPECT_NEAR(strands.ms[size_t(GpuUnit::kSetup)] + shadows.ms[size_t(GpuUnit::kSetup)], 3.3, 0.05);
  EXPECT_EQ(strands.binds, GpuUnit::kVertexShaders);
  EXPECT_EQ(shadows.binds, GpuUnit::kVertexShaders);
  EXPECT_EQ(strands.ms[size_t(GpuUnit::kVertexShaders)], strands.ms[size_t(GpuUnit::kPixelShaders)])
      << "they share their units";
}

// Why EyePet's vertices were made by SPUs.
TEST(DrawBound, RsxWouldTakeSixTimesAsLong) {
  const DrawBound strands = BoundPass(kRsx, CastStrands()),
                  shadows = BoundPass(kRsx, CastShadows());
  EXPECT_NEAR(strands.at_least_ms + shadows.at_least_ms, 36.0, 0.2);
  EXPECT_EQ(strands.binds, GpuUnit::kVertexShaders);
  EXPECT_EQ(strands.ms[size_t(GpuUnit::kSetup)], 0.0) << "no number is known";
}

TEST(DrawBound, RibbonsThatSpusMadeAreBoundByBlending) {
  // 8,000 ribbons of ten vertices; 1.3 million pixels, drawn at two samples.
  const DrawPass pass{"strands", 8e4, 8e4 * 30, 6.4e4, 2.6e6, 2.6e6 * 10, 8e4 * 32};
  const DrawBound bound = BoundPass(kRsx, pass);
  EXPECT_NEAR(bound.ms[size_t(GpuUnit::kVertexShaders)], 0.6, 0.01);
  EXPECT_NEAR(bound.ms[size_t(GpuUnit::kMemory)], 1.5, 0.01);
  EXPECT_EQ(bound.at_least_ms,
            std::max(bound.ms[size_t(GpuUnit::kMemory)], bound.ms[size_t(GpuUnit::kPixelShaders)]));
}

TEST(DrawBound, EachUnitBindsWhereItHasMostToDo) {
  const auto binds = [](const DrawPass& pass) { return BoundPass(kRsx, pass).binds; };
  EXPECT_EQ(binds({.name = "v", .vertex_instructions = 1e6}), GpuUnit::kVertexShaders);
  EXPECT_EQ(binds({.name = "p", .pixel_instructions = 1e6}), GpuUnit::kPixelShaders);
  EXPECT_EQ(binds({.name = "m", .vertex_bytes = 1e6}), GpuUnit::kMemory);
  EXPECT_EQ(BoundPass(kXenos, {.name = "t", .triangles = 1e6}).binds, GpuUnit::kSetup);
  EXPECT_EQ(BoundPass(kXenos, {.name = "b", .pixels = 1e6}).binds, GpuUnit::kBlending);
  EXPECT_EQ(BoundPass(kRsx, {.name = "nothing"}).at_least_ms, 0.0);
}

}  // namespace
}  // namespace pelt
