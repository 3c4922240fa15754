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
#pragma once

#include <array>

#include "core/frame_input.hpp"
#include "core/kernels/simulate_params.hpp"
#include "jobs/frame.hpp"
#include "jobs/origins.hpp"
#include "jobs/pose_gate.hpp"

namespace pelt {

// Which of the input's each placed capsule is.
using CapsuleSources = std::array<uint32_t, kCapsulesPerScene>;

// For an input without fault, after the gate has judged the frame's poses. Does nothing, and costs
// nothing, where there are no capsules.
// `origins`: of the characters, where they have some; places are then relative to `character`'s.
CapsuleSources PlaceCapsules(const FrameInput& input, const FrameMemory& memory,
                             const PoseGate& gate, SimulateParams& params,
                             std::span<const CharacterOrigin> origins = {}, uint32_t character = 0);

}  // namespace pelt
