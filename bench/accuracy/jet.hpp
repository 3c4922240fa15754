// A number with its first and second derivative by time: motions written once as formulas give
// exact velocities and accelerations.
//
// Invariant: every function here applies the product and chain rules to second order, so a pose
// built of jets has no differencing error. The reference depends on that: a root acceleration off
// by 1e-9 would be the reference's largest error. The elementary functions are core's exact ones:
// the same exact motion on every machine, bit for bit.
#pragma once

#include <cmath>

#include "core/exact_math.hpp"

namespace pelt::accuracy {

struct Jet {
  double value = 0.0, rate = 0.0, bend = 0.0;  // f, f', f''

  constexpr Jet() = default;
  constexpr Jet(double constant) : value(constant) {}
  constexpr Jet(double v, double r, double b) : value(v), rate(r), bend(b) {}

  friend Jet operator+(Jet a, Jet b) {
    return {a.value + b.value, a.rate + b.rate, a.bend + b.bend};
  }
  friend Jet operator-(Jet a, Jet b) {
    return {a.value - b.value, a.rate - b.rate, a.bend - b.bend};
  }
  friend Jet operator-(Jet a) { return {-a.value, -a.rate, -a.bend}; }
  friend Jet operator*(Jet a, Jet b) {
    return {a.value * b.value, a.rate * b.value + a.value * b.rate,
            a.bend * b.value + 2.0 * a.rate * b.rate + a.value * b.bend};
  }
};

// f(a), given f, f' and f'' at a's value.
inline Jet Chain(Jet a, double f, double f1, double f2) {
  return {f, f1 * a.rate, f1 * a.bend + f2 * a.rate * a.rate};
}
inline Jet Sin(Jet a) {
  const double s = exact::Sin(a.value), c = exact::Cos(a.value);
  return Chain(a, s, c, -s);
}
inline Jet Cos(Jet a) {
  const double s = exact::Sin(a.value), c = exact::Cos(a.value);
  return Chain(a, c, -s, -c);
}
// tanh |x| = 1 - 2 / (exp(2 |x|) + 1).
inline double HyperbolicTangent(double x) {
  return std::copysign(1.0 - 2.0 / (exact::Exp(2.0 * std::abs(x)) + 1.0), x);
}
inline Jet Tanh(Jet a) {
  const double t = HyperbolicTangent(a.value), slope = 1.0 - t * t;
  return Chain(a, t, slope, -2.0 * t * slope);
}
// ln(2 cosh a), without overflow.
inline Jet LogTwoCosh(Jet a) {
  const double size = std::abs(a.value), t = HyperbolicTangent(a.value);
  return Chain(a, size + exact::Log(1.0 + exact::Exp(-2.0 * size)), t, 1.0 - t * t);
}

}  // namespace pelt::accuracy
