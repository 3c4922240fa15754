// What the input of a frame may be, poses apart: everything finite, and small enough that no kernel can
// make an infinity of it. Poses have a door of their own (jobs/pose_gate.hpp).
#pragma once

#include <cstddef>
#include <string>

#include "core/frame_input.hpp"
#include "jobs/plan.hpp"
#include "jobs/pose_gate.hpp"

namespace pelt {

// For metres and all other input: far more than fur can use, far less than would overflow when
// squared. A larger value would not be refused by arithmetic, only turned into infinities.
inline constexpr float kLargestInput = 1.0e6f;
bool AreUsable(const float* values, size_t count);

// Null, or why no frame can be run with this; written to `text`, which is not made to grow beyond
// what a fault takes.
const char* FindInputFault(const FrameInput& input, const SceneShape& shape, const PoseGate& gate,
                           std::string& text);

}  // namespace pelt
