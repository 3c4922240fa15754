// Characters with origins of their own: where each is, by how much it moved, and what the rest of a
// frame is, relative to it.
//
// The idea: floats are as fine as a hundredth of a hair's width within metres of where they are
// measured from, and 1 mm at 10 km. So a character's pose, state and vertices are relative to an
// origin near it, given in double; all other input of a frame is moved there in double and rounded
// once. A frame may have an origin too, which its own places are relative to.
//
// Invariant: where the frame's origin is the character's, everything keeps its bits.
#pragma once

#include <span>
#include <vector>

#include "core/frame_input.hpp"
#include "core/view.hpp"

namespace pelt {

// Origins lie within this of the world's, m.
inline constexpr double kFarthestOrigin_m = 1.0e7;

struct CharacterOrigin {
  double used[3] = {};  // what the pose that is in use is relative to
  float shift[3] = {};  // from the last frame's to that
  bool shifted = false, was_shifted = false;

  // All of it, for an archive (jobs/scene_snapshot.cpp).
  static void ListState(auto& io, auto& self) {
    io(self.used);
    io(self.shift);
    io(self.shifted);
    io(self.was_shifted);
  }

  // Uses what is given for this frame; or, with a pose that is kept (null), what was used.
  void Advance(const double* given);
};

bool IsOriginUsable(const double* origin);

// A vector between origins, m.
struct Offset {
  double step[3];
  bool IsNone() const { return step[0] == 0.0 && step[1] == 0.0 && step[2] == 0.0; }
  // A place that is relative to where the step begins, made relative to where it ends.
  float Place(float place, int axis) const {
    return step[axis] == 0.0 ? place : float(double(place) - step[axis]);
  }
};
inline Offset OffsetBetween(const double (&from)[3], const double (&to)[3]) {
  return {{to[0] - from[0], to[1] - from[1], to[2] - from[2]}};
}

// Obstacles, lights, brushes and force volumes. What is bound to joints is relative to its character's
// origin, and stays; the camera's place among floats is too coarse to be moved: MoveView.
void MovePlaces(const Offset& offset, FrameInput& input);
void MoveView(const Offset& offset, View& view);

}  // namespace pelt
