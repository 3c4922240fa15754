#include "bench/picture/shadows.hpp"

#include <algorithm>
#include <cmath>

#include "bench/shading/shading.hpp"
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

void ShadowMap::AddHair(const glm::vec3& a, const glm::vec3& b, float width, float alpha,
                        float least) {
  if (std::min(width * texels_per_m_, 1.0f) * alpha < least) return;
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

namespace {

using Covers = std::array<float, 256>;

// Share of the texels that are drawn at this threshold, for each stencil.
Covers ShareAbove(const std::array<uint32_t, 256>& texels_of_length, float threshold) {
  float all = 0.0f;
  for (const uint32_t texels : texels_of_length) all += float(texels);
  Covers share;
  for (uint32_t stencil = 0; stencil < share.size(); ++stencil) {
    float drawn = 0.0f;
    for (uint32_t length = 0; length < texels_of_length.size(); ++length)
      drawn += float(texels_of_length[length]) *
               ShellCoverage(float(length) / 255.0f, float(stencil) / 255.0f, threshold);
    share[stencil] = drawn / std::max(all, 1.0f);
  }
  return share;
}

}  // namespace

std::vector<ShadowShell> FindShadowShells(std::span<const Shell> shells,
                                          const FurTexture& texture) {
  std::array<uint32_t, 256> texels_of_length{};
  for (const uint8_t length : texture.texels) ++texels_of_length[length];
  const size_t count = std::min(shells.size(), kShadowShells);
  std::vector<ShadowShell> found(count);
  Covers above{};  // what reaches the next one up
  for (size_t i = count; i-- > 0;) {
    const Shell& shell = shells[(i + 1) * shells.size() / count - 1];
    const Covers here = ShareAbove(texels_of_length, shell.threshold);
    found[i].height = shell.height;
    for (size_t s = 0; s < here.size(); ++s) found[i].covers[s] = (here[s] - above[s]) * shell.fade;
    above = here;
  }
  return found;
}

void AddShells(const LayerDraw& draw, const FurTexture& texture, ShadowMap& map) {
  if (draw.shells.shell.empty()) return;
  std::vector<uint32_t> indices(WriteShellIndices(draw.shells, {}));
  WriteShellIndices(draw.shells, indices);
  const std::span<const ShellVertex> vertices = draw.As<ShellVertex>();
  for (const ShadowShell& shell : FindShadowShells(draw.shells.shell, texture))
    for (size_t t = 0; t < indices.size(); t += 3) {
      glm::vec3 at[3], covered;
      for (int k = 0; k < 3; ++k) {
        const ShellVertex& vertex = vertices[indices[t + size_t(k)]];
        at[k] = ShellPosition(VecOf(vertex.position), VecOf(vertex.groom), VecOf(vertex.force),
                              shell.height);
        covered[k] = shell.covers[vertex.base_colour >> 24];
      }
      map.AddTriangle(at[0], at[1], at[2], covered);
    }
}

namespace {

// Of the piece before knot k; `strips`: an artist's, or null.
float OpacityOf(const Hair& hair, uint32_t k, const StripTexture* strips) {
  if (!hair.is_card || !strips) return hair.Opacity();
  const auto cover = [&](uint32_t knot) {
    return strips->CoverAt(hair.film_strip, float(knot) / float(hair.knots - 1),
                           WetAndDirty(hair.paint));
  };
  return hair.Alpha() * 0.5f * (cover(k - 1) + cover(k));
}

}  // namespace

SceneShadows::SceneShadows(const PictureScene& scene)
    : look_(scene.look.shadow), near_(scene.bodies.size()) {
  const glm::vec3& to_sun = scene.look.light.to_sun;
  const std::vector<Body>& bodies = scene.bodies;
  const std::vector<Ball> balls = BoundActors(scene);
  for (uint32_t a = 0; a < bodies.size(); ++a) {
    ShadowMap& map = maps_.emplace_back(to_sun, balls[a].centre, balls[a].radius, kShadowTexels);
    lift_.push_back(kLiftTexels * 2.0f * balls[a].radius / float(kShadowTexels));
    for (const auto& [p, q, r] : bodies[a].character->mesh.triangles)
      map.AddTriangle(bodies[a].position[p], bodies[a].position[q], bodies[a].position[r]);
    for (uint32_t b = 0; b < bodies.size(); ++b)
      if (a == b || ShadowMeets(balls[a], balls[b], to_sun)) near_[a].push_back(b);
  }
  for (size_t i = 0; i < scene.layers.size(); ++i)
    for (const Hair& hair : scene.layers[i])
      for (uint32_t k = 1; k < hair.knots && hair.shadow > 0.0f; ++k)
        maps_[hair.actor].AddHair(
            hair.knot[k - 1].at, hair.knot[k].at, hair.knot[k].width * hair.shadow,
            OpacityOf(hair, k, scene.strips[i].get()), scene.draws[i].look->shadow_alpha);
  for (size_t i = 0; i < scene.draws.size(); ++i)
    AddShells(scene.draws[i], scene.textures[i], maps_[scene.actors[i]]);
  for (ShadowMap& map : maps_) map.Soften(kSoftTexels);
}

float SceneShadows::OnActor(uint32_t actor, const glm::vec3& world) const {
  float share = 1.0f;
  for (const uint32_t map : near_[actor]) share *= maps_[map].Share(world, look_);
  return share;
}

float SceneShadows::OnGround(const glm::vec3& world) const {
  float light = 1.0f;
  for (const ShadowMap& map : maps_)
    if (map.Covers(world)) light *= 1.0f - map.Blocked(world);
  return 1.0f - light;
}

}  // namespace pelt
