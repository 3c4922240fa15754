#include "core/character/gltf_corners.hpp"

#include <algorithm>
#include <cmath>

#include "core/float_rules.hpp"

namespace pelt::gltf {
void StoreCornerColours(const std::vector<float>& colours, size_t size, size_t first, Mesh& mesh) {
  const auto colour_of = [&](size_t v) {
    glm::vec4 colour(1.0f);
    for (size_t c = 0; c < size && !colours.empty(); ++c)
      if (const float value = colours[(v - first) * size + c]; std::isfinite(value))
        colour[int(c)] = std::clamp(value, 0.0f, 1.0f);
    return colour;
  };
  for (size_t t = mesh.corner_colour.size(); t < mesh.triangles.size(); ++t) {
    const auto& v = mesh.triangles[t];
    mesh.corner_colour.push_back({colour_of(v[0]), colour_of(v[1]), colour_of(v[2])});
  }
}

}  // namespace pelt::gltf
