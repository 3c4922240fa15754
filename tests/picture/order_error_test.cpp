// Pictures of a few hairs in right and wrong orders.
#include "tests/picture/order_error.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>

#include "tests/jobs/tiny_scene.hpp"

namespace pelt::testing {
namespace {

// The eye 1 m before the origin, on the axis z.
Camera TestCamera() {
  Camera camera;
  const float position[3] = {0.0f, 0.0f, 1.0f}, target[3] = {0.0f, 0.0f, 0.0f};
  std::copy(position, position + 3, camera.eye);
  std::copy(target, target + 3, camera.target);
  return camera;
}

// Straight and 20 mm wide.
Hair Straight(const glm::vec3& from, const glm::vec3& to, uint32_t colour) {
  Hair hair{};
  hair.knots = kRibbonPoints;
  for (uint32_t k = 0; k < hair.knots; ++k)
    hair.knot[k] = {glm::mix(from, to, float(k) / float(hair.knots - 1)), 0.02f};
  hair.base_colour = hair.tip_colour = colour;
  hair.root = from;
  hair.normal = {0.0f, 0.0f, 1.0f};
  return hair;
}

constexpr uint32_t kRed = 0xff0000ffu, kGreen = 0xff00ff00u;

// One behind the other, across each other in the picture.
std::vector<Hair> OneBehindTheOther() {
  return {Straight({-0.2f, 0.0f, -0.1f}, {0.2f, 0.0f, -0.1f}, kRed),
          Straight({0.0f, -0.2f, 0.1f}, {0.0f, 0.2f, 0.1f}, kGreen)};
}

PictureError ErrorOf(const std::vector<Hair>& hairs, const std::vector<uint32_t>& rank) {
  const HairFragments fragments(hairs, TestCamera(), 160, 120);
  return fragments.Compare(fragments.PaintByRank(rank), fragments.PaintByDepth());
}

TEST(OrderError, FarToNearIsExactWhereHairsDoNotCross) {
  const PictureError error = ErrorOf(OneBehindTheOther(), {0, 1});
  EXPECT_EQ(error.mean_square, 0.0);
  EXPECT_EQ(error.wrong_pixels, 0.0);
  EXPECT_TRUE(std::isinf(error.PsnrDb()));
}

TEST(OrderError, NearToFarIsWrongWhereTheyMeet) {
  const PictureError error = ErrorOf(OneBehindTheOther(), {1, 0});
  EXPECT_GT(error.wrong_pixels, 0.005);
  EXPECT_LT(error.wrong_pixels, 0.2) << "nowhere else";
  EXPECT_LT(error.PsnrDb(), 40.0);
}

TEST(OrderError, NoOrderIsExactForHairsThatCross) {
  const std::vector<Hair> hairs = {Straight({-0.2f, 0.0f, -0.2f}, {0.2f, 0.0f, 0.2f}, kRed),
                                   Straight({0.2f, 0.005f, -0.2f}, {-0.2f, 0.005f, 0.2f}, kGreen)};
  EXPECT_GT(ErrorOf(hairs, {0, 1}).wrong_pixels, 0.1);
  EXPECT_GT(ErrorOf(hairs, {1, 0}).wrong_pixels, 0.1);
}

TEST(OrderError, TheExactPictureDoesNotDependOnTheOrderThatHairsComeIn) {
  std::vector<Hair> hairs = OneBehindTheOther();
  const auto exact = HairFragments(hairs, TestCamera(), 160, 120).PaintByDepth();
  std::swap(hairs[0], hairs[1]);
  EXPECT_EQ(HairFragments(hairs, TestCamera(), 160, 120).PaintByDepth(), exact);
}

// What a layer's `sort_place` is chosen by: the share of `tiny`'s pixels that are wrong with each, layer by layer.
TEST(OrderError, IsMeasuredForEachSortPlace) {
  Scenario scenario = TinyScenario();
  for (const float place : {0.0f, 0.25f, 0.5f, 0.75f, 1.0f}) {
    for (LayerParams* layer : LayersOf(scenario)) layer->sort_place = place;
    RunningScenario running(scenario, {});
    RunFrame(running, 0);
    const Camera camera = scenario.PrepareFrame(0, running.scene()).camera;
    double wrong = 0.0, reversed = 0.0;
    std::printf("sort_place %.2f:", double(place));
    for (const std::vector<Hair>& hairs : ReadHairs(running.scene(), VertexOrder::kSorted)) {
      const HairFragments fragments(hairs, camera, 320, 240);
      const std::vector<glm::vec3> exact = fragments.PaintByDepth();
      std::vector<uint32_t> rank(hairs.size());
      const auto wrong_pixels = [&] {
        return fragments.Compare(fragments.PaintByRank(rank), exact).wrong_pixels;
      };
      std::iota(rank.begin(), rank.end(), 0u);
      std::printf(" %.4f", wrong_pixels());
      wrong += wrong_pixels();
      std::ranges::reverse(rank);
      reversed += wrong_pixels();
    }
    std::printf("\n");
    EXPECT_LT(wrong, reversed) << place;
  }
}

TEST(OrderError, PsnrIsTheMeanSquareInDecibels) {
  EXPECT_NEAR(PictureError{0.01}.PsnrDb(), 20.0, 1e-9);
  EXPECT_NEAR(PictureError{1e-4}.PsnrDb(), 40.0, 1e-9);
}

}  // namespace
}  // namespace pelt::testing
