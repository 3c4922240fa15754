// How the built-in monster moves: rotations of its joints as functions of time, sampled into keys.
#pragma once

#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "core/character/builtin_shape.hpp"

namespace pelt::builtin {

struct ShapeTrack {
  Joint joint;
  bool rotation;                  // else translation (local, m)
  std::vector<glm::vec4> values;  // cubic: in tangent, value, out tangent for each time
};

struct ShapeClip {
  std::string name;
  bool cubic;  // else linear
  std::vector<float> time_s;
  std::vector<ShapeTrack> tracks;
};

std::vector<ShapeClip> MakeClips(const Shape& shape);

}  // namespace pelt::builtin
