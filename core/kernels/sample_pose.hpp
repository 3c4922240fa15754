// Blends the keys of a clip into the local pose of every joint.
//
// The caller's thread finds the keys and their weights (it alone knows the clip); this kernel does
// the arithmetic, lanes are joints. Step, linear, spherical and cubic-spline interpolation are all
// one weighted sum of four keys (glTF 2.0, appendix C), so there is one path.
//
// Invariant: rotations come out unit; a sum that vanishes becomes the identity. Joints beyond
// joint_count come out as the identity, so the block is the same bits wherever it is made.
#pragma once

#include <string_view>

#include "core/chunk.hpp"
#include "core/kernel.hpp"
#include "core/streams.hpp"

namespace pelt {

template <class V>
struct SamplePose {
  static constexpr std::string_view kName = "sample_pose";
  struct Ports {
    In<&Streams::pose> pose;
    Out<&Streams::local_pose> local;
  };

  static void Run(const Ports& ports) {
    const PoseBlock& pose = *ports.pose;
    LocalPoseBlock& local = *ports.local;
    const uint32_t lanes = RoundUpToLaneGroups(pose.joint_count);
    for (uint32_t j = 0; j < lanes; j += V::kLanes) {
      for (int c = 0; c < 3; ++c) {
        BlendKeys(pose.translation_key, pose.translation_weight, c, j)
            .Store(local.translation[c] + j);
        BlendKeys(pose.scale_key, pose.scale_weight, c, j).Store(local.scale[c] + j);
      }
      SampleRotations(pose, local, j);
    }
    // Whole block: joints not in use, in the last group too, must not carry what was there before.
    for (uint32_t j = pose.joint_count; j < kJointsPerCharacter; ++j) {
      for (int c = 0; c < 3; ++c) {
        local.translation[c][j] = 0.0f;
        local.rotation[c][j] = 0.0f;
        local.scale[c][j] = 1.0f;
      }
      local.rotation[3][j] = 1.0f;
    }
  }

 private:
  template <int N>
  static PELT_INLINE V BlendKeys(const float (&key)[4][N][kJointsPerCharacter],
                                 const float (&weight)[4][kJointsPerCharacter], int component,
                                 uint32_t joint) {
    V sum = V::Load(key[0][component] + joint) * V::Load(weight[0] + joint);
    for (int k = 1; k < 4; ++k)
      sum = sum + V::Load(key[k][component] + joint) * V::Load(weight[k] + joint);
    return sum;
  }

  static PELT_INLINE void SampleRotations(const PoseBlock& pose, LocalPoseBlock& local,
                                          uint32_t joint) {
    const V x = BlendKeys(pose.rotation_key, pose.rotation_weight, 0, joint);
    const V y = BlendKeys(pose.rotation_key, pose.rotation_weight, 1, joint);
    const V z = BlendKeys(pose.rotation_key, pose.rotation_weight, 2, joint);
    const V w = BlendKeys(pose.rotation_key, pose.rotation_weight, 3, joint);
    const V squared = x * x + y * y + z * z + w * w;
    const auto usable = (squared > V(1e-30f)) & (squared < V(1e38f));
    const V scale = Rsqrt(squared);
    Select(usable, x * scale, V(0.0f)).Store(local.rotation[0] + joint);
    Select(usable, y * scale, V(0.0f)).Store(local.rotation[1] + joint);
    Select(usable, z * scale, V(0.0f)).Store(local.rotation[2] + joint);
    Select(usable, w * scale, V(1.0f)).Store(local.rotation[3] + joint);
  }
};

}  // namespace pelt
