// What the motions of body_motion.hpp are written in: position and angles as functions of time, made
// of waves and of smooth steps.
#pragma once

#include <numbers>

#include "bench/accuracy/body_motion.hpp"
#include "bench/accuracy/jet.hpp"

namespace pelt::accuracy {

inline constexpr double kTurn = 2.0 * std::numbers::pi;  // rad

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
