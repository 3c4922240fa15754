// What an order of drawing hairs costs in the picture: hairs painted over each other one by one, against the same with
// every pixel's fragments by their own depth, as no order of whole hairs can have them where hairs cross.
//
// One sample per pixel, hair alone before a plain ground, without shadows: nothing but the order differs.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "bench/picture/hairs.hpp"
#include "core/view.hpp"

namespace pelt {

// Of one picture against another, in sRGB.
struct PictureError {
  double mean_square = 0.0;   // of all channels, 0 to 1
  double wrong_pixels = 0.0;  // share of those that hair covers, off by more than 2 of 255

  // Infinite for the same picture.
  double PsnrDb() const;
};

class HairFragments {
 public:
  // `hairs` in any order; rasterises them once.
  HairFragments(std::span<const Hair> hairs, const Camera& camera, uint32_t width, uint32_t height);

  // Linear colours, rows from the top.
  std::vector<glm::vec3> PaintByDepth() const;
  // `rank` of each hair: the lowest is painted first. Ranks are different.
  std::vector<glm::vec3> PaintByRank(std::span<const uint32_t> rank) const;

  PictureError Compare(const std::vector<glm::vec3>& picture,
                       const std::vector<glm::vec3>& exact) const;

 private:
  struct Fragment {
    uint32_t hair;
    float depth, coverage;
    glm::vec3 colour;
  };
  template <class Before>
  std::vector<glm::vec3> Paint(const Before& before) const;

  std::vector<std::vector<Fragment>> pixels_;
};

}  // namespace pelt
