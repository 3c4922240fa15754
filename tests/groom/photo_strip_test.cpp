// A strand texture out of a photograph: hairs are straight and reach from root to tip.
#include "core/groom/photo_strip.hpp"

#include <gtest/gtest.h>

#include "tests/error_from.hpp"

namespace pelt::test {
namespace {

// Two pieces of 40 x 60: a hair of 6 texels that leans by 0.25 a row from row 0 on, and one that leans back by 0.5, from
// row 10 to 49, of half the alpha in its lower half.
ControlMap MakePhoto() {
  ControlMap photo{80, 60, std::vector<uint8_t>(size_t(80) * 60 * 4, 0)};
  const auto put = [&](uint32_t from, uint32_t y, uint8_t alpha) {
    for (uint32_t x = from; x < from + 6; ++x) photo.rgba[(size_t(y) * 80 + x) * 4 + 3] = alpha;
  };
  for (uint32_t y = 0; y < 60; ++y) put(8 + y / 4, y, 255);
  for (uint32_t y = 10; y < 50; ++y) put(70 - y / 2, y, y < 30 ? 255 : 128);
  return photo;
}

TEST(PhotoStrip, HairsAreStraightFromRootToTip) {
  const StrandTexture strip = CutStrips(MakePhoto(), 2, "photo.png");
  ASSERT_EQ(strip.strips, 2u);
  ASSERT_EQ(strip.width, 16u) << "6 texels of each, rounded up";
  ASSERT_EQ(strip.height, 64u);
  EXPECT_EQ(FindBadStrandTexture(strip, {}), "");
  for (uint32_t y = 0; y < strip.height; ++y)
    for (uint32_t x = 0; x < strip.width; ++x) {
      const uint8_t* texel = &strip.rgba[(size_t(y) * strip.width + x) * 4];
      const double alpha = x < 8 || y < 32 ? 255.0 : 128.0, edge = x % 8 % 7 ? 1.0 : 0.875;
      EXPECT_EQ(texel[0], 0u);
      EXPECT_NEAR(texel[3], alpha * edge, 1.0) << "the hair fills its strip: " << x << ", " << y;
    }
}

TEST(PhotoStrip, AnEmptyPieceIsNamed) {
  const auto fault = [](uint32_t strips) {
    return ErrorFrom([&] { CutStrips(MakePhoto(), strips, "photo.png"); });
  };
  EXPECT_EQ(fault(2), "");
  EXPECT_NE(fault(20).find("nothing in piece 1 of 20, columns 0 to 3"), std::string::npos)
      << fault(20);
  EXPECT_NE(fault(0).find("1 to 256"), std::string::npos);
  EXPECT_NE(fault(81).find("81 strips"), std::string::npos);
}

}  // namespace
}  // namespace pelt::test
