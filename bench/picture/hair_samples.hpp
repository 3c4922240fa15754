// Which samples of a picture a piece of a hair covers: what every way to paint hairs, and to judge their order, has
// in common.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>

namespace pelt {

// One end of a piece of a hair.
struct HairEnd {
  glm::vec3 at;      // projected: samples from the upper left, and the distance along the view, m
  glm::vec3 colour;  // linear
  float width;       // samples
};

// Whole samples of a picture, the last ones not included.
struct SampleBox {
  uint32_t x0, y0, x1, y1;
};

// Calls visit(x, y, depth, colour, coverage, place) for every sample whose nearest point of the piece is closer than half the
// width there, at least half a sample: thinner hairs are as wide, with less coverage. `place` is the share across the
// hair and along the piece. Returns the samples that were
// looked at, none where the piece is beside the picture.
template <class Visit>
SampleBox ForEachHairSample(const HairEnd& a, const HairEnd& b, uint32_t width, uint32_t height,
                            const Visit& visit) {
  const glm::vec2 p = a.at, along = glm::vec2(b.at) - p;
  const float length2 = std::max(glm::dot(along, along), 1e-12f);
  const float reach = 0.5f * std::max({a.width, b.width, 1.0f});
  const float left = std::min(a.at.x, b.at.x) - reach, right = std::max(a.at.x, b.at.x) + reach;
  const float top = std::min(a.at.y, b.at.y) - reach, bottom = std::max(a.at.y, b.at.y) + reach;
  if (right < 0.0f || bottom < 0.0f || left >= float(width) || top >= float(height)) return {};
  const SampleBox box{uint32_t(std::max(left, 0.0f)), uint32_t(std::max(top, 0.0f)),
                      std::min(uint32_t(right) + 1, width), std::min(uint32_t(bottom) + 1, height)};
  for (uint32_t y = box.y0; y < box.y1; ++y)
    for (uint32_t x = box.x0; x < box.x1; ++x) {
      const glm::vec2 s = glm::vec2(float(x) + 0.5f, float(y) + 0.5f) - p;
      const float t = glm::dot(s, along) / length2;
      if (t < 0.0f || t >= 1.0f) continue;  // the neighbouring piece has it
      const glm::vec2 off = s - along * t;
      const float wide = a.width + (b.width - a.width) * t;
      const float half = 0.5f * std::max(wide, 1.0f);
      if (glm::dot(off, off) > half * half) continue;
      const float beside = (along.x * off.y - along.y * off.x) / std::sqrt(length2);
      visit(x, y, a.at.z + (b.at.z - a.at.z) * t, glm::mix(a.colour, b.colour, t),
            std::min(wide, 1.0f), glm::vec2(0.5f + 0.5f * beside / half, t));
    }
  return box;
}

}  // namespace pelt
