// How a built-in character moves: rotations of its joints as functions of time, sampled into keys.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

#include "core/character/builtin_shape.hpp"

namespace pelt::builtin {

inline constexpr size_t kMostJoints = 40;

// Turns about x (nod), y (turn) and z (tilt), radians, z first; and the carrier's shift, m.
struct Motion {
  std::array<glm::dvec3, kMostJoints> turn{};
  glm::dvec3 shift{0.0};
};

struct ClipPlan {
  const char* name;
  Motion (*motion)(double time_s);
  bool loops;         // its ends agree to the last bit
  double duration_s;  // with `steps` keys at equal times behind the first
  int steps;
  double held_s = 0.0;  // a last key here, if it is later
};

struct ShapeTrack {
  size_t joint;
  bool rotation;                  // else translation (local, m)
  std::vector<glm::vec4> values;  // in tangent, value, out tangent for each time
};

struct ShapeClip {
  std::string name;
  std::vector<float> time_s;
  std::vector<ShapeTrack> tracks;
};

std::vector<ShapeClip> MakeClips(const Shape& shape, std::span<const ClipPlan> plans);

// Of the bodies there are.
std::span<const ClipPlan> MonsterClips();
std::span<const ClipPlan> ScorpionClips();

// sin of so many turns.
double Wave(double turns);
// 0 to 1 as s goes from 0 to 1, at rest at both ends; constant outside.
double Ease(double s);

}  // namespace pelt::builtin
