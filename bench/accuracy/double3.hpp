// Three doubles and what the yardstick does with them.
#pragma once

#include <cmath>

#include "core/exact_math.hpp"
#include "core/simd/maths.hpp"

namespace pelt::accuracy {

using Double3 = Vec3<double>;

inline constexpr Double3 kZero3 = {0.0, 0.0, 0.0};

inline double Length(Double3 a) { return std::sqrt(Dot(a, a)); }
inline Double3 Unit(Double3 a) { return a * (1.0 / Length(a)); }
inline Double3 operator-(Double3 a) { return {-a.x, -a.y, -a.z}; }
// v turned about the unit axis by `angle`, rad (Rodrigues).
inline Double3 TurnAbout(Double3 v, Double3 axis, double angle) {
  const double c = exact::Cos(angle), s = exact::Sin(angle);
  return v * c + Cross(axis, v) * s + axis * ((1.0 - c) * Dot(axis, v));
}
inline bool IsFinite(Double3 a) {
  return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}

}  // namespace pelt::accuracy
