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
  // Fills the steps of `params`, where the colliders are placed already. `last`: those of the last
  // frame, or null. `origin`: what places are told from, where that is not the world's; in a frame
  // that moves it, what has no velocity stands.
  void Advance(const FrameInput& input, const FrameMemory& memory, const CapsuleSources& sources,
               const SimulateParams* last, const CharacterOrigin* origin, SimulateParams& params);

 private:
  const CapsuleParams* LastOf(uint32_t source, const SimulateParams& last) const;

  CapsuleCollider capsule_[kCapsulesPerScene];  // the last input's
  CapsuleSources sources_{};                    // of the last frame's capsules
};

}  // namespace pelt
