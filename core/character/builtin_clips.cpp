// Idea: see builtin_shape.hpp. Motions are sums of sines of exact:: functions; tangents are
// central differences of the same functions, so the splines are smooth at every key and across the
// loop.
#include <cmath>

#include "core/character/builtin_shape.hpp"
#include "core/exact_math.hpp"
#include "core/float_rules.hpp"

namespace pelt::builtin {
namespace {

constexpr double kTwoPi = 2.0 * exact::kPi;

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

std::vector<double> TimesOf(const ClipPlan& plan) {
  std::vector<double> times;
  for (int i = 0; i <= plan.steps; ++i) times.push_back(plan.duration_s * i / plan.steps);
  if (plan.held_s > plan.duration_s) times.push_back(plan.held_s);
  return times;
}

glm::dvec4 ValueOf(const Motion& motion, size_t joint, bool rotation, const Shape& shape) {
  if (rotation) return ToQuaternion(motion.turn[joint]);
  const JointPlace& carrier = shape.joints[shape.carrier];
  const glm::dvec3 local = carrier.position - shape.joints[size_t(carrier.parent)].position;
  return glm::dvec4(local + motion.shift, 0.0);
}

ShapeTrack SampleTrack(const ClipPlan& plan, std::span<const double> times, size_t joint,
                       bool rotation, const Shape& shape, bool* moves) {
  ShapeTrack track{joint, rotation, {}};
  *moves = false;
  const glm::dvec4 rest = ValueOf(Motion{}, joint, rotation, shape);
  for (double t : times) {
    const glm::dvec4 value = ValueOf(plan.motion(t), joint, rotation, shape);
    *moves |= value != rest;
    const double e = 1.0 / 8192;
    const bool holds = plan.held_s > 0.0 && t >= plan.duration_s;  // still, bit for bit
    const glm::vec4 slope((ValueOf(plan.motion(t + e), joint, rotation, shape) -
                           ValueOf(plan.motion(t - e), joint, rotation, shape)) *
                          (holds ? 0.0 : 0.5 / e));
    track.values.insert(track.values.end(), {slope, glm::vec4(value), slope});
  }
  // The ends of a loop agree to the last bit.
  if (plan.loops)
    for (size_t i = 0; i < 3; ++i) track.values[track.values.size() - 3 + i] = track.values[i];
  return track;
}

}  // namespace

double Wave(double phase) { return exact::Sin(kTwoPi * phase); }

double Ease(double s) {
  s = s < 0.0 ? 0.0 : s > 1.0 ? 1.0 : s;
  return s * s * (3.0 - 2.0 * s);
}

std::vector<ShapeClip> MakeClips(const Shape& shape, std::span<const ClipPlan> plans) {
  std::vector<ShapeClip> clips;
  for (const ClipPlan& plan : plans) {
    ShapeClip clip{plan.name, {}, {}};
    const std::vector<double> times = TimesOf(plan);
    for (double t : times) clip.time_s.push_back(float(t));
    for (size_t joint = 0; joint < shape.joints.size(); ++joint) {
      for (bool rotation : {false, true}) {
        if (!rotation && joint != shape.carrier) continue;
        bool moves;
        ShapeTrack track = SampleTrack(plan, times, joint, rotation, shape, &moves);
        if (moves) clip.tracks.push_back(std::move(track));
      }
    }
    clips.push_back(std::move(clip));
  }
  return clips;
}

}  // namespace pelt::builtin
