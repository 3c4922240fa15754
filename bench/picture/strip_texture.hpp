// The film strip as a texture: Pelt's own silhouettes, of which the coverage is known, or an artist's, with ever smaller
// levels.
//
// Invariant: a level is the mean of the one before, of each strip alone. So a strip keeps its coverage in every level,
// and none bleeds into the next. What an artist's "look" has beside coverage is the mean of what is covered.
#pragma once

#include <algorithm>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "core/groom/strand_texture.hpp"

namespace pelt {

class StripTexture {
 public:
  static constexpr uint32_t kWidth = 64, kHeight = 128;  // texels of a strip of Pelt's own

  // Pelt's own.
  explicit StripTexture(uint32_t strips);
  // The artist's, whose sides are stretched to the next powers of two.
  explicit StripTexture(const StrandTexture& artists);

  uint32_t strips() const { return strips_; }
  uint32_t levels() const { return uint32_t(level_.size()); }
  uint32_t width(uint32_t level) const { return width_ >> level; }  // of a strip
  uint32_t height(uint32_t level) const { return std::max(height_ >> level, 1u); }
  uint32_t channels() const { return meaning_ ? 4 : 1; }  // of a texel, a byte each
  // What they are: bench/shading/shaders/strand_texture.glsl.
  int meaning() const { return meaning_; }
  // Of a level: strips side by side, rows from root to tip.
  const std::vector<uint8_t>& texels(uint32_t level) const { return level_[level]; }

  // A channel mixed between texels and levels, at a place of bench/shading/shaders/film_strip.glsl.
  float Sample(uint32_t strip, float across, float along, float footprint,
               uint32_t channel = 0) const;
  // All of them.
  glm::vec4 Texel(uint32_t strip, float across, float along, float footprint) const;
  // What is covered of the whole width, of a strand that is so wet and so dirty.
  float CoverAt(uint32_t strip, float along, const glm::vec2& wet_dirty) const;

 private:
  void MakeLevels(std::vector<float> values);
  float SampleLevel(uint32_t level, uint32_t strip, float across, float along,
                    uint32_t channel) const;

  uint32_t strips_, width_ = kWidth, height_ = kHeight;
  int meaning_ = 0;
  std::vector<std::vector<uint8_t>> level_;
};

}  // namespace pelt
