#include "bench/accuracy/rest_shape.hpp"

#include <algorithm>

namespace pelt::accuracy {
namespace {

// A cubic spline through points at equal steps of s, whose first two and last two parts are one cubic each.
struct Spline {
  explicit Spline(std::vector<Double3> points) : point(std::move(points)), second(point.size()) {
    const size_t n = point.size() - 1;
    // Each row's diagonal is four times what is beside it: a sweep leaves at most half of what is wrong.
    constexpr int kSweeps = 60;
    for (int sweep = 0; sweep < kSweeps; ++sweep)
      for (size_t k = 1; k < n; ++k) {
        const Double3 bend =
            (point[k + 1] - point[k] * 2.0 + point[k - 1]) * (6.0 * double(n) * double(n));
        const bool end = k == 1 || k + 1 == n;
        second[k] = end ? bend * (1.0 / 6.0) : (bend - second[k - 1] - second[k + 1]) * (1.0 / 4.0);
      }
    second[0] = second[1] * 2.0 - second[2];
    second[n] = second[n - 1] * 2.0 - second[n - 2];
  }

  // The first and second derivative.
  void At(double s, Double3& rate, Double3& bend) const {
    const double n = double(point.size() - 1);
    const size_t k = std::min(size_t(s * n), point.size() - 2);
    const double u = s * n - double(k), v = 1.0 - u;
    rate =
        (point[k + 1] - point[k]) * n +
        (second[k + 1] * (3.0 * u * u - 1.0) - second[k] * (3.0 * v * v - 1.0)) * (1.0 / (6.0 * n));
    bend = second[k] * v + second[k + 1] * u;
  }

  std::vector<Double3> point, second;
};

}  // namespace

RestShape ThroughPoints(const std::vector<Double3>& points) {
  const Spline spline(points);
  return {kZero3,
          [spline](double s) {
            Double3 rate, bend;
            spline.At(s, rate, bend);
            return Unit(rate);
          },
          [spline](double s) {
            Double3 rate, bend;
            spline.At(s, rate, bend);
            const Double3 tangent = Unit(rate);
            return (bend - tangent * Dot(tangent, bend)) * (1.0 / Length(rate));
          }};
}

}  // namespace pelt::accuracy
