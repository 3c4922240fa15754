// Which samples of a picture a triangle covers, four of a row at once: what time software spends on triangles it
// spends here, and most of the samples are hidden or outside.
//
// Invariant: which samples, their shares and their depth are the same bits whatever is left out. A row's ends are found
// by the edges' slopes, wider than rounding can be wrong; each sample between them is judged by itself.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <vector>

namespace pelt {

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

}  // namespace pelt
