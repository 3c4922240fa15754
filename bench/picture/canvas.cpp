#include "bench/picture/canvas.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "bench/shading/shading.hpp"

namespace pelt {
namespace {

constexpr float kFar = std::numeric_limits<float>::max();

}  // namespace

Projection::Projection(const Camera& camera, uint32_t width, uint32_t height)
    : eye_(VecOf(camera.eye)) {
  forward_ = glm::normalize(VecOf(camera.target) - eye_);
  right_ = glm::normalize(glm::cross(forward_, VecOf(camera.up)));
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

Canvas::Canvas(uint32_t width, uint32_t height)
    : width_(width),
      height_(height),
      colour_(size_t(width) * height, glm::vec3(0.0f)),
      depth_(colour_.size(), kFar),
      layer_depth_(colour_.size(), kFar),
      touched_from_(height) {}

void Canvas::SetBackground(uint32_t x, uint32_t y, uint32_t side, const glm::vec3& colour) {
  for (uint32_t row = y; row < std::min(y + side, height_); ++row)
    for (uint32_t column = x; column < std::min(x + side, width_); ++column)
      colour_[size_t(row) * width_ + column] = colour;
}

void Canvas::DrawPoint(uint32_t x, uint32_t y, float depth, const glm::vec3& colour) {
  const size_t i = size_t(y) * width_ + x;
  if (depth >= depth_[i]) return;
  depth_[i] = depth;
  colour_[i] = colour;
}

void Canvas::BeginShells() { shell_.assign(colour_.size(), 0); }

void Canvas::DrawHair(const HairEnd& a, const HairEnd& b, float alpha, const CardPiece* card) {
  const SampleBox box =
      ForEachHairSample(a, b, width_, height_,
                        [&](uint32_t x, uint32_t y, float depth, const glm::vec3& colour,
                            float coverage, const glm::vec2& place) {
                          const size_t i = size_t(y) * width_ + x;
                          if (depth >= depth_[i]) return;
                          glm::vec4 seen(colour, 1.0f);
                          if (card)
                            seen = card->See(colour, glm::mix(a.highlights, b.highlights, place.y),
                                             place, glm::mix(a.width, b.width, place.y));
                          coverage = coverage * alpha * seen.w;
                          colour_[i] = Over(glm::vec3(seen), coverage, colour_[i]);
                          if (coverage > 0.3f) layer_depth_[i] = std::min(layer_depth_[i], depth);
                        });
  if (box.y1 == 0) return;
  touched_from_ = std::min(touched_from_, box.y0);
  touched_to_ = std::max(touched_to_, box.y1);
}

glm::vec4 CardPiece::See(const glm::vec3& lit, const glm::vec3& highlights, const glm::vec2& place,
                         float width) const {
  const glm::vec4 texel =
      texture->Texel(strip, place.x, glm::mix(from, to, place.y), 1.0f / std::max(width, 1.0f));
  const int meaning = texture->meaning();
  return {TexelColour(meaning, texel, lit, highlights, tint),
          TexelCover(meaning, texel, wet_dirty)};
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
        const float srgb = SrgbFromLinear(Tone(std::max(sum[c], 0.0f)));
        rgb[(size_t(y) * w + x) * 3 + size_t(c)] = uint8_t(255.0f * srgb + 0.5f);
      }
    }
  return rgb;
}

glm::vec3 LinearColour(uint32_t aabbggrr) {
  static const std::array<float, 256> kLinear = [] {
    std::array<float, 256> linear;
    for (size_t byte = 0; byte < 256; ++byte) linear[byte] = LinearFromSrgb(float(byte) / 255.0f);
    return linear;
  }();
  return {kLinear[aabbggrr & 255u], kLinear[aabbggrr >> 8 & 255u], kLinear[aabbggrr >> 16 & 255u]};
}

}  // namespace pelt
