// How the frame's colliders came to where they are, from frame to frame: their velocities, or for
// capsules bound to joints the last frame's pose.
//
// Invariant: a function of this frame's input and the last one's. The first frame, a character that
// was put elsewhere and a capsule that was not there have no way behind them.
#pragma once

#include "core/frame_input.hpp"
#include "core/kernels/simulate_params.hpp"
#include "jobs/frame.hpp"
#include "jobs/place_capsules.hpp"

namespace pelt {

class ColliderCourse {
 public:
  // Fills the steps of `params`, where the colliders are placed already. `input`: as the caller gave
  // it. `last`: the parameters of the last frame, or null. `shift`: how far the origin that they
  // are relative to has moved since then; or null. In a frame whose own origin moves, what has no velocity stands.
  void Advance(const FrameInput& input, const FrameMemory& memory, const CapsuleSources& sources,
               const SimulateParams* last, const float* shift, SimulateParams& params);

  // All of it, for an archive (jobs/state_bytes.hpp).
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
