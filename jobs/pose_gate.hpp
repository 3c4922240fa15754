// Which poses of a frame are used. A pose that cannot be is refused for its character alone: that
// character keeps the matrices of its last accepted pose, as if it had been given again, and all
// others run as if nothing had happened.
//
//   joint count of the groom?  all keys, weights and the placement usable?  skin within 1e7 m?
//        └── no: refused, the joint named ──────┴───────────────────────────────┘
//
// Velocities, where the pose has them, are asked the same: usable, and the skin below 1e7 m/s by a
// bound.
//
// The last question needs the chain of joints: scales of 1e6 in 24 joints are each harmless and
// together infinite. It is answered by a bound, a few operations per joint; a pose that does not pass
// it is put through the kernels themselves, so what is refused is what they would have made of it.
//
// A character that never had an accepted pose stands at the origin as it was bound. When it gets
// one, or one after a refused teleport, its fur starts from its groom.
//
// Invariant: decided on the caller's thread before the frame, so every executor sees the same; no
// allocation after construction.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/groom/groom.hpp"
#include "jobs/frame.hpp"

namespace pelt {

struct FrameTable;

inline constexpr uint32_t kNoJoint = ~0u;

// Where skin may be: ten times what a single value of a pose may be, and what the solvers are
// tested with (tests/jobs/hostile_input_test.cpp).
inline constexpr double kFarthest_m = 1.0e7;

// A pose that was not used, and why.
struct RefusedPose {
  uint32_t character;
  uint32_t joint;    // kNoJoint: the pose as a whole
  const char* what;  // a literal: "its translation keys are not finite, or beyond 1e6"
};
// "pose of character 2, joint 7: its translation keys are not finite, or beyond 1e6"
std::string DescribeRefusedPose(const RefusedPose& refused);

class PoseGate {
 public:
  // How much longer a matrix can make a vector, and how far it moves the origin, m.
  struct Reach {
    double linear, translation;
  };

  PoseGate() = default;
  // One groom for each character; `kernels` are the scene's.
  PoseGate(std::span<const Groom* const> grooms, const FrameTable& kernels);

  // Judges the poses that lie in the scene's memory, and prepares the palettes of characters that
  // keep their last one. `origins`: of the characters, three
  // each, where they have some.
  void Judge(const FrameMemory& memory, std::span<const double> origins = {});

  // Of grooms that take the place of these, whose skeletons and meshes are the same.
  void TakeUnitScales(std::span<const Groom* const> grooms);

  // What it remembers of earlier frames, from the gate of a scene of the same grooms.
  void CopyStateFrom(const PoseGate& other);
  // The same for an archive (jobs/scene_snapshot.cpp), but for the poses that were refused.
  static void ListState(auto& io, auto& self) {
    for (auto& character : self.characters_) {
      io(character.had_pose);
      io(character.must_restart);
    }
    for (auto& holds : self.holds_pose_) io(holds);  // in place: the scene's memory points here
  }
  void ForgetRefused() { refused_.clear(); }

  std::span<const RefusedPose> refused() const { return refused_; }

  // After Judge: the matrices that this frame will have, by the kernels' own bits. Valid until the
  // next call.
  const PaletteBlock& PaletteOf(const FrameMemory& memory, uint32_t character) const;
  uint32_t JointCount(uint32_t character) const { return characters_[character].joint_count; }
  float UnitScale(uint32_t character) const { return characters_[character].unit_scale; }

  // For FrameMemory::held, of characters.
  const uint8_t* holds_pose() const { return holds_pose_.data(); }
  uint64_t HeapBytes() const;

 private:
  struct CharacterLimits {
    uint32_t joint_count;
    float unit_scale;
    double reach_m;        // of the mesh's farthest vertex from the origin it was bound at
    uint32_t first_joint;  // in inverse_bind_
    bool had_pose = false, must_restart = false;
  };
  struct Scratch {
    LocalPoseBlock local;
    PaletteBlock palette;
  };

  // `refused.what` null: it can be used.
  RefusedPose FindFault(const FrameMemory& memory, uint32_t character) const;
  RefusedPose FindRateFault(const FrameMemory& memory, uint32_t character) const;
  uint32_t FindFarJoint(const FrameMemory& memory, uint32_t character) const;
  const PaletteBlock& RunKernels(const FrameMemory& memory, uint32_t character) const;
  void Hold(const FrameMemory& memory, uint32_t character);
  void Accept(const FrameMemory& memory, uint32_t character);

  KernelDesc sample_pose_{}, joint_palette_{};
  std::vector<CharacterLimits> characters_;
  std::vector<Reach> inverse_bind_;
  std::vector<uint8_t> holds_pose_;
  std::vector<RefusedPose> refused_;
  std::unique_ptr<Scratch> scratch_;
};

}  // namespace pelt
