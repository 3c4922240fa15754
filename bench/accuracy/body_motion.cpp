#include "bench/accuracy/body_motion.hpp"

#include "bench/accuracy/body_angles.hpp"

namespace pelt::accuracy {
namespace {

BodyAngles Walk(Jet t) {
  const Jet on = Rise(t, 0.5, 0.1);
  const Jet phase = Jet(kTurn * 1.8) * t;
  BodyAngles a;
  a.position.x = Jet(0.03) * on * Sin(phase) + Jet(0.8) * Ramp(t, 0.5, 0.1);
  a.position.y = Jet(0.02) * on * Sin(phase * 2.0);
  a.position.z = Jet(0.02) * on * Sin(phase + 0.5);
  a.yaw = Jet(0.15) * on * Sin(phase);
  a.roll = Jet(0.08) * on * Sin(phase + 1.0);
  a.pitch = Jet(0.10) * on * Sin(phase * 2.0 + 0.3);
  return a;
}

BodyAngles Headshake(Jet t) {
  const Jet strength = Rise(t, 0.5, 0.1) * (Jet(1.0) - Rise(t, 2.5, 0.08));
  BodyAngles a;
  a.yaw = Jet(0.7) * strength * Sin(Jet(kTurn * 2.0) * t);
  a.pitch = Jet(0.15) * strength * Sin(Jet(kTurn * 1.3) * t);
  return a;
}

BodyAngles Dash(Jet t) {
  BodyAngles a;
  a.position.x = Jet(1.5) * (Ramp(t, 0.6, 0.06) - Ramp(t, 1.5, 0.06));
  a.position.y = Jet(0.2) * (Rise(t, 3.0, 0.08) - Rise(t, 3.4, 0.08));
  a.yaw = Jet(kTurn / 3.0) * Rise(t, 2.2, 0.1);
  return a;
}

BodyAngles Violent(Jet t) {
  BodyAngles a;
  a.position.x = Jet(2.0) * (Ramp(t, 0.5, 0.03) - Ramp(t, 1.5, 0.02));
  a.position.y = Jet(0.3) * (Rise(t, 3.0, 0.04) - Rise(t, 3.4, 0.04));
  a.yaw = Jet(kTurn / 3.0) * Rise(t, 2.2, 0.05);
  return a;
}

Double3 Gust(double t) {
  const double strength = Rise(t, 0.6, 0.1).value - Rise(t, 2.0, 0.1).value;
  return Double3{4.0 + 1.5 * exact::Sin(kTurn * 2.3 * t), 0.0, exact::Sin(kTurn * 1.1 * t)} *
         strength;
}

}  // namespace

BodyPose ToPose(const BodyAngles& a) {
  const Jet cr = Cos(a.roll), sr = Sin(a.roll), cp = Cos(a.pitch), sp = Sin(a.pitch);
  const Jet cy = Cos(a.yaw), sy = Sin(a.yaw);
  const auto image = [&](Jet3 q) -> Jet3 {
    q = {cr * q.x - sr * q.y, sr * q.x + cr * q.y, q.z};
    q = {q.x, cp * q.y - sp * q.z, sp * q.y + cp * q.z};
    return {cy * q.x + sy * q.z, q.y, cy * q.z - sy * q.x};
  };
  const auto split = [](Jet3 j, Double3& value, Double3& rate, Double3& bend) {
    value = {j.x.value, j.y.value, j.z.value};
    rate = {j.x.rate, j.y.rate, j.z.rate};
    bend = {j.x.bend, j.y.bend, j.z.bend};
  };
  BodyPose pose;
  split(a.position, pose.position, pose.velocity, pose.acceleration);
  for (int k = 0; k < 3; ++k) {
    const Jet3 unit = {Jet(k == 0), Jet(k == 1), Jet(k == 2)};
    split(image(unit), pose.axis[k], pose.axis_rate[k], pose.axis_bend[k]);
  }
  pose.wind = kZero3;
  return pose;
}

Double3 SpinOf(const BodyPose& pose) {
  Double3 spin = kZero3;
  for (int k = 0; k < 3; ++k) spin = spin + Cross(pose.axis[k], pose.axis_rate[k]) * 0.5;
  return spin;
}

BodyPose StillPose() { return ToPose(BodyAngles{}); }

BodyPose PoseOf(Motion motion, double t) {
  const Jet now(t, 1.0, 0.0);
  switch (motion) {
    case Motion::kWalk:
      return ToPose(Walk(now));
    case Motion::kHeadshake:
      return ToPose(Headshake(now));
    case Motion::kDash:
      return ToPose(Dash(now));
    case Motion::kViolent:
      return ToPose(Violent(now));
    case Motion::kStill:
      return StillPose();
    case Motion::kWind:
      break;
  }
  BodyPose pose = StillPose();
  pose.wind = Gust(t);
  return pose;
}

BodyMotion MotionOf(Motion motion) {
  return [motion](double t) { return PoseOf(motion, t); };
}

std::string_view MotionName(Motion motion) {
  switch (motion) {
    case Motion::kStill:
      return "still";
    case Motion::kWalk:
      return "walk";
    case Motion::kHeadshake:
      return "headshake";
    case Motion::kDash:
      return "dash";
    case Motion::kWind:
      return "wind";
    case Motion::kViolent:
      break;
  }
  return "violent";
}

}  // namespace pelt::accuracy
