#include "bench/picture/shadow_map.hpp"

#include <algorithm>
#include <cmath>

#include "core/character/mesh_repair.hpp"

namespace pelt {
namespace {

constexpr float kDepthSteps = float(1u << 20);  // a float counts them all

// Running means of 2 n + 1 values along rows; the rows become columns.
std::vector<float> MeansTransposed(const std::vector<float>& from, int side, int n) {
  std::vector<float> to(from.size());
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      float sum = 0.0f;
      for (int i = std::max(0, x - n); i <= std::min(side - 1, x + n); ++i)
        sum += from[size_t(y) * size_t(side) + size_t(i)];
      to[size_t(x) * size_t(side) + size_t(y)] = sum / float(2 * n + 1);
    }
  return to;
}

}  // namespace

ShadowMap::ShadowMap(const glm::vec3& to_light, const glm::vec3& centre, float radius,
                     uint32_t side)
    : to_light_(to_light),
      centre_(centre),
      radius_(radius),
      texels_per_m_(0.5f * float(side) / radius),
      steps_per_m_(0.5f * kDepthSteps / radius),
      side_(int(side)),
      texels_(size_t(side) * side) {
  axis_x_ = glm::vec3(PickTangent(glm::dvec3(to_light)));
  axis_y_ = glm::cross(to_light, axis_x_);
}

glm::vec3 ShadowMap::Map(const glm::vec3& world) const {
  const glm::vec3 p = world - centre_;
  const float half = 0.5f * float(side_);
  return {glm::dot(p, axis_x_) * texels_per_m_ + half, glm::dot(p, axis_y_) * texels_per_m_ + half,
          (radius_ - glm::dot(p, to_light_)) * steps_per_m_};
}

void ShadowMap::Add(int x, int y, float depth, uint32_t coverage) {
  if (x < 0 || y < 0 || x >= side_ || y >= side_) return;
  Texel& texel = texels_[size_t(y) * size_t(side_) + size_t(x)];
  texel.nearest = std::min(texel.nearest, uint32_t(std::clamp(depth, 0.0f, kDepthSteps)));
  texel.coverage = std::min(texel.coverage + coverage, kFull);
}

void ShadowMap::AddHair(const glm::vec3& a, const glm::vec3& b, float width, float alpha) {
  const glm::vec3 from = Map(a), along = Map(b) - from;
  const float length = std::max(std::abs(along.x), std::abs(along.y));
  const int steps = std::clamp(int(std::ceil(length)), 1, 4 * side_);
  const float filled = width * texels_per_m_ * std::min(length, 1.0f);
  const uint32_t coverage = uint32_t(float(kFull) * std::min(filled, 1.0f) * alpha + 0.5f);
  for (int i = 0; i < steps; ++i) {
    const glm::vec3 at = from + along * ((float(i) + 0.5f) / float(steps));
    Add(int(std::floor(at.x)), int(std::floor(at.y)), at.z, coverage);
  }
}

void ShadowMap::AddTriangle(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c,
                            const glm::vec3& covered) {
  const glm::vec3 p = Map(a), q = Map(b), r = Map(c);
  const float area = (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
  if (area == 0.0f) return;
  const auto first = [](float v) { return std::max(0, int(std::floor(v))); };
  const auto end = [&](float v) { return std::min(side_, int(std::floor(v)) + 1); };
  for (int y = first(std::min({p.y, q.y, r.y})); y < end(std::max({p.y, q.y, r.y})); ++y)
    for (int x = first(std::min({p.x, q.x, r.x})); x < end(std::max({p.x, q.x, r.x})); ++x) {
      const float sx = float(x) + 0.5f, sy = float(y) + 0.5f;
      const float u = ((r.x - q.x) * (sy - q.y) - (r.y - q.y) * (sx - q.x)) / area;
      const float v = ((p.x - r.x) * (sy - r.y) - (p.y - r.y) * (sx - r.x)) / area;
      const float w = 1.0f - u - v;
      if (u < 0.0f || v < 0.0f || w < 0.0f) continue;
      const float share = u * covered.x + v * covered.y + w * covered.z;
      const uint32_t coverage = uint32_t(float(kFull) * share + 0.5f);
      if (coverage > 0) Add(x, y, u * p.z + v * q.z + w * r.z, coverage);
    }
}

template <class Value>
float ShadowMap::Mix(const glm::vec3& at, float outside, Value value) const {
  const float fx = at.x - 0.5f, fy = at.y - 0.5f;
  const int x = int(std::floor(fx)), y = int(std::floor(fy));
  const auto read = [&](int cx, int cy) {
    if (cx < 0 || cy < 0 || cx >= side_ || cy >= side_) return outside;
    return value(size_t(cy) * size_t(side_) + size_t(cx));
  };
  const float u = fx - float(x), v = fy - float(y);
  return glm::mix(glm::mix(read(x, y), read(x + 1, y), u),
                  glm::mix(read(x, y + 1), read(x + 1, y + 1), u), v);
}

bool ShadowMap::Covers(const glm::vec3& world) const {
  const glm::vec3 at = Map(world);
  return at.x > 0.0f && at.y > 0.0f && at.x < float(side_) && at.y < float(side_) && at.z > 0.0f;
}

float ShadowMap::Share(const glm::vec3& world, const ShadowLook& look) const {
  const glm::vec3 at = Map(world);
  return Mix(at, 1.0f, [&](size_t i) {
    const Texel& texel = texels_[i];
    if (texel.coverage == 0) return 1.0f;
    const float behind = (at.z - float(texel.nearest)) / steps_per_m_;
    return SelfShadow(float(texel.coverage) / float(kFull), behind, look.bias, look.falloff,
                      look.strength);
  });
}

void ShadowMap::Soften(int texels) {
  soft_.resize(texels_.size());
  for (size_t i = 0; i < soft_.size(); ++i) soft_[i] = float(texels_[i].coverage) / float(kFull);
  for (int turn = 0; turn < 4; ++turn) soft_ = MeansTransposed(soft_, side_, texels);
}

float ShadowMap::Blocked(const glm::vec3& world) const {
  return Mix(Map(world), 0.0f, [&](size_t i) { return soft_[i]; });
}

}  // namespace pelt
