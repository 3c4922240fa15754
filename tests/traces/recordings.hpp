// Input logs for tests: a scene recorded, and a recording with something planted in a frame.
#pragma once

#include <gtest/gtest.h>

#include <span>
#include <vector>

#include "bench/scenarios/scenarios.hpp"
#include "core/groom/groom_file.hpp"
#include "traces/input_log.hpp"

namespace pelt {

// A built-in scene as it runs by default. `change(frame, input)` is called on the input of each frame first.
template <class Change>
std::vector<std::byte> RecordScene(const std::string& name, uint32_t frames, Change change) {
  Scenario scenario = LoadScenario(name);
  RunningScenario running(scenario, {});
  std::vector<std::vector<std::byte>> grooms;
  for (const Actor& actor : scenario.actors)
    grooms.push_back(WriteGroom(scenario.grooms[actor.groom]).OrThrow());
  InputLogWriter writer;
  EXPECT_EQ(writer.Begin({.scene = name, .note = "a test"},
                         std::vector<std::span<const std::byte>>(grooms.begin(), grooms.end())),
            nullptr);
  for (uint32_t f = 0; f < frames; ++f) {
    FrameInput input = running.Prepare(f, scenario.base.skip, scenario.base.lod);
    change(f, input);
    EXPECT_EQ(running.scene().BeginFrame(input), nullptr);
    SerialExecutor().Run(running.scene().CurrentFrame());
    EXPECT_EQ(writer.AddFrame(input, {&running.scene().Pose(0), scenario.actors.size()},
                              running.scene().DigestFrame()),
              nullptr);
  }
  return writer.Finish();
}
inline std::vector<std::byte> RecordScene(const std::string& name, uint32_t frames) {
  return RecordScene(name, frames, [](uint32_t, FrameInput&) {});
}

// The log again, with `change` made to one frame's poses and input.
template <class Change>
std::vector<std::byte> RewriteLog(const InputLog& log, uint32_t frame, Change change) {
  std::vector<std::span<const std::byte>> grooms;
  for (const uint32_t groom : log.character_groom) grooms.emplace_back(log.grooms[groom]);
  InputLogWriter writer;
  EXPECT_EQ(writer.Begin(log.about, grooms), nullptr);
  std::vector<PoseBlock> poses(log.CharacterCount());
  for (uint32_t f = 0; f < log.FrameCount(); ++f) {
    for (uint32_t c = 0; c < log.CharacterCount(); ++c) log.FillPose(f, c, &poses[c]);
    FrameInput input = log.Input(f);
    if (f == frame) change(input, poses);
    EXPECT_EQ(writer.AddFrame(input, poses, log.frames[f].digest), nullptr);
  }
  return writer.Finish();
}

}  // namespace pelt
