#include "bench/picture/strip_texture.hpp"

#include <algorithm>
#include <cmath>

#include "bench/shading/shading.hpp"

namespace pelt {
namespace {

uint8_t StripByte(float coverage) { return uint8_t(255.0f * coverage + 0.5f); }

}  // namespace

StripTexture::StripTexture(uint32_t strips) : strips_(strips) {
  uint32_t width = kWidth, height = kHeight;
  std::vector<float> values(size_t(strips) * width * height);
  for (uint32_t y = 0; y < height; ++y)
    for (uint32_t x = 0; x < strips * width; ++x) {
      constexpr int kRows = 4;  // looked at within a texel
      float sum = 0.0f;
      for (int row = 0; row < kRows; ++row)
        sum += StripCoverage(x / width, (float(x % width) + 0.5f) / float(width),
                             (float(y) + (float(row) + 0.5f) / float(kRows)) / float(height),
                             1.0f / float(width));
      values[size_t(y) * strips * width + x] = sum / float(kRows);
    }
  for (;;) {
    std::vector<uint8_t>& bytes = level_.emplace_back(values.size());
    std::ranges::transform(values, bytes.begin(), StripByte);
    if (width == 1) return;
    width /= 2;
    height /= 2;
    std::vector<float> half(size_t(strips) * width * height);
    for (uint32_t y = 0; y < height; ++y)
      for (uint32_t x = 0; x < strips * width; ++x) {
        const float* from = &values[size_t(y) * strips * width * 4 + 2 * x];
        const float* below = from + size_t(strips) * width * 2;
        half[size_t(y) * strips * width + x] = 0.25f * (from[0] + from[1] + below[0] + below[1]);
      }
    values = std::move(half);
  }
}

float StripTexture::SampleLevel(uint32_t level, uint32_t strip, float across, float along) const {
  const int width = int(kWidth >> level), height = int(kHeight >> level);
  const float x = across * float(width) - 0.5f, y = along * float(height) - 0.5f;
  const int column = int(std::floor(x)), row = int(std::floor(y));
  const auto texel = [&](int i, int j) {
    const size_t at = size_t(std::clamp(j, 0, height - 1)) * strips_ + strip;
    return float(level_[level][at * size_t(width) + size_t(std::clamp(i, 0, width - 1))]);
  };
  const auto mix = [](float a, float b, float share) { return a + (b - a) * share; };
  const float u = x - float(column), v = y - float(row);
  return mix(mix(texel(column, row), texel(column + 1, row), u),
             mix(texel(column, row + 1), texel(column + 1, row + 1), u), v) /
         255.0f;
}

float StripTexture::Sample(uint32_t strip, float across, float along, float footprint) const {
  const float last = float(levels() - 1);
  const float level = std::clamp(std::log2(footprint * float(kWidth)), 0.0f, last);
  const uint32_t low = uint32_t(level);
  const float fine = SampleLevel(low, strip, across, along);
  if (float(low) == level) return fine;
  const float coarse = SampleLevel(low + 1, strip, across, along);
  return fine + (coarse - fine) * (level - float(low));
}

}  // namespace pelt
