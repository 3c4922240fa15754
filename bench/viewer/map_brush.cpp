#include "bench/viewer/map_brush.hpp"

#include <algorithm>
#include <cmath>

#include "core/groom/growth.hpp"

namespace pelt {
namespace {

// Texels beyond an edge that a bilinear look-up on it may blend in: a texel's diagonal, rounded up.
constexpr float kBeyondEdge = 1.5f;
// A triangle over more tiles of a texture than this a side has no texels of its own to paint.
constexpr float kMostTiles = 4.0f;

uint32_t WrapTexel(int texel, uint32_t side, Wrap wrap) {
  const int n = int(side);
  if (wrap == Wrap::kClamp) return uint32_t(std::clamp(texel, 0, n - 1));
  const int tiles = wrap == Wrap::kMirror ? 2 * n : n;
  const int in_tiles = (texel % tiles + tiles) % tiles;
  return uint32_t(in_tiles < n ? in_tiles : tiles - 1 - in_tiles);
}

float Cross(const glm::vec2& a, const glm::vec2& b) { return a.x * b.y - a.y * b.x; }

float Square(const auto& v) { return glm::dot(v, v); }

// From the centre to its edge 1 to 0, by the squared distance, as the frame's own brushes.
float ShareAt(const MapDab& dab, float distance2) {
  const float all2 = dab.radius * dab.radius, hard2 = all2 * dab.hardness * dab.hardness;
  if (distance2 <= hard2) return 1.0f;
  return distance2 < all2 ? (all2 - distance2) / (all2 - hard2) : 0.0f;
}

}  // namespace

void MapBrush::ForEachTexel(const Triangle& t, const auto& visit) const {
  const auto& [a, b, c] = t.texel;
  const glm::vec2 low = glm::ceil(glm::min(glm::min(a, b), c) - kBeyondEdge);
  const glm::vec2 high = glm::floor(glm::max(glm::max(a, b), c) + kBeyondEdge);
  const float area = Cross(b - a, c - a);
  for (int y = int(low.y); y <= int(high.y); ++y)
    for (int x = int(low.x); x <= int(high.x); ++x) {
      const glm::vec2 p{float(x), float(y)};
      const float v = Cross(p - a, c - a), w = Cross(b - a, p - a),
                  sign = area < 0.0f ? -1.0f : 1.0f;
      const bool inside =
          area != 0.0f && sign * v >= 0.0f && sign * w >= 0.0f && sign * (v + w) <= sign * area;
      glm::vec3 place(0.0f);
      if (inside) {
        place = t.at[0] + (t.at[1] - t.at[0]) * (v / area) + (t.at[2] - t.at[0]) * (w / area);
      } else {
        float least = kBeyondEdge * kBeyondEdge;
        bool near = false;
        for (size_t i = 0; i < 3; ++i) {
          const size_t j = (i + 1) % 3;
          const glm::vec2 edge = t.texel[j] - t.texel[i];
          const float length2 = Square(edge);
          const float along = length2 > 0.0f
                                  ? std::clamp(glm::dot(p - t.texel[i], edge) / length2, 0.0f, 1.0f)
                                  : 0.0f;
          const float away = Square(p - t.texel[i] - edge * along);
          if (away >= least) continue;
          least = away;
          near = true;
          place = t.at[i] + (t.at[j] - t.at[i]) * along;
        }
        if (!near) continue;
      }
      visit(WrapTexel(y, side_, t.wrap[1]) * side_ + WrapTexel(x, side_, t.wrap[0]), place, inside);
    }
}

MapBrush::MapBrush(const Mesh& mesh, const RestGeometry& rest, uint32_t side)
    : side_(side), covered_(size_t(side) * side, 0), share_(size_t(side) * side, 0.0f) {
  for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    Triangle triangle{{}, {}, WrapOn(mesh, t)};
    for (size_t k = 0; k < 3; ++k) {
      const uint32_t v = mesh.triangles[t][k];
      triangle.texel[k] = mesh.uv[v] * float(side) - 0.5f;
      triangle.at[k] = rest.position[v];
    }
    const auto& [a, b, c] = triangle.texel;
    const glm::vec2 furthest = glm::max(glm::max(glm::abs(a), glm::abs(b)), glm::abs(c));
    const glm::vec2 size = glm::max(glm::max(a, b), c) - glm::min(glm::min(a, b), c);
    // Nor are those that are not finite.
    if (!(std::max(size.x, size.y) <= kMostTiles * float(side) &&
          std::max(furthest.x, furthest.y) < 1.0e6f))
      continue;
    ForEachTexel(triangle, [&](uint32_t texel, const glm::vec3&, bool inside) {
      covered_[texel] |= uint8_t(inside);
    });
    triangles_.push_back(triangle);
  }
}

size_t MapBrush::Paint(std::span<uint8_t> texels, const MapDab& dab) {
  reached_.clear();
  for (const Triangle& t : triangles_) {
    const glm::vec3 low = glm::min(glm::min(t.at[0], t.at[1]), t.at[2]);
    const glm::vec3 high = glm::max(glm::max(t.at[0], t.at[1]), t.at[2]);
    if (Square(glm::clamp(dab.centre, low, high) - dab.centre) >= dab.radius * dab.radius) continue;
    ForEachTexel(t, [&](uint32_t texel, const glm::vec3& place, bool inside) {
      // Beyond the edge of one island may be another one.
      if (!inside && covered_[texel]) return;
      const float share = ShareAt(dab, Square(place - dab.centre));
      if (share <= share_[texel]) return;
      if (share_[texel] == 0.0f) reached_.push_back(texel);
      share_[texel] = share;
    });
  }
  for (const uint32_t texel : reached_) {
    const float from = float(texels[texel]);
    const float to = from + (255.0f * dab.value - from) * share_[texel];
    texels[texel] = uint8_t(std::clamp(to, 0.0f, 255.0f) + 0.5f);
    share_[texel] = 0.0f;
  }
  return reached_.size();
}

}  // namespace pelt
