// Idea: see builtin_clips.hpp. Motions are sums of sines of exact:: functions; cubic tangents are
// central differences of the same functions, so the splines are smooth at every key and across the
// loop.
#include "core/character/builtin_clips.hpp"

#include <array>
#include <cmath>

#include "core/exact_math.hpp"
#include "core/float_rules.hpp"

namespace pelt::builtin {
namespace {

constexpr double kTwoPi = 2.0 * exact::kPi;

// Turns about x (nod), y (turn) and z (tilt), radians, z first; and the hips' shift, m.
struct Motion {
  std::array<glm::dvec3, kJointCount> turn{};
  glm::dvec3 hips{0.0};
};

glm::dvec4 Multiply(const glm::dvec4& a, const glm::dvec4& b) {  // xyzw
  return {
      a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y, a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
      a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w, a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z};
}

glm::dvec4 ToQuaternion(const glm::dvec3& turn) {
  const glm::dvec4 x(exact::Sin(turn.x / 2), 0, 0, exact::Cos(turn.x / 2));
  const glm::dvec4 y(0, exact::Sin(turn.y / 2), 0, exact::Cos(turn.y / 2));
  const glm::dvec4 z(0, 0, exact::Sin(turn.z / 2), exact::Cos(turn.z / 2));
  return Multiply(y, Multiply(x, z));
}

double Wave(double phase) { return exact::Sin(kTwoPi * phase); }

// One step with each leg a second.
Motion Walk(double t) {
  Motion m;
  m.hips = {0.018 * Wave(t), -0.012 - 0.022 * Wave(2 * t + 0.1), 0.0};
  m.turn[kHips] = {0.04 * Wave(2 * t), 0.14 * Wave(t + 0.25), 0.07 * Wave(t)};
  m.turn[kSpine] = {0.05, -0.12 * Wave(t + 0.25), -0.08 * Wave(t)};
  m.turn[kChest] = {0.03 * Wave(2 * t + 0.2), -0.14 * Wave(t + 0.25), -0.05 * Wave(t)};
  m.turn[kNeck] = {0.05 * Wave(2 * t + 0.4), 0.08 * Wave(t + 0.25), 0.0};
  m.turn[kHeadJoint] = {0.09 * Wave(2 * t + 0.55), 0.06 * Wave(t + 0.3), 0.08 * Wave(t + 0.1)};
  for (int side = 0; side < 2; ++side) {
    const double p = side ? t + 0.5 : t;
    const double mirror = side ? -1.0 : 1.0;
    m.turn[side ? kBrowR : kBrowL] = {0.10 * Wave(2 * t + 0.6), 0.0, 0.12 * Wave(2 * p) * mirror};
    m.turn[side ? kThighR : kThighL] = {-0.52 * Wave(p), 0.0, 0.04 * mirror};
    m.turn[side ? kShinR : kShinL] = {0.42 * (1.0 - Wave(p - 0.08)) * 0.9, 0.0, 0.0};
    m.turn[side ? kFootR : kFootL] = {-0.12 + 0.30 * Wave(p - 0.2), 0.0, 0.0};
    m.turn[side ? kShoulderR : kShoulderL] = {0.62 * Wave(p), 0.0,
                                              (-0.22 + 0.06 * Wave(2 * t)) * mirror};
    m.turn[side ? kElbowR : kElbowL] = {-0.45 - 0.30 * Wave(p + 0.6), 0.0, 0.0};
    m.turn[side ? kHandR : kHandL] = {0.25 * Wave(p + 0.75), 0.0, 0.10 * Wave(p) * mirror};
  }
  for (int i = 0; i < 4; ++i)
    m.turn[size_t(kTail1 + i)] = {0.10 * Wave(2 * t - 0.12 * i), 0.26 * Wave(t - 0.13 * i), 0.0};
  return m;
}

double Ease(double s) {
  s = s < 0.0 ? 0.0 : s > 1.0 ? 1.0 : s;
  return s * s * (3.0 - 2.0 * s);
}

// From the rest pose into a relaxed stand in half a second.
Motion Idle(double t) {
  const double e = Ease(t / 0.5);
  Motion m;
  m.hips = {0.015 * e, -0.01 * e, 0.0};
  m.turn[kSpine] = {0.04 * e, 0.0, 0.05 * e};
  m.turn[kHeadJoint] = {0.06 * e, 0.15 * e, -0.08 * e};
  for (int side = 0; side < 2; ++side) {
    const double mirror = side ? -1.0 : 1.0;
    m.turn[side ? kShoulderR : kShoulderL] = {0.0, 0.0, -0.25 * e * mirror};
    m.turn[side ? kElbowR : kElbowL] = {-0.25 * e, 0.0, 0.0};
    m.turn[side ? kThighR : kThighL] = {-0.06 * e, 0.0, 0.05 * e * mirror};
    m.turn[side ? kShinR : kShinL] = {0.10 * e, 0.0, 0.0};
  }
  for (int i = 0; i < 4; ++i) m.turn[size_t(kTail1 + i)] = {0.05 * e, 0.10 * e, 0.0};
  return m;
}

// Five swings a second for one second, swelling and fading, then still.
Motion Shake(double t) {
  const double s = t < 1.0 ? exact::Sin(exact::kPi * t) : 0.0;
  const double swell = s * s;
  Motion m;
  m.turn[kHeadJoint] = {0.15 * swell, 0.50 * swell * Wave(5 * t), 0.30 * swell * Wave(5 * t + 0.1)};
  m.turn[kNeck] = {0.10 * swell, 0.25 * swell * Wave(5 * t - 0.05), 0.0};
  m.turn[kChest] = {0.0, 0.18 * swell * Wave(5 * t - 0.12), 0.0};
  m.turn[kSpine] = {0.08 * swell, 0.14 * swell * Wave(5 * t - 0.2), 0.0};
  m.turn[kHips] = {0.0, 0.10 * swell * Wave(5 * t - 0.3), 0.0};
  m.turn[kBrowL] = {0.0, 0.0, 0.35 * swell * Wave(5 * t + 0.2)};
  m.turn[kBrowR] = {0.0, 0.0, 0.35 * swell * Wave(5 * t + 0.2)};
  m.turn[kShoulderL] = {0.0, 0.0, swell * (0.15 + 0.20 * Wave(5 * t))};
  m.turn[kShoulderR] = {0.0, 0.0, swell * (-0.15 + 0.20 * Wave(5 * t))};
  for (int i = 0; i < 4; ++i)
    m.turn[size_t(kTail1 + i)] = {0.0, 0.22 * swell * Wave(5 * t - 0.35 - 0.1 * i), 0.0};
  return m;
}

struct ClipPlan {
  const char* name;
  Motion (*motion)(double);
  bool cubic;
  bool loops;
  std::vector<double> times;
};

std::vector<double> EvenTimes(double duration, int steps) {
  std::vector<double> times;
  for (int i = 0; i <= steps; ++i) times.push_back(duration * i / steps);
  return times;
}

glm::dvec4 ValueOf(const Motion& motion, Joint joint, bool rotation, const Shape& shape) {
  if (rotation) return ToQuaternion(motion.turn[joint]);
  const glm::dvec3 local = shape.joints[kHips].position - shape.joints[kRoot].position;
  return glm::dvec4(local + motion.hips, 0.0);
}

ShapeTrack SampleTrack(const ClipPlan& plan, Joint joint, bool rotation, const Shape& shape,
                       bool* moves) {
  ShapeTrack track{joint, rotation, {}};
  *moves = false;
  const glm::dvec4 rest = ValueOf(Motion{}, joint, rotation, shape);
  for (double t : plan.times) {
    const glm::dvec4 value = ValueOf(plan.motion(t), joint, rotation, shape);
    *moves |= value != rest;
    glm::dvec4 slope(0.0);
    if (plan.cubic) {
      const double e = 1.0 / 8192;
      slope = (ValueOf(plan.motion(t + e), joint, rotation, shape) -
               ValueOf(plan.motion(t - e), joint, rotation, shape)) *
              (0.5 / e);
      track.values.push_back(glm::vec4(slope));
    }
    track.values.push_back(glm::vec4(value));
    if (plan.cubic) track.values.push_back(glm::vec4(slope));
  }
  // The ends of a loop agree to the last bit.
  if (plan.loops) {
    const size_t per_key = plan.cubic ? 3 : 1;
    for (size_t i = 0; i < per_key; ++i)
      track.values[track.values.size() - per_key + i] = track.values[i];
  }
  return track;
}

}  // namespace

std::vector<ShapeClip> MakeClips(const Shape& shape) {
  std::vector<double> idle_times = EvenTimes(0.5, 15);
  idle_times.push_back(60.0);
  const ClipPlan plans[] = {{"walk", Walk, true, true, EvenTimes(1.0, 16)},
                            {"idle", Idle, false, false, idle_times},
                            {"shake", Shake, false, true, EvenTimes(1.6, 64)}};
  std::vector<ShapeClip> clips;
  for (const ClipPlan& plan : plans) {
    ShapeClip clip{plan.name, plan.cubic, {}, {}};
    for (double t : plan.times) clip.time_s.push_back(float(t));
    for (int joint = 0; joint < kJointCount; ++joint) {
      for (bool rotation : {false, true}) {
        if (!rotation && joint != kHips) continue;
        bool moves;
        ShapeTrack track = SampleTrack(plan, Joint(joint), rotation, shape, &moves);
        if (moves) clip.tracks.push_back(std::move(track));
      }
    }
    clips.push_back(std::move(clip));
  }
  return clips;
}

}  // namespace pelt::builtin
