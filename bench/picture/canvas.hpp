// The software renderer's surface: colour and depth samples, triangles, hair segments.
//
// Within a layer hairs are painted in the order they come, over each other, as a GPU without depth
// writes would: a wrong sort shows. Between layers, and against the body, depth decides.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "bench/picture/hair_samples.hpp"
#include "bench/picture/strip_texture.hpp"
#include "core/view.hpp"

namespace pelt {

// World to samples: x and y in samples from the upper left, z the distance along the view, m.
class Projection {
 public:
  Projection(const Camera& camera, uint32_t width, uint32_t height);
  glm::vec3 Project(const glm::vec3& world) const;
  float SamplesPerMetre(float depth_m) const { return focal_ / depth_m; }
  glm::vec3 RayThrough(float x, float y) const;  // unit, world
  const glm::vec3& eye() const { return eye_; }

 private:
  glm::vec3 eye_, right_, up_, forward_;
  float focal_, centre_x_, centre_y_;
};

// A piece of a card of hairs.
struct CardPiece {
  const StripTexture* texture;
  uint32_t strip;
  float from, to;  // share of the card's length

  // What hairs cover of a sample at this share across and along the piece, where it is so many samples wide.
  float Cover(const glm::vec2& place, float width) const;
};

class Canvas {
 public:
  Canvas(uint32_t width, uint32_t height);

  uint32_t width() const { return width_; }
  uint32_t height() const { return height_; }
  // Of a square of samples.
  void SetBackground(uint32_t x, uint32_t y, uint32_t side, const glm::vec3& colour);

  // Of projected corners; shade(shares of the corners) is the colour of a place.
  template <class Shade>
  void DrawTriangle(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, Shade shade);

  // The same of one that has holes: shade is the colour, and in w how much of the place it covers.
  template <class Shade>
  void DrawCutTriangle(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, Shade shade);

  void DrawPoint(uint32_t x, uint32_t y, float depth, const glm::vec3& colour);

  // A tapering piece of a hair, painted with coverage `alpha`; of a card, if there is one.
  void DrawHair(const HairEnd& a, const HairEnd& b, float alpha, const CardPiece* card = nullptr);
  // Hairs drawn so far hide what lies behind them from now on.
  void FinishLayer();

  // Averages blocks of samples x samples into 8-bit sRGB, rows from the top.
  std::vector<uint8_t> Resolve(uint32_t samples) const;

 private:
  // visit(sample, shares of the corners, depth) for each sample of the triangle that nothing hides.
  template <class Visit>
  void ForEachSample(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, Visit visit);

  uint32_t width_, height_;
  std::vector<glm::vec3> colour_;
  std::vector<float> depth_, layer_depth_;
  uint32_t touched_from_, touched_to_ = 0;
};

template <class Visit>
void Canvas::ForEachSample(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c,
                           Visit visit) {
  const float area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  if (area == 0.0f) return;
  const auto low = [](float v) { return uint32_t(std::max(0.0f, std::floor(v))); };
  const uint32_t x0 = low(std::min({a.x, b.x, c.x})), y0 = low(std::min({a.y, b.y, c.y}));
  const float x_end = std::min(std::max({a.x, b.x, c.x}) + 1.0f, float(width_));
  const float y_end = std::min(std::max({a.y, b.y, c.y}) + 1.0f, float(height_));
  for (uint32_t y = y0; float(y) < y_end; ++y)
    for (uint32_t x = x0; float(x) < x_end; ++x) {
      const glm::vec2 s(float(x) + 0.5f, float(y) + 0.5f);
      const float u = ((c.x - b.x) * (s.y - b.y) - (c.y - b.y) * (s.x - b.x)) / area;
      const float v = ((a.x - c.x) * (s.y - c.y) - (a.y - c.y) * (s.x - c.x)) / area;
      const glm::vec3 on_screen(u, v, 1.0f - u - v);
      if (u < 0.0f || v < 0.0f || on_screen.z < 0.0f) continue;
      // What is even in the world is even on the screen by the depth's reciprocal.
      const glm::vec3 nearness = on_screen / glm::vec3(a.z, b.z, c.z);
      const float depth = 1.0f / (nearness.x + nearness.y + nearness.z);
      const size_t i = size_t(y) * width_ + x;
      if (depth >= depth_[i]) continue;
      visit(i, nearness * depth, depth);
    }
}

template <class Shade>
void Canvas::DrawTriangle(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, Shade shade) {
  ForEachSample(a, b, c, [&](size_t i, const glm::vec3& bary, float depth) {
    depth_[i] = depth;
    colour_[i] = shade(bary);
  });
}

template <class Shade>
void Canvas::DrawCutTriangle(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c,
                             Shade shade) {
  ForEachSample(a, b, c, [&](size_t i, const glm::vec3& bary, float depth) {
    const glm::vec4 colour = shade(bary);
    if (colour.w <= 0.0f) return;
    depth_[i] = depth;
    colour_[i] = glm::mix(colour_[i], glm::vec3(colour), colour.w);
  });
}

inline glm::vec3 VecOf(const float* v) { return {v[0], v[1], v[2]}; }

// Linear light of sRGB bytes.
glm::vec3 LinearColour(uint32_t aabbggrr);

}  // namespace pelt
