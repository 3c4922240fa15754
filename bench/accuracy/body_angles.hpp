// What the motions of body_motion.hpp are written in: position and angles as functions of time, made
// of waves and of smooth steps.
//
// Written once as formulas of jets, they have exact velocities and accelerations. A root acceleration off by 1e-9 would
// be the reference's largest error. The elementary functions are core's exact ones: the same exact motion on every
// machine, bit for bit.
#pragma once

#include <cmath>
#include <numbers>

#include "bench/accuracy/body_motion.hpp"
#include "core/exact_math.hpp"

namespace pelt::accuracy {

inline constexpr double kTurn = 2.0 * std::numbers::pi;  // rad

// A number with its first and second derivative by time. Every function of it applies the product and chain rules to
// second order: no differencing error.
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

using Jet3 = Vec3<Jet>;

struct BodyAngles {
  Jet3 position;  // m
  Jet yaw, pitch, roll;
};

// (1 + tanh((t - t0) / w)) / 2, and its integral from minus infinity.
inline Jet Rise(Jet t, double t0, double w) {
  return Jet(0.5) * (Jet(1.0) + Tanh((t - t0) * (1.0 / w)));
}
inline Jet Ramp(Jet t, double t0, double w) {
  return Jet(0.5) * ((t - t0) + Jet(w) * LogTwoCosh((t - t0) * (1.0 / w)));
}

// No wind.
BodyPose ToPose(const BodyAngles& angles);

}  // namespace pelt::accuracy
