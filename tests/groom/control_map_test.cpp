// Control maps: decoding PNG, sampling against a double-precision reference, and hostile pictures.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "core/groom/fur_setup.hpp"
#include "tests/error_from.hpp"
#include "tests/groom/png.hpp"

namespace pelt::test {
namespace {

ControlMap DrawMap(uint32_t width, uint32_t height, uint32_t seed) {
  ControlMap map{width, height, std::vector<uint8_t>(size_t(width) * height * 4)};
  std::mt19937 random(seed);
  for (uint8_t& byte : map.rgba) byte = uint8_t(random());
  return map;
}

// The obvious definition: texel centres at (i + 0.5) / size, repeating.
double SampleSlowly(const ControlMap& map, double u, double v, int channel,
                    std::array<Wrap, 2> wraps = {}) {
  const double x = u * map.width - 0.5, y = v * map.height - 0.5;
  const double x0 = std::floor(x), y0 = std::floor(y);
  const auto texel = [&](double column, double row) {
    const auto wrap = [](double place, int64_t size, Wrap how) {
      if (how == Wrap::kClamp) return std::clamp(int64_t(place), int64_t(0), size - 1);
      const int64_t turn = how == Wrap::kMirror ? 2 * size : size;
      const int64_t i = (int64_t(place) % turn + turn) % turn;
      return i < size ? i : turn - 1 - i;
    };
    return double(map.rgba[size_t(wrap(row, map.height, wraps[1]) * map.width +
                                  wrap(column, map.width, wraps[0])) *
                               4 +
                           size_t(channel)]);
  };
  const double fx = x - x0, fy = y - y0;
  return (texel(x0, y0) * (1 - fx) * (1 - fy) + texel(x0 + 1, y0) * fx * (1 - fy) +
          texel(x0, y0 + 1) * (1 - fx) * fy + texel(x0 + 1, y0 + 1) * fx * fy) /
         255.0;
}

TEST(ControlMap, SamplesLikeItsReference) {
  std::mt19937 random(5);
  for (const auto& [width, height] : {std::pair{1u, 1u}, {1u, 7u}, {5u, 3u}, {64u, 32u}}) {
    const ControlMap map = DrawMap(width, height, width + height);
    for (int i = 0; i < 2000; ++i) {
      const glm::vec2 uv{float(random() % 4000001) / 1e6f - 2.0f,
                         float(random() % 4000001) / 1e6f - 2.0f};
      const int channel = int(random() % 4);
      // A float coordinate of 2 is good to 2^-22 turns, 64 texels to 2^-16: hence the tolerance.
      EXPECT_NEAR(map.Sample(uv, channel), SampleSlowly(map, double(uv.x), double(uv.y), channel),
                  3e-5)
          << width << "x" << height << " at " << uv.x << ", " << uv.y;
    }
  }
}

TEST(ControlMap, GoesOnBeyondItsEdgesAsItIsTold) {
  std::mt19937 random(6);
  constexpr Wrap kWraps[] = {Wrap::kRepeat, Wrap::kMirror, Wrap::kClamp};
  for (const auto& [width, height] : {std::pair{1u, 1u}, {1u, 7u}, {5u, 3u}, {64u, 32u}}) {
    const ControlMap map = DrawMap(width, height, width + height);
    for (int i = 0; i < 3000; ++i) {
      const std::array<Wrap, 2> wrap{kWraps[random() % 3], kWraps[random() % 3]};
      const glm::vec2 uv{float(random() % 6000001) / 1e6f - 3.0f,
                         float(random() % 6000001) / 1e6f - 3.0f};
      const int channel = int(random() % 4);
      EXPECT_NEAR(map.Sample(uv, channel, wrap),
                  SampleSlowly(map, double(uv.x), double(uv.y), channel, wrap), 6e-5)
          << width << "x" << height << " at " << uv.x << ", " << uv.y << " wraps " << int(wrap[0])
          << int(wrap[1]);
    }
  }
}

TEST(ControlMap, StaysInsideForAnyCoordinate) {
  const ControlMap map = DrawMap(3, 5, 9);
  const float values[] = {0.0f, -0.0f, 1.0f,  -1.0f,  -1e-9f,   -1e-30f,   0.99999994f,
                          1e9f, -1e9f, 3e38f, -3e38f, INFINITY, -INFINITY, NAN};
  for (float u : values) {
    for (float v : values) {
      for (const Wrap wrap : {Wrap::kRepeat, Wrap::kMirror, Wrap::kClamp}) {
        const float sample = map.Sample({u, v}, 2, {wrap, wrap});
        EXPECT_TRUE(sample >= 0.0f && sample <= 1.0f) << u << ", " << v;
      }
    }
  }
  EXPECT_EQ(ControlMap{}.Sample({0.5f, 0.5f}, 0), 1.0f);
}

TEST(ControlMap, ReadsPngOfEveryChannelCount) {
  const std::vector<uint8_t> grey{0, 64, 128, 255};
  const ControlMap a = ReadControlMap(MakePng(2, 2, 1, grey), "grey.png");
  ASSERT_EQ(a.width, 2u);
  ASSERT_EQ(a.height, 2u);
  EXPECT_EQ(a.rgba, (std::vector<uint8_t>{0, 0, 0, 255, 64, 64, 64, 255, 128, 128, 128, 255, 255,
                                          255, 255, 255}));
  const ControlMap b = ReadControlMap(MakePng(1, 2, 3, {1, 2, 3, 4, 5, 6}), "rgb.png");
  EXPECT_EQ(b.rgba, (std::vector<uint8_t>{1, 2, 3, 255, 4, 5, 6, 255}));
  // The first row is the top one: v runs downwards, as glTF's.
  EXPECT_EQ(b.Sample({0.5f, 0.25f}, 1), 2.0f / 255.0f);
  const ControlMap c = ReadControlMap(MakePng(1, 1, 4, {9, 8, 7, 6}), "rgba.png");
  EXPECT_EQ(c.rgba, (std::vector<uint8_t>{9, 8, 7, 6}));
}

std::string PngError(const std::vector<uint8_t>& png) {
  return ErrorFrom([&] { ReadControlMap(png, "x.png"); });
}

TEST(ControlMap, RefusesWhatIsNoPicture) {
  EXPECT_NE(PngError({}).find("x.png"), std::string::npos);
  EXPECT_NE(PngError({'G', 'I', 'F', '8', '9', 'a'}).find("a GIF picture, not a PNG"),
            std::string::npos);
  EXPECT_NE(PngError({'R', 'I', 'F', 'F', 9, 0, 0, 0, 'W', 'E', 'B', 'P'}).find("a WebP picture"),
            std::string::npos);
  auto huge = MakePng(1, 1, 4, {1, 2, 3, 4});
  huge[16] = 0x7f;  // width
  EXPECT_NE(PngError(huge).find("8192"), std::string::npos);
  auto wide = MakePng(9000, 1, 1, std::vector<uint8_t>(9000));
  EXPECT_NE(PngError(wide).find("8192"), std::string::npos);
  EXPECT_EQ(PngError(MakePng(8192, 1, 1, std::vector<uint8_t>(8192))), "");
  EXPECT_THROW(ReadControlMapFile("/nowhere/at/all.png"), Error);
  EXPECT_THROW(ReadControlMapFile("/"), Error);
}

TEST(ControlMap, DamagedPicturesNeverCrash) {
  std::vector<uint8_t> pixels(16 * 16 * 4);
  std::mt19937 random(77);
  for (uint8_t& byte : pixels) byte = uint8_t(random());
  const auto good = MakePng(16, 16, 4, pixels);
  ASSERT_EQ(PngError(good), "");
  int refused = 0;
  for (int i = 0; i < 4000; ++i) {
    auto bad = good;
    const size_t kind = random() % 3;
    if (kind == 0) bad.resize(random() % bad.size());
    for (size_t n = kind == 1 ? 1 : 4; kind != 0 && n > 0; --n) {
      // Mostly the headers, where it hurts.
      bad[random() % (kind == 1 ? 64 : bad.size())] = uint8_t(random());
    }
    refused += !PngError(bad).empty();
  }
  EXPECT_GT(refused, 1000);
}

}  // namespace
}  // namespace pelt::test
