// Poses without glTF: what an engine with an animation system of its own fills in before a frame.
//
// A PoseBlock takes up to four keys a channel, so that clips can be blended by the frame. An engine
// that has blended already gives one transform a joint: key 0 with weight 1.
#pragma once

#include <cstdint>

#include "core/chunk.hpp"
#include "core/groom/groom.hpp"

namespace pelt {

// The local transform of one joint, relative to its parent, in the units of the character file:
// translation, rotation as a unit quaternion xyzw, scale. Joints are in the order of
// Groom::joint_names, parents first.
struct JointTransform {
  float translation[3] = {0.0f, 0.0f, 0.0f};
  float rotation[4] = {0.0f, 0.0f, 0.0f, 1.0f};
  float scale[3] = {1.0f, 1.0f, 1.0f};
};
void SetJoint(PoseBlock& pose, uint32_t joint, const JointTransform& local);

// Where a point of the joint's own space lay when the mesh was bound: in mesh space. The palette
// takes it on from there.
void PlaceInMesh(const SkeletonBlock& skeleton, uint32_t joint, const float (&point)[3],
                 double (&in_mesh)[3]);

// Sets all of the pose: every joint as the mesh was bound, the character at the origin, scaled by
// the groom's unit scale. For a first frame before the animation is wired up; from then on SetJoint
// every joint, and write PoseBlock::root.
void FillBindPose(const Groom& groom, PoseBlock& pose);

}  // namespace pelt
