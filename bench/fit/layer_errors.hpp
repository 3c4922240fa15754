// How far the tips of each layer's strands are off where they belong, of several ways to simulate one
// scene: in space, and on the screen of the scene's camera.
//
// They belong where the modal solver at its best has them with four frames for one. As in
// scene_precision.hpp all ways and the reference go through the frames in lockstep, the scene is dry,
// and nothing is culled. A way has the level of detail of its scenario's frames (FrameInput::lod), the
// reference none; what lives is compared. A layer's error does not depend on the others.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "bench/scenarios/scenarios.hpp"

namespace pelt {

struct TipError {
  double off_m = 0.0;            // RMS
  uint32_t p99_micropixels = 0;  // 99th percentile, of tips in view; 0: none is
  uint64_t tips = 0;             // compared, of all frames; 0: nothing of the layer is simulated
};

struct ErrorFrames {
  uint32_t warm_up = 60, frames = 60;
  std::function<void(uint32_t done, uint32_t total)> progress = {};
};

// Throws Error in a build without bench/accuracy, by which errors are measured; before work that would come to them.
void RequireAccuracy();

// Of each way: each layer of the scene, and all of them together last.
std::vector<std::vector<TipError>> MeasureTipErrors(const Scenario& scene, std::span<Scenario> ways,
                                                    const ErrorFrames& frames);

}  // namespace pelt
