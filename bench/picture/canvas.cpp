#include "bench/picture/canvas.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pelt {
namespace {

constexpr float kFar = std::numeric_limits<float>::max();

glm::vec3 ToVec(const float v[3]) { return {v[0], v[1], v[2]}; }

}  // namespace

Projection::Projection(const Camera& camera, uint32_t width, uint32_t height)
    : eye_(ToVec(camera.position)) {
  forward_ = glm::normalize(ToVec(camera.target) - eye_);
  right_ = glm::normalize(glm::cross(forward_, ToVec(camera.up)));
  up_ = glm::cross(right_, forward_);
  focal_ = 0.5f * float(height) / std::tan(0.5f * camera.vertical_fov_rad);
  centre_x_ = 0.5f * float(width);
  centre_y_ = 0.5f * float(height);
}

glm::vec3 Projection::Project(const glm::vec3& world) const {
  const glm::vec3 from_eye = world - eye_;
  const float depth = std::max(glm::dot(from_eye, forward_), 1e-3f);
  const float scale = focal_ / depth;
  return {centre_x_ + glm::dot(from_eye, right_) * scale,
          centre_y_ - glm::dot(from_eye, up_) * scale, depth};
}

glm::vec3 Projection::RayThrough(float x, float y) const {
  return glm::normalize(forward_ * focal_ + right_ * (x - centre_x_) + up_ * (centre_y_ - y));
}

LightMap::LightMap(const glm::vec3& to_light, const glm::vec3& centre, float radius, uint32_t side)
    : to_light_(to_light),
      centre_(centre),
      cells_per_m_(0.5f * float(side) / radius),
      side_(int(side)),
      nearest_(size_t(side) * side, kFar) {
  axis_x_ = glm::normalize(glm::cross(glm::vec3(0.0f, 1.0f, 0.0f), to_light));
  axis_y_ = glm::cross(to_light, axis_x_);
}

glm::vec3 LightMap::Map(const glm::vec3& world) const {
  const glm::vec3 p = world - centre_;
  return {glm::dot(p, axis_x_) * cells_per_m_ + 0.5f * float(side_),
          glm::dot(p, axis_y_) * cells_per_m_ + 0.5f * float(side_), -glm::dot(p, to_light_)};
}

void LightMap::Add(const glm::vec3& world) {
  const glm::vec3 at = Map(world);
  const int x = int(std::floor(at.x)), y = int(std::floor(at.y));
  if (x < 0 || y < 0 || x >= side_ || y >= side_) return;
  float& nearest = nearest_[size_t(y) * size_t(side_) + size_t(x)];
  nearest = std::min(nearest, at.z);
}

float LightMap::Light(const glm::vec3& world, float falloff_m, int blur) const {
  const glm::vec3 at = Map(world);
  const int x = int(std::floor(at.x)), y = int(std::floor(at.y));
  float light = 0.0f;
  int count = 0;
  for (int dy = -blur; dy <= blur; ++dy)
    for (int dx = -blur; dx <= blur; ++dx) {
      const int cx = x + dx, cy = y + dy;
      ++count;
      const bool inside = cx >= 0 && cy >= 0 && cx < side_ && cy < side_;
      const float nearest = inside ? nearest_[size_t(cy) * size_t(side_) + size_t(cx)] : kFar;
      light += nearest == kFar ? 1.0f : std::exp(-std::max(0.0f, at.z - nearest) / falloff_m);
    }
  return light / float(count);
}

Canvas::Canvas(uint32_t width, uint32_t height)
    : width_(width),
      height_(height),
      colour_(size_t(width) * height, glm::vec3(0.0f)),
      depth_(colour_.size(), kFar),
      layer_depth_(colour_.size(), kFar),
      touched_from_(height) {}

