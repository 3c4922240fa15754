#include "core/character/gltf_corners.hpp"

#include <algorithm>
#include <cmath>

#include "core/float_rules.hpp"

namespace pelt::gltf {
namespace {

template <class Value, class OfVertex>
void StoreCorners(const Mesh& mesh, const OfVertex& of,
                  std::vector<std::array<Value, 3>>& corners) {
  for (size_t t = corners.size(); t < mesh.triangles.size(); ++t) {
    const auto& v = mesh.triangles[t];
    corners.push_back({of(v[0]), of(v[1]), of(v[2])});
  }
}

}  // namespace

void StoreCornerColours(const std::vector<float>& colours, size_t size, size_t first, Mesh& mesh) {
  const auto colour_of = [&](size_t v) {
    glm::vec3 colour(1.0f);
    for (int c = 0; c < 3 && !colours.empty(); ++c)
      if (const float value = colours[(v - first) * size + size_t(c)]; std::isfinite(value))
        colour[c] = std::clamp(value, 0.0f, 1.0f);
    return colour;
  };
  StoreCorners(mesh, colour_of, mesh.corner_colour);
}

void StoreCornerUvs(const std::vector<float>& uv, size_t first, Mesh& mesh) {
  const auto uv_of = [&](size_t v) {
    const size_t at = 2 * (v - first);
    const bool known = !uv.empty() && std::isfinite(uv[at]) && std::isfinite(uv[at + 1]);
    return known ? glm::vec2(uv[at], uv[at + 1]) : mesh.uv[v];
  };
  StoreCorners(mesh, uv_of, mesh.corner_uv);
}

}  // namespace pelt::gltf
