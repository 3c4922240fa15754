// The software renderer's surface: colour and depth samples, triangles, hair segments.
//
// Within a layer hairs are painted in the order they come, over each other, as a GPU without depth
// writes would: a wrong sort shows. Between layers, and against the body, depth decides.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <vector>

#include "bench/picture/strip_texture.hpp"
#include "core/view.hpp"

namespace pelt {

// Which samples of a picture a triangle covers, four of a row at once: what time software spends on triangles it
// spends here, and most of the samples are hidden or outside.
//
// Invariant: which samples, their shares and their depth are the same bits whichever samples are left out. A row's ends
// are found by the edges' slopes, wider than rounding can be wrong; each sample between them is judged by itself.

class TriangleSamples {
 public:
  // Of projected corners: samples from the upper left, and the distance along the view, m.
  TriangleSamples(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, uint32_t width,
                  uint32_t height)
      : a_(a), b_(b), c_(c), width_(width) {
    constexpr float kWrong = 4e-6f;  // more than a depth between the corners' may be rounded
    nearest_ = std::min({a.z, b.z, c.z}) * (1.0f - kWrong);
    area_ = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    const glm::vec2 low(std::min({a.x, b.x, c.x}), std::min({a.y, b.y, c.y}));
    const glm::vec2 high(std::max({a.x, b.x, c.x}), std::max({a.y, b.y, c.y}));
    x0_ = First(low.x, width);
    x1_ = Last(high.x, width);
    y0_ = First(low.y, height);
    y1_ = area_ == 0.0f ? y0_ : Last(high.y, height);
    const glm::vec2 extent = high - low + 1.0f;
    const float wrong = 4e-6f * extent.x * extent.y;
    const float far = 1e-6f * (std::abs(low.x) + std::abs(high.x)) + 0.01f;
    edge_[0] = MakeEdge(b, c, wrong, far);
    edge_[1] = MakeEdge(c, a, wrong, far);
    edge_[2] = MakeEdge(a, b, wrong, far);
  }

  // `depth` of the picture's samples, rows from the top. visit(x, y, depth, nearness) for each sample that is covered
  // and no nearer yet, and whose depth `seen(x, y, depth)` wants; nearness times depth are the shares of the corners.
  template <class Seen, class Visit>
  void ForEach(const std::vector<float>& depth, const Seen& seen, const Visit& visit) const {
    for (uint32_t y = y0_; y < y1_; ++y) {
      const Row row = FindRow(y);
      const float* const row_depth = &depth[size_t(y) * width_];
      for (uint32_t x = row.from; x < row.to; x += kLanes) {
        const uint32_t count = std::min(kLanes, row.to - x);
        Lanes lanes;
        if (IsHidden(row_depth + x, count) || !Cover(row, x, lanes)) continue;
        Deepen(lanes);
        for (uint32_t k = 0; k < count; ++k) {
          if (!lanes.inside[k] || !seen(x + k, y, lanes.depth[k])) continue;
          visit(x + k, y, lanes.depth[k], glm::vec3(lanes.u[k], lanes.v[k], lanes.w[k]));
        }
      }
    }
  }

 private:
  static constexpr uint32_t kLanes = 4;
  static constexpr float kNowhere = std::numeric_limits<float>::max();

  // Shares of the corners on the screen; after Deepen over their depths.
  struct Lanes {
    float u[kLanes], v[kLanes], w[kLanes], depth[kLanes];
    int32_t inside[kLanes];
  };
  // Where an edge crosses a row, and on which side of it the triangle lies.
  struct Edge {
    float x, y, slope, slack;
    bool keeps_left;
  };
  struct Row {
    uint32_t from, to;
    float u, v;  // what the samples' shares have in common, times the area
  };

  static uint32_t First(float low, uint32_t end) {
    return uint32_t(std::clamp(std::floor(low), 0.0f, float(end)));
  }
  static uint32_t Last(float high, uint32_t end) {
    return uint32_t(std::ceil(std::clamp(high + 1.0f, 0.0f, float(end))));
  }

  // The share of the corner that is not on it is 0 or more on the inner side.
  Edge MakeEdge(const glm::vec3& from, const glm::vec3& to, float wrong, float far) const {
    const float down = to.y - from.y;
    const float slack = down == 0.0f ? kNowhere : wrong / std::abs(down) + far;
    return {from.x, from.y, down == 0.0f ? 0.0f : (to.x - from.x) / down, slack,
            (down > 0.0f) == (area_ > 0.0f)};
  }

  Row FindRow(uint32_t y) const {
    const float at_y = float(y) + 0.5f;
    float from = float(x0_), to = float(x1_);
    for (const Edge& edge : edge_) {
      const float cross = edge.x + (at_y - edge.y) * edge.slope - 0.5f;
      if (edge.keeps_left)
        to = std::min(to, cross + edge.slack + 1.0f);
      else
        from = std::max(from, cross - edge.slack);
    }
    return {uint32_t(std::min(from, float(x1_))), from < to ? uint32_t(std::ceil(to)) : 0,
            (c_.x - b_.x) * (at_y - b_.y), (a_.x - c_.x) * (at_y - c_.y)};
  }

  // Whether all of them are nearer than the triangle.
  bool IsHidden(const float* depth, uint32_t count) const {
    for (uint32_t k = 0; k < count; ++k)
      if (depth[k] >= nearest_) return false;
    return true;
  }

