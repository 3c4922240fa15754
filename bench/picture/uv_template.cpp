#include "bench/picture/uv_template.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.hpp"

namespace pelt {
namespace {

// Of the longer side: lines are thinner than what lies between them, and maps are read.
constexpr uint32_t kLeastSide = 1024, kMostSide = 4096;
constexpr uint8_t kColours[][3] = {{0, 255, 255}, {0, 255, 80},  {0, 120, 255},
                                   {0, 160, 0},   {0, 160, 160}, {0, 60, 200}};

UvTemplate MakeEmpty(const Mesh& mesh, const SurfaceColour& surface) {
  UvTemplate made{kLeastSide, kLeastSide, {}};
  uint64_t most = 0;
  for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const ControlMap* image = surface.ImageOf(t);
    if (!image || uint64_t(image->width) * image->height <= most) continue;
    most = uint64_t(image->width) * image->height;
    made.width = image->width;
    made.height = image->height;
  }
  while (std::max(made.width, made.height) < kLeastSide) made.width *= 2, made.height *= 2;
  while (std::max(made.width, made.height) > kMostSide) {
    made.width = std::max(made.width / 2, 1u);
    made.height = std::max(made.height / 2, 1u);
  }
  made.rgb.assign(size_t(made.width) * made.height * 3, 0);
  return made;
}

// Where a place beyond the image's edges lies on it.
uint32_t PixelOf(double coordinate, uint32_t size, Wrap wrap) {
  double at = coordinate - std::floor(coordinate);
  if (wrap == Wrap::kMirror && std::fmod(std::floor(coordinate), 2.0) != 0.0) at = 1.0 - at;
  if (wrap == Wrap::kClamp) at = std::clamp(coordinate, 0.0, 1.0);
  return std::min(uint32_t(at * double(size)), size - 1);
}

void DrawLine(const glm::dvec2& from, const glm::dvec2& to, const std::array<Wrap, 2>& wrap,
              const uint8_t (&colour)[3], UvTemplate& made) {
  constexpr double kMostTurns = 8.0;  // round the image; what is longer is dotted
  const glm::dvec2 size(made.width, made.height), pixels = glm::abs(to - from) * size;
  const double most = kMostTurns * std::max(size.x, size.y);
  const auto steps = uint32_t(std::min(std::ceil(std::max(pixels.x, pixels.y)), most)) + 1;
  for (uint32_t i = 0; i <= steps; ++i) {
    const glm::dvec2 at = from + (to - from) * (double(i) / double(steps));
    const size_t pixel = size_t(PixelOf(at.y, made.height, wrap[1])) * made.width +
                         PixelOf(at.x, made.width, wrap[0]);
    std::copy_n(colour, 3, &made.rgb[3 * pixel]);
  }
}

}  // namespace

UvTemplate DrawUvTemplate(const Character& character, const SurfaceColour& surface) {
  const Mesh& mesh = character.mesh;
  if (mesh.uv.empty())
    throw Error(
        fmt::format("{}: no texture coordinates, by which a map would lie on it", character.name));
  UvTemplate made = MakeEmpty(mesh, surface);
  for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& corner = mesh.triangles[t];
    const auto& colour = kColours[mesh.triangle_material[t] % std::size(kColours)];
    for (size_t k = 0; k < 3; ++k)
      DrawLine(glm::dvec2(mesh.uv[corner[k]]), glm::dvec2(mesh.uv[corner[(k + 1) % 3]]),
               WrapOn(mesh, t), colour, made);
  }
  return made;
}

}  // namespace pelt
