// How the body moves: the motions of the yardstick, and any other, as a function of time with exact
// derivatives.
//
// A point q of the body is at c + Ry(yaw) Rx(pitch) Rz(roll) q, y up, at rest in the identity pose
// for t -> -infinity. Numbers are those of the motions the errors in this project are stated for;
// they are numbered as there (4 was given up).
#pragma once

#include <functional>
#include <string_view>

#include "bench/accuracy/double3.hpp"

namespace pelt::accuracy {

// A rotation (its columns) and a translation, with derivatives by time.
struct BodyPose {
  Double3 position, velocity, acceleration;     // m, m/s, m/s^2
  Double3 axis[3], axis_rate[3], axis_bend[3];  // images of x, y, z; 1/s, 1/s^2
  Double3 wind;                                 // m/s

  Double3 Turn(Double3 q) const { return axis[0] * q.x + axis[1] * q.y + axis[2] * q.z; }
  Double3 TurnRate(Double3 q) const {
    return axis_rate[0] * q.x + axis_rate[1] * q.y + axis_rate[2] * q.z;
  }
  Double3 TurnBend(Double3 q) const {
    return axis_bend[0] * q.x + axis_bend[1] * q.y + axis_bend[2] * q.z;
  }
  Double3 Place(Double3 q) const { return position + Turn(q); }
  Double3 PlaceRate(Double3 q) const { return velocity + TurnRate(q); }
  Double3 PlaceBend(Double3 q) const { return acceleration + TurnBend(q); }
};
Double3 SpinOf(const BodyPose& pose);  // rad/s, world

// t in seconds to pose. Must be smooth: the reference is of eighth order.
using BodyMotion = std::function<BodyPose(double)>;

enum class Motion { kStill = 0, kWalk = 1, kHeadshake = 2, kDash = 3, kWind = 5, kViolent = 6 };
inline constexpr double kMotionSeconds = 4.0;

BodyPose StillPose();
BodyPose PoseOf(Motion motion, double t);
BodyMotion MotionOf(Motion motion);
std::string_view MotionName(Motion motion);  // "walk", "headshake", ...

}  // namespace pelt::accuracy
