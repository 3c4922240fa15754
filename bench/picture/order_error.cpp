#include "bench/picture/order_error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "bench/picture/shade_hair.hpp"
#include "bench/shading/default_look.hpp"

namespace pelt {
namespace {

constexpr glm::vec3 kGround(0.46f, 0.55f, 0.66f);
constexpr float kSeen = 2.0f / 255.0f;

// Light that grows towards the tip, no shadow.
HairEnd Knot(const Hair& hair, uint32_t k, const LightSet& light, const Projection& projection) {
  const float t = float(k) / float(hair.knots - 1);
  const float depth_light = glm::mix(kDefaultDepthFloor, 1.0f, t);
  return ShadeKnot(hair, k, light, kDefaultHair, depth_light, 1.0f, projection);
}

glm::vec3 Srgb(const glm::vec3& linear) {
  glm::vec3 out;
  for (int c = 0; c < 3; ++c) out[c] = SrgbFromLinear(Saturate(linear[c]));
  return out;
}

}  // namespace

double PictureError::PsnrDb() const {
  return mean_square > 0.0 ? -10.0 * std::log10(mean_square)
                           : std::numeric_limits<double>::infinity();
}

HairFragments::HairFragments(std::span<const Hair> hairs, const Camera& camera, uint32_t width,
                             uint32_t height)
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

template <class Before>
std::vector<glm::vec3> HairFragments::Paint(const Before& before) const {
  std::vector<glm::vec3> picture(pixels_.size(), kGround);
  std::vector<Fragment> sorted;
  for (size_t i = 0; i < pixels_.size(); ++i) {
    sorted = pixels_[i];
    std::stable_sort(sorted.begin(), sorted.end(), before);  // a hair's pieces from root to tip
    for (const Fragment& f : sorted) picture[i] = Over(f.colour, f.coverage, picture[i]);
  }
  return picture;
}

std::vector<glm::vec3> HairFragments::PaintByDepth() const {
  return Paint([](const Fragment& a, const Fragment& b) { return a.depth > b.depth; });
}

std::vector<glm::vec3> HairFragments::PaintByRank(std::span<const uint32_t> rank) const {
  return Paint([&](const Fragment& a, const Fragment& b) { return rank[a.hair] < rank[b.hair]; });
}

PictureError HairFragments::Compare(const std::vector<glm::vec3>& picture,
                                    const std::vector<glm::vec3>& exact) const {
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

}  // namespace pelt
