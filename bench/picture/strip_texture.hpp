// The film strip as a texture: coverage of each card in 8 bits, with ever smaller levels.
//
// Invariant: a level is the mean of the one before, of each strip alone. So a strip keeps its coverage in every level,
// and none bleeds into the next.
#pragma once

#include <cstdint>
#include <vector>

namespace pelt {

class StripTexture {
 public:
  static constexpr uint32_t kWidth = 64, kHeight = 128;  // texels of a strip in level 0

  explicit StripTexture(uint32_t strips);

  uint32_t strips() const { return strips_; }
  uint32_t levels() const { return uint32_t(level_.size()); }
  // Of a level: strips side by side, rows from root to tip.
  const std::vector<uint8_t>& texels(uint32_t level) const { return level_[level]; }

  // Mixed between texels and levels, at a place of bench/shading/shaders/film_strip.glsl.
  float Sample(uint32_t strip, float across, float along, float footprint) const;

 private:
  float SampleLevel(uint32_t level, uint32_t strip, float across, float along) const;

  uint32_t strips_;
  std::vector<std::vector<uint8_t>> level_;
};

}  // namespace pelt
