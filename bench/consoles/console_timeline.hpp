// A modelled frame as a timeline for viewers: a track for the frame and its passes, and three for
// each unit: what it does, and its transfers in and out.
//
// Invariant: times are the console's own, from the frame's begin. What runs on the host meanwhile
// does not appear.
#pragma once

#include <string>

#include "jobs/scene.hpp"
#include "platform_sim/frame/console_machine.hpp"
#include "platform_sim/frame/modelled_frame.hpp"
#include "traces/timeline.hpp"

namespace pelt {

// "SPU 3", or "core 1 thread 0".
std::string UnitName(const ConsoleMachine& machine, uint32_t unit);

// Adds the tracks of a frame of `scene` that was run with its timelines kept. Tracks bear the
// machine's name, so that two consoles stand side by side in one trace.
void AddConsoleTracks(const FurScene& scene, const ConsoleMachine& machine,
                      const ModelledFrame& frame, Timeline& timeline);

}  // namespace pelt