void Canvas::DrawTriangle(const Corner& a, const Corner& b, const Corner& c) {
  const glm::vec2 p = a.at, q = b.at, r = c.at;
  const float area = (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
  if (area == 0.0f) return;
  const auto low = [](float v) { return uint32_t(std::max(0.0f, std::floor(v))); };
  const uint32_t x0 = low(std::min({p.x, q.x, r.x})), y0 = low(std::min({p.y, q.y, r.y}));
  const float x_end = std::min(std::max({p.x, q.x, r.x}) + 1.0f, float(width_));
  const float y_end = std::min(std::max({p.y, q.y, r.y}) + 1.0f, float(height_));
  for (uint32_t y = y0; float(y) < y_end; ++y)
    for (uint32_t x = x0; float(x) < x_end; ++x) {
      const glm::vec2 s(float(x) + 0.5f, float(y) + 0.5f);
      const float u = ((r.x - q.x) * (s.y - q.y) - (r.y - q.y) * (s.x - q.x)) / area;
      const float v = ((p.x - r.x) * (s.y - r.y) - (p.y - r.y) * (s.x - r.x)) / area;
      const float w = 1.0f - u - v;
      if (u < 0.0f || v < 0.0f || w < 0.0f) continue;
      const size_t i = size_t(y) * width_ + x;
      const float depth = u * a.at.z + v * b.at.z + w * c.at.z;
      if (depth >= depth_[i]) continue;
      depth_[i] = depth;
      colour_[i] = a.colour * u + b.colour * v + c.colour * w;
    }
}

void Canvas::DrawPoint(uint32_t x, uint32_t y, float depth, const glm::vec3& colour) {
  const size_t i = size_t(y) * width_ + x;
  if (depth >= depth_[i]) return;
  depth_[i] = depth;
  colour_[i] = colour;
}

// Every sample whose nearest point of the segment is closer than half the width there (at least
// half a sample: thinner hairs are painted as wide, with less coverage).
void Canvas::DrawHair(const Knot& a, const Knot& b, float alpha) {
  const glm::vec2 p = a.at, along = glm::vec2(b.at) - p;
  const float length2 = std::max(glm::dot(along, along), 1e-12f);
  const float reach = 0.5f * std::max({a.width, b.width, 1.0f});
  const float left = std::min(a.at.x, b.at.x) - reach, right = std::max(a.at.x, b.at.x) + reach;
  const float top = std::min(a.at.y, b.at.y) - reach, bottom = std::max(a.at.y, b.at.y) + reach;
  if (right < 0.0f || bottom < 0.0f || left >= float(width_) || top >= float(height_)) return;
  const uint32_t x0 = uint32_t(std::max(left, 0.0f)), y0 = uint32_t(std::max(top, 0.0f));
  const uint32_t x1 = std::min(uint32_t(right) + 1, width_),
                 y1 = std::min(uint32_t(bottom) + 1, height_);
  touched_from_ = std::min(touched_from_, y0);
  touched_to_ = std::max(touched_to_, y1);
  for (uint32_t y = y0; y < y1; ++y)
    for (uint32_t x = x0; x < x1; ++x) {
      const glm::vec2 s = glm::vec2(float(x) + 0.5f, float(y) + 0.5f) - p;
      const float t = glm::dot(s, along) / length2;
      if (t < 0.0f || t >= 1.0f) continue;  // the neighbouring segment has it
      const glm::vec2 off = s - along * t;
      const float width = a.width + (b.width - a.width) * t;
      const float half = 0.5f * std::max(width, 1.0f);
      if (glm::dot(off, off) > half * half) continue;
      const size_t i = size_t(y) * width_ + x;
      const float depth = a.at.z + (b.at.z - a.at.z) * t;
      if (depth >= depth_[i]) continue;
      const float coverage = alpha * std::min(width, 1.0f);
      colour_[i] = glm::mix(colour_[i], glm::mix(a.colour, b.colour, t), coverage);
      if (coverage > 0.3f) layer_depth_[i] = std::min(layer_depth_[i], depth);
    }
}

void Canvas::FinishLayer() {
  for (size_t i = size_t(touched_from_) * width_; i < size_t(touched_to_) * width_; ++i) {
    depth_[i] = std::min(depth_[i], layer_depth_[i]);
    layer_depth_[i] = kFar;
  }
  touched_from_ = height_;
  touched_to_ = 0;
}

std::vector<uint8_t> Canvas::Resolve(uint32_t samples) const {
  const uint32_t w = width_ / samples, h = height_ / samples;
  std::vector<uint8_t> rgb(size_t(w) * h * 3);
  for (uint32_t y = 0; y < h; ++y)
    for (uint32_t x = 0; x < w; ++x) {
      glm::vec3 sum(0.0f);
      for (uint32_t sy = 0; sy < samples; ++sy)
        for (uint32_t sx = 0; sx < samples; ++sx)
          sum += colour_[size_t(y * samples + sy) * width_ + x * samples + sx];
      sum /= float(samples * samples);
      for (int c = 0; c < 3; ++c) {
        const float tone = 1.0f - std::exp(-1.35f * std::max(sum[c], 0.0f));  // soft shoulder
        rgb[(size_t(y) * w + x) * 3 + size_t(c)] =
            uint8_t(255.0f * std::pow(tone, 1.0f / 2.2f) + 0.5f);
      }
    }
  return rgb;
}

glm::vec3 LinearColour(uint32_t aabbggrr) {
  glm::vec3 linear;
  for (int c = 0; c < 3; ++c)
    linear[c] = std::pow(float(aabbggrr >> (8 * c) & 255u) / 255.0f, 2.2f);
  return linear;
}

}  // namespace pelt
