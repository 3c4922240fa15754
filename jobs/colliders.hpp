// Where a frame's colliders and force volumes are, and how colliders came there.
#pragma once

#include <array>

#include "core/frame_input.hpp"
#include "core/kernels/simulate_params.hpp"
#include "jobs/frame.hpp"
#include "jobs/origins.hpp"
#include "jobs/pose_gate.hpp"

namespace pelt {

struct BoundsBlock;
struct ForceParams;  // core/kernels/wind.hpp
struct PlacedForce;

// Where a frame's capsules are: free ones where the input says, bound ones where their joint's pose
// takes them.
//
// The idea: a bound end lies somewhere on the mesh as it was bound, and the palette moves it like
// skin. The palette is made by the frame, after its parameters; so for characters with a capsule
// the two kernels that make it run here too, and give the same bits. A character that keeps its
// last pose keeps its capsules.
//
// Invariant: what is placed is finite. A capsule that its joint takes beyond where skin may be is
// left out.

// Which of the input's each placed capsule is.
using CapsuleSources = std::array<uint32_t, kCapsulesPerScene>;

// For an input without fault, after the gate has judged the frame's poses. Does nothing, and costs
// nothing, where there are no capsules.
// `origins`: of the characters, where they have some; places are then relative to `character`'s.
CapsuleSources PlaceCapsules(const FrameInput& input, const FrameMemory& memory,
                             const PoseGate& gate, SimulateParams& params,
                             std::span<const CharacterOrigin> origins = {}, uint32_t character = 0);

// Likewise of its force volumes.
ForceParams PlaceForces(const FrameInput& input, const FrameMemory& memory, const PoseGate& gate,
                        std::span<const CharacterOrigin> origins = {}, uint32_t character = 0);

// Whether the volume may reach into the box: by its own axes alone, so not always where it says so.
bool Touches(const PlacedForce& force, const BoundsBlock& box);

// How the frame's colliders came to where they are, from frame to frame: their velocities, or for
// capsules bound to joints the last frame's pose.
//
// Invariant: a function of this frame's input and the last one's. The first frame, a character that
// was put elsewhere and a capsule that was not there have no way behind them.
class ColliderCourse {
 public:
  // Fills the steps of `params`, where the colliders are placed already. `input`: as the caller gave
  // it. `last`: the parameters of the last frame, or null. `shift`: how far the origin that they
  // are relative to has moved since then; or null. In a frame whose own origin moves, what has no velocity stands.
  void Advance(const FrameInput& input, const FrameMemory& memory, const CapsuleSources& sources,
               const SimulateParams* last, const float* shift, SimulateParams& params);

  // All of it, for an archive (jobs/scene_snapshot.cpp).
  static void ListState(auto& io, auto& self) {
    io(self.origin_);
    io(self.use_ground_);
    io(self.ground_);
    io(self.sphere_count_);
    io(self.sphere_);
    for (auto& capsule : self.capsule_) {
      io(capsule.from);
      io(capsule.to);
      io(capsule.radius);
      io(capsule.character);
      io(capsule.joint);
    }
    for (auto& source : self.sources_) io(source);
  }

 private:
  const CapsuleParams* LastOf(uint32_t source, const SimulateParams& last) const;

  // The last input's.
  double origin_[3] = {};
  bool use_ground_ = false;
  float ground_[4] = {};
  uint32_t sphere_count_ = 0;
  float sphere_[kSpheresPerScene][4] = {};
  CapsuleCollider capsule_[kCapsulesPerScene];
  CapsuleSources sources_{};  // of the last frame's capsules
};

}  // namespace pelt
