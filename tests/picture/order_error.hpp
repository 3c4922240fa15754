// What an order of drawing hairs costs in the picture: hairs painted over each other one by one, against the same with
// every pixel's fragments by their own depth, as no order of whole hairs can have them where hairs cross.
//
// One sample per pixel, hair alone before a plain ground, without shadows: nothing but the order differs.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <span>
#include <vector>

#include "bench/picture/canvas.hpp"
#include "bench/picture/hairs.hpp"
#include "bench/shading/default_look.hpp"
#include "core/view.hpp"

namespace pelt::testing {

// Of one picture against another, in sRGB.
struct PictureError {
  double mean_square = 0.0;   // of all channels, 0 to 1
  double wrong_pixels = 0.0;  // share of those that hair covers, off by more than 2 of 255

  // Infinite for the same picture.
  double PsnrDb() const {
    return mean_square > 0.0 ? -10.0 * std::log10(mean_square)
                             : std::numeric_limits<double>::infinity();
  }
};

class HairFragments {
 public:
  // `hairs` in any order; rasterises them once.
  HairFragments(std::span<const Hair> hairs, const Camera& camera, uint32_t width, uint32_t height)
      : pixels_(size_t(width) * height) {
    const Projection projection(camera, width, height);
    const LightSet light = DefaultLights();
    for (uint32_t h = 0; h < hairs.size(); ++h) {
      HairEnd last = Knot(hairs[h], 0, light, projection);
      for (uint32_t k = 1; k < hairs[h].knots; ++k) {
        const HairEnd end = Knot(hairs[h], k, light, projection);
        ForEachHairSample(last, end, width, height,
                          [&](uint32_t x, uint32_t y, float depth, const glm::vec3& colour,
                              float coverage, const glm::vec2&) {
                            pixels_[size_t(y) * width + x].push_back(
                                {h, depth, coverage * hairs[h].Alpha(), colour});
                          });
        last = end;
      }
    }
  }

  // Linear colours, rows from the top.
  std::vector<glm::vec3> PaintByDepth() const {
    return Paint([](const Fragment& a, const Fragment& b) { return a.depth > b.depth; });
  }
  // `rank` of each hair: the lowest is painted first. Ranks are different.
  std::vector<glm::vec3> PaintByRank(std::span<const uint32_t> rank) const {
    return Paint([&](const Fragment& a, const Fragment& b) { return rank[a.hair] < rank[b.hair]; });
  }

  PictureError Compare(const std::vector<glm::vec3>& picture,
                       const std::vector<glm::vec3>& exact) const {
    constexpr float kSeen = 2.0f / 255.0f;
    double squares = 0.0, covered = 0.0, wrong = 0.0;
    for (size_t i = 0; i < pixels_.size(); ++i) {
      if (pixels_[i].empty()) continue;
      const glm::vec3 off = glm::abs(Srgb(picture[i]) - Srgb(exact[i]));
      squares += double(glm::dot(off, off));
      covered += 1.0;
      wrong += std::max({off.x, off.y, off.z}) > kSeen;
    }
    return {squares / (3.0 * double(pixels_.size())), covered > 0.0 ? wrong / covered : 0.0};
  }

 private:
  struct Fragment {
    uint32_t hair;
    float depth, coverage;
    glm::vec3 colour;
  };

  // Light that grows towards the tip, no shadow.
  static HairEnd Knot(const Hair& hair, uint32_t k, const LightSet& light,
                      const Projection& projection) {
    const float t = float(k) / float(hair.knots - 1);
    const float depth_light = glm::mix(kDefaultDepthFloor, 1.0f, t);
    return ShadeKnot(hair, k, light, kDefaultHair, depth_light, 1.0f, projection);
  }

  static glm::vec3 Srgb(const glm::vec3& linear) {
    glm::vec3 out;
    for (int c = 0; c < 3; ++c) out[c] = SrgbFromLinear(Saturate(linear[c]));
    return out;
  }

  template <class Before>
  std::vector<glm::vec3> Paint(const Before& before) const {
    constexpr glm::vec3 kGround(0.46f, 0.55f, 0.66f);
    std::vector<glm::vec3> picture(pixels_.size(), kGround);
    std::vector<Fragment> sorted;
    for (size_t i = 0; i < pixels_.size(); ++i) {
      sorted = pixels_[i];
      std::stable_sort(sorted.begin(), sorted.end(), before);  // a hair's pieces from root to tip
      for (const Fragment& f : sorted) picture[i] = Over(f.colour, f.coverage, picture[i]);
    }
    return picture;
  }

  std::vector<std::vector<Fragment>> pixels_;
};

}  // namespace pelt::testing
