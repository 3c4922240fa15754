#include "core/groom/height_field.hpp"

#include <algorithm>

#include "core/error.hpp"
#include "core/float_rules.hpp"
#include "core/format.hpp"
#include "core/random.hpp"

namespace pelt {
namespace {

struct Dot {
  double x, y;    // of its middle, cells from the tile's corner
  double height;  // 0 to 1
  double radius;  // cells, at most 1: a dot reaches no further than the next cells
};

}  // namespace

std::vector<uint8_t> MakeHeightField(uint32_t side, uint32_t dots_a_side, uint64_t seed) {
  constexpr uint32_t kMostSide = 4096;
  if (side < 1 || side > kMostSide || dots_a_side < 1 || dots_a_side > side)
    throw Error(
        Format("height field: {} dots on {} texels a side; 1 to {} texels are allowed, and "
               "no more dots",
               dots_a_side, side, kMostSide));
  std::vector<Dot> dots(size_t(dots_a_side) * dots_a_side);
  for (size_t i = 0; i < dots.size(); ++i) {
    Random random(MixSeed(seed, i));
    const size_t column = i % dots_a_side, row = i / dots_a_side;
    dots[i].x = double(column) + random.Uniform();
    dots[i].y = double(row) + random.Uniform();
    dots[i].height = random.Uniform(0.35, 1.0);
    dots[i].radius = random.Uniform(0.6, 1.0);
  }
  const auto n = int64_t(dots_a_side);
  const double cells_per_texel = double(dots_a_side) / double(side);
  // The highest dot over a place, from its own cell and those round it.
  const auto height_at = [&](double x, double y) {
    const auto column = int64_t(x), row = int64_t(y);
    double most = 0.0;
    for (int64_t j = row - 1; j <= row + 1; ++j)
      for (int64_t i = column - 1; i <= column + 1; ++i) {
        const Dot& dot = dots[size_t((j + n) % n * n + (i + n) % n)];
        // Beyond an edge the tile begins again.
        const double turn_x = i < 0 ? -double(n) : i >= n ? double(n) : 0.0;
        const double turn_y = j < 0 ? -double(n) : j >= n ? double(n) : 0.0;
        const double dx = dot.x + turn_x - x, dy = dot.y + turn_y - y;
        const double square = (dx * dx + dy * dy) / (dot.radius * dot.radius);
        most = std::max(most, dot.height * (1.0 - square));
      }
    return most;
  };
  std::vector<uint8_t> heights(size_t(side) * side);
  for (uint32_t y = 0; y < side; ++y)
    for (uint32_t x = 0; x < side; ++x) {
      const double middle_x = (double(x) + 0.5) * cells_per_texel;
      const double middle_y = (double(y) + 0.5) * cells_per_texel;
      heights[size_t(y) * side + x] = uint8_t(0.5 + 255.0 * height_at(middle_x, middle_y));
    }
  return heights;
}

}  // namespace pelt
