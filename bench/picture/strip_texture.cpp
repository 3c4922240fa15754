#include "bench/picture/strip_texture.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "bench/shading/shading.hpp"

namespace pelt {
namespace {

constexpr int kLookMeaning = 1 + int(StrandChannels::kLook);

uint8_t StripByte(float coverage) { return uint8_t(255.0f * coverage + 0.5f); }

}  // namespace

StripTexture::StripTexture(uint32_t strips) : strips_(strips) {
  std::vector<float> values(size_t(strips) * width_ * height_);
  for (uint32_t y = 0; y < height_; ++y)
    for (uint32_t x = 0; x < strips * width_; ++x) {
      constexpr int kRows = 4;  // looked at within a texel
      float sum = 0.0f;
      for (int row = 0; row < kRows; ++row)
        sum += StripCoverage(x / width_, (float(x % width_) + 0.5f) / float(width_),
                             (float(y) + (float(row) + 0.5f) / float(kRows)) / float(height_),
                             1.0f / float(width_));
      values[size_t(y) * strips * width_ + x] = sum / float(kRows);
    }
  MakeLevels(std::move(values));
}

StripTexture::StripTexture(const StrandTexture& artists)
    : strips_(artists.strips),
      width_(artists.width / artists.strips),
      height_(artists.height),
      meaning_(1 + int(artists.channels)),
      level_{artists.rgba} {
  const uint32_t width = std::bit_ceil(width_), height = std::bit_ceil(height_);
  std::vector<float> values;
  for (uint32_t y = 0; y < height; ++y)
    for (uint32_t x = 0; x < strips_ * width; ++x)
      for (uint32_t c = 0; c < 4; ++c)
        values.push_back(SampleLevel(0, x / width, (float(x % width) + 0.5f) / float(width),
                                     (float(y) + 0.5f) / float(height), c));
  width_ = width;
  height_ = height;
  level_.clear();
  MakeLevels(std::move(values));
}

void StripTexture::MakeLevels(std::vector<float> values) {
  const uint32_t parts = channels();
  for (uint32_t level = 0;; ++level) {
    std::vector<uint8_t>& bytes = level_.emplace_back(values.size());
    std::ranges::transform(values, bytes.begin(), StripByte);
    if (width(level) == 1) return;
    const size_t row = size_t(strips_) * width(level) * parts;
    const size_t next = height(level) > 1 ? row : 0;  // a row that is the last stands for both
    std::vector<float> half;
    for (uint32_t y = 0; y < height(level + 1); ++y)
      for (uint32_t x = 0; x < strips_ * width(level + 1); ++x) {
        const float* a = &values[2 * (y * next + x * parts)];
        const float *b = a + parts, *c = a + next, *d = c + parts;
        const float covered = meaning_ == kLookMeaning ? a[3] + b[3] + c[3] + d[3] : 0.0f;
        for (uint32_t i = 0; i < parts; ++i)
          half.push_back(i < 3 && covered > 0.0f
                             ? (a[i] * a[3] + b[i] * b[3] + c[i] * c[3] + d[i] * d[3]) / covered
                             : 0.25f * (a[i] + b[i] + c[i] + d[i]));
      }
    values = std::move(half);
  }
}

float StripTexture::SampleLevel(uint32_t level, uint32_t strip, float across, float along,
                                uint32_t channel) const {
  const int width = int(this->width(level)), height = int(this->height(level));
  const float x = across * float(width) - 0.5f, y = along * float(height) - 0.5f;
  const int column = int(std::floor(x)), row = int(std::floor(y));
  const auto texel = [&](int i, int j) {
    const size_t at = size_t(std::clamp(j, 0, height - 1)) * strips_ + strip;
    const size_t place = at * size_t(width) + size_t(std::clamp(i, 0, width - 1));
    return float(level_[level][place * channels() + channel]);
  };
  const auto mix = [](float a, float b, float share) { return a + (b - a) * share; };
  const float u = x - float(column), v = y - float(row);
  return mix(mix(texel(column, row), texel(column + 1, row), u),
             mix(texel(column, row + 1), texel(column + 1, row + 1), u), v) /
         255.0f;
}

float StripTexture::Sample(uint32_t strip, float across, float along, float footprint,
                           uint32_t channel) const {
  const float last = float(levels() - 1);
  const float level = std::clamp(std::log2(footprint * float(width_)), 0.0f, last);
  const uint32_t low = uint32_t(level), own = std::min(strip, strips_ - 1);
  const float fine = SampleLevel(low, own, across, along, channel);
  if (float(low) == level) return fine;
  const float coarse = SampleLevel(low + 1, own, across, along, channel);
  return fine + (coarse - fine) * (level - float(low));
}

glm::vec4 StripTexture::Texel(uint32_t strip, float across, float along, float footprint) const {
  glm::vec4 texel(0.0f);
  for (uint32_t c = 0; c < channels(); ++c)
    texel[int(c)] = Sample(strip, across, along, footprint, c);
  return texel;
}

float StripTexture::CoverAt(uint32_t strip, float along, const glm::vec2& wet_dirty) const {
  return TexelCover(meaning_, Texel(strip, 0.5f, along, 1.0f), wet_dirty);
}

}  // namespace pelt