  // Whether any of them is inside.
  bool Cover(const Row& row, uint32_t x, Lanes& lanes) const {
    const float u_down = c_.y - b_.y, v_down = a_.y - c_.y, u_x = b_.x, v_x = c_.x, area = area_;
    int32_t any = 0;
    for (uint32_t k = 0; k < kLanes; ++k) {
      const float at_x = float(int32_t(x) + int32_t(k)) + 0.5f;
      const float u = (row.u - u_down * (at_x - u_x)) / area;
      const float v = (row.v - v_down * (at_x - v_x)) / area;
      const float w = 1.0f - u - v;
      lanes.u[k] = u;
      lanes.v[k] = v;
      lanes.w[k] = w;
      lanes.inside[k] = (u >= 0.0f) & (v >= 0.0f) & (w >= 0.0f);
      any |= lanes.inside[k];
    }
    return any != 0;
  }

  // What is even in the world is even on the screen by the depth's reciprocal.
  void Deepen(Lanes& lanes) const {
    const float a = a_.z, b = b_.z, c = c_.z;
    for (uint32_t k = 0; k < kLanes; ++k) {
      lanes.u[k] /= a;
      lanes.v[k] /= b;
      lanes.w[k] /= c;
      lanes.depth[k] = 1.0f / (lanes.u[k] + lanes.v[k] + lanes.w[k]);
    }
  }

  glm::vec3 a_, b_, c_;
  float area_, nearest_;
  uint32_t width_, x0_, x1_, y0_, y1_;
  Edge edge_[3];
};

// Which samples of a picture a piece of a hair covers: what every way to paint hairs, and to judge their order, has
// in common.

// One end of a piece of a hair.
struct HairEnd {
  glm::vec3 at;      // projected: samples from the upper left, and the distance along the view, m
  glm::vec3 colour;  // linear
  float width;       // samples
  glm::vec3 highlights{0.0f};  // in the colour, where an artist's texture has more of them
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
  glm::vec3 tint;  // where the texture has extra tint
  uint32_t strip = 0;
  glm::vec2 wet_dirty{0.0f};
  float from = 0.0f, to = 1.0f;  // share of the card's length

  // Colour at this share across and along the piece, where it is so many samples wide, of what it would be without the
  // texture and of the highlights in that; w: what hairs cover there.
  glm::vec4 See(const glm::vec3& lit, const glm::vec3& highlights, const glm::vec2& place,
                float width) const;
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

  // Before the shells of a layer.
  void BeginShells();
  // The same of one that has holes: shade(shares, colour) says whether it covers the place, and with what; how much in w.
  // Where two are as far off, the lower `shell`, 1 or more, is seen: opaque ones may come in any order, and nearest first
  // most that is hidden is never shaded.
  template <class Shade>
  void DrawShellTriangle(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, uint8_t shell,
                         Shade shade);

  // The same, of what is thinner than its samples: what lies behind it is still drawn. shade(bary)
  // returns colour and coverage.
  template <class Shade>
  void DrawThinTriangle(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, Shade shade);

  void DrawPoint(uint32_t x, uint32_t y, float depth, const glm::vec3& colour);

  // A tapering piece of a hair, painted with coverage `alpha`; of a card, if there is one.
  void DrawHair(const HairEnd& a, const HairEnd& b, float alpha, const CardPiece* card = nullptr);
  // Hairs drawn so far hide what lies behind them from now on.
  void FinishLayer();

  // Averages blocks of samples x samples into 8-bit sRGB, rows from the top.
  std::vector<uint8_t> Resolve(uint32_t samples) const;

 private:
  size_t Place(uint32_t x, uint32_t y) const { return size_t(y) * width_ + x; }

  uint32_t width_, height_;
  std::vector<glm::vec3> colour_;
  std::vector<float> depth_, layer_depth_;
  std::vector<uint8_t> shell_;  // that was drawn there; 0: none of this layer
  uint32_t touched_from_, touched_to_ = 0;
};

template <class Shade>
void Canvas::DrawTriangle(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, Shade shade) {
  TriangleSamples(a, b, c, width_, height_)
      .ForEach(
          depth_, [&](uint32_t x, uint32_t y, float depth) { return depth < depth_[Place(x, y)]; },
          [&](uint32_t x, uint32_t y, float depth, const glm::vec3& nearness) {
            const size_t i = Place(x, y);
            depth_[i] = depth;
            colour_[i] = shade(nearness * depth);
          });
}

template <class Shade>
void Canvas::DrawShellTriangle(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c,
                               uint8_t shell, Shade shade) {
  TriangleSamples(a, b, c, width_, height_)
      .ForEach(
          depth_,
          [&](uint32_t x, uint32_t y, float depth) {
            const size_t i = Place(x, y);
            return depth < depth_[i] || (depth == depth_[i] && shell_[i] > shell);
          },
          [&](uint32_t x, uint32_t y, float depth, const glm::vec3& nearness) {
            glm::vec4 colour;
            if (!shade(nearness * depth, colour)) return;
            const size_t i = Place(x, y);
            depth_[i] = depth;
            shell_[i] = shell;
            colour_[i] = colour.w == 1.0f ? glm::vec3(colour)
                                          : glm::mix(colour_[i], glm::vec3(colour), colour.w);
          });
}

template <class Shade>
void Canvas::DrawThinTriangle(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c,
                              Shade shade) {
  TriangleSamples(a, b, c, width_, height_)
      .ForEach(
          depth_, [&](uint32_t x, uint32_t y, float depth) { return depth < depth_[Place(x, y)]; },
          [&](uint32_t x, uint32_t y, float depth, const glm::vec3& nearness) {
            const glm::vec4 colour = shade(nearness * depth);
            glm::vec3& under = colour_[Place(x, y)];
            under = glm::mix(under, glm::vec3(colour), colour.w);
          });
}

inline glm::vec3 VecOf(const float* v) { return {v[0], v[1], v[2]}; }

// Linear light of sRGB bytes.
glm::vec3 LinearColour(uint32_t aabbggrr);

}  // namespace pelt
