// From clips to the frame's input, poses and how fast they move, and the rest pose that grooming measures on.
//
// The frame's pose kernel blends up to four keys a channel with given weights, so all that differs
// between step, slerp and cubic splines is worked out here, on the caller's thread, in double and
// with exact:: functions: the same bits everywhere.
// Source: glTF 2.0, appendix C (interpolation); Shoemake 1985 (slerp); spin = 2 q' q^-1.
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <string>

#include "core/character/character.hpp"
#include "core/chunk.hpp"

namespace pelt {

// Writes the pose at `time_s` into `pose` without allocating: keys, weights, root and joint_count;
// `teleported` is left as it is. `pose` must be zero or hold an earlier pose of the same skeleton:
// lanes past the last group of joints are not touched (lanes that complete the group get a copy of
// the last joint).
//  clip    null: the rest pose. Channels without a track rest.
//  time_s  with `loop`, taken modulo the clip's duration; without, held at both ends. A time that
//          is not finite counts as 0.
//  root    skeleton space to world, affine; must carry the unit scale (see PlaceCharacter).
// Cost: 5 us for 25 joints, 9 us for 53 (one shared Xeon core, 21 and 49 tracks).
void FillPose(const Skeleton& skeleton, const Clip* clip, double time_s, bool loop,
              const glm::mat4& root, PoseBlock* pose);

// The same as a value. PoseBlock is large (54 KB): for set-up and tests.
PoseBlock MakePose(const Skeleton& skeleton, const Clip* clip, double time_s, bool loop,
                   const glm::mat4& root);

// How fast the joints of that pose move: the derivative of its interpolation, exactly.
//
// Splines are smooth at their keys; straight lines and great circles are not. There the velocity
// is the mean of both sides: a body that is drawn through a corner by two frames with it turns as
// much before the key as after. At the ends of a track it is that of the one side there is, and
// beyond them nothing moves.
//
// Writes all of `rates`, with `given` 1, for the pose that FillPose makes of the same clip, time and
// `loop`. Does not allocate.
//  speed      how fast the clip runs: its seconds a second
//  root_rate  derivative of FillPose's root by time, 1/s; 0 where the character stands still
void FillPoseRates(const Clip* clip, double time_s, bool loop, double speed,
                   const glm::mat4& root_rate, PoseRateBlock* rates);

// placement * scale: what FillPose wants as root for a character with this unit scale.
glm::mat4 PlaceCharacter(const glm::mat4& placement, float unit_scale);

// Into the parent's space.
glm::dmat4 MatrixOf(const JointPose& pose);

SkeletonBlock MakeSkeletonBlock(const Skeleton& skeleton);

// The clip of that name; null for none.
const Clip* FindClip(const Character& character, const std::string& name);

// Skins the mesh in its rest pose: position in metres (file units * unit_scale); normals and
// tangents by the upper 3x3 of the blended matrix, as the skin kernel does, then made unit and
// orthogonal. In double.
RestGeometry ComputeRestGeometry(const Character& character, float unit_scale);

struct BoundingBox {
  glm::vec3 low, high;

  glm::vec3 Size() const { return high - low; }
  double LargestSide() const;
};
// Of at least one place.
BoundingBox BoundPlaces(std::span<const glm::vec3> places);

// Makes normals what ComputeRestGeometry and the skin kernel turn into those of the rest pose: both
// take them as directions, which is right while joints are scaled alike along all axes. Where they
// are not, in the rest pose, the mesh's normals and tangents are changed so that there, and in poses
// that turn it, they are exact. Returns how many were.
size_t FitNormalsToRest(Character* character);

struct UnitScale {
  float metres_per_unit = 1.0f;
  std::string sentence;  // for the user: what was assumed and how to change it
};

// The power of ten that brings the rest pose's largest extent into [0.3, 3) m.
UnitScale DefaultUnitScale(const Character& character);

}  // namespace pelt
