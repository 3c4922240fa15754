// A frame of a scene, by the executor that needs nothing.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "bench/scenarios/scenarios.hpp"
#include "jobs/frame.hpp"
#include "jobs/scene.hpp"

namespace pelt::testing {

// Why the frame was refused; empty when it was not.
inline std::string BeginError(FurScene& scene, const FrameInput& input) {
  const char* fault = scene.BeginFrame(input);
  return fault ? fault : "";
}

// Runs the frame that is begun; one of this input; a scenario's own, by its own settings or these.
inline void RunBegun(FurScene& scene) {
  ASSERT_EQ(SerialExecutor().Run(scene.CurrentFrame()), nullptr);
}
inline void RunInput(FurScene& scene, const FrameInput& input) {
  ASSERT_EQ(BeginError(scene, input), "");
  RunBegun(scene);
}
inline void RunInput(FurScene& scene, const FrameInput& input, Executor& executor) {
  ASSERT_EQ(BeginError(scene, input), "");
  ASSERT_EQ(executor.Run(scene.CurrentFrame()), nullptr);
}
inline void RunInput(RunningScenario& run, const FrameInput& input) {
  ASSERT_TRUE(run.TryBegin(input)) << run.RefusalText(0);
  RunBegun(run.scene());
}
inline void RunFrame(RunningScenario& run, uint32_t frame) {
  run.Begin(frame);
  RunBegun(run.scene());
}
inline void RunFrame(RunningScenario& run, uint32_t frame, const SkipSettings& skip,
                     const LodSettings& lod) {
  run.Begin(frame, skip, lod);
  RunBegun(run.scene());
}

}  // namespace pelt::testing
