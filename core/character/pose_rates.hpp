// How fast the joints of a clip's pose move: the derivative of its interpolation, exactly.
//
// Splines are smooth at their keys; straight lines and great circles are not. There the velocity
// is the mean of both sides: a body that is drawn through a corner by two frames with it turns as
// much before the key as after. At the ends of a track it is that of the one side there is, and
// beyond them nothing moves.
// Source: glTF 2.0, appendix C; spin = 2 q' q^-1.
#pragma once

#include "core/character/character.hpp"
#include "core/chunk.hpp"

namespace pelt {

// Writes all of `rates`, with `given` 1, for the pose that FillPose makes of the same clip, time and
// `loop`. Does not allocate.
//  speed      how fast the clip runs: its seconds a second
//  root_rate  derivative of FillPose's root by time, 1/s; 0 where the character stands still
void FillPoseRates(const Clip* clip, double time_s, bool loop, double speed,
                   const glm::mat4& root_rate, PoseRateBlock* rates);

}  // namespace pelt
