// What a drawn scene (course_check.hpp) is given from frame to frame: every member of FrameInput but time, and the
// poses' velocities, origins and teleports. Most of it holds for some frames, begins and ends.
#pragma once

#include "bench/scenarios/scenarios.hpp"
#include "core/random.hpp"

namespace pelt {

inline constexpr uint32_t kDrawnFrames = 60;

// For the characters that the scenario has.
void DrawCourse(Random& random, Scenario& scenario);

}  // namespace pelt
