// A recording and a digest log made by hand: values that are easy to tell apart, no scene behind
// them.
#pragma once

#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "traces/digest_log.hpp"
#include "traces/input_log.hpp"
#include "traces/input_log_format.hpp"

namespace pelt {

struct RecordedFrames {
  InputLogScene about{"by hand", "two animals", false};
  std::vector<std::vector<std::byte>> grooms;  // one for each character
  std::vector<FrameInput> inputs;
  std::vector<std::vector<Weather>> weather;
  std::vector<std::vector<PoseBlock>> poses;
  std::vector<uint64_t> digests;

  std::vector<std::span<const std::byte>> Grooms() const { return {grooms.begin(), grooms.end()}; }
  FrameInput Input(size_t frame) const {
    FrameInput input = inputs[frame];
    input.weather = weather[frame];
    return input;
  }
  std::vector<std::byte> Write() const {
    InputLogWriter writer;
    writer.Begin(about, Grooms());
    for (size_t f = 0; f < inputs.size(); ++f) writer.AddFrame(Input(f), poses[f], digests[f]);
    return writer.Finish();
  }
};

inline PoseBlock MakePose(uint32_t joints, float base) {
  PoseBlock pose;
  // Joints not in use hold what must not reach a file.
  std::memset(static_cast<void*>(&pose), 0x77, sizeof pose);
  float value = base;
  const auto fill = [&](auto& rows) {
    auto* row = reinterpret_cast<float(*)[kJointsPerCharacter]>(&rows);
    for (size_t r = 0; r < sizeof rows / sizeof *row; ++r)
      for (uint32_t j = 0; j < joints; ++j) row[r][j] = value += 0.25f;
  };
  fill(pose.translation_key);
  fill(pose.rotation_key);
  fill(pose.scale_key);
  fill(pose.translation_weight);
  fill(pose.rotation_weight);
  fill(pose.scale_weight);
  for (float& element : pose.root) element = value += 0.25f;
  pose.joint_count = joints;
  pose.teleported = 0;
  return pose;
}

// Two characters of one groom and one of another, four frames; the second character stands still.
inline RecordedFrames MakeRecordedFrames() {
  RecordedFrames all;
  const std::vector<std::byte> cat(37, std::byte{0xc1}), dog(52, std::byte{0xd0});
  all.grooms = {cat, dog, cat};
  for (uint32_t f = 0; f < 4; ++f) {
    FrameInput input;
    input.time_s = f / 60.0;
    input.camera.eye[1] = 1.0f + float(f);
    input.use_ground = f % 2 == 1;
    input.sphere_count = f;
    for (uint32_t s = 0; s < f; ++s) input.sphere[s][3] = 0.5f + float(s);
    input.capsule_count = f;
    for (uint32_t c = 0; c < f; ++c) {
      input.capsule[c].to[1] = 2.0f * float(c);
      input.capsule[c].radius = 0.25f;
      if (c > 0) input.capsule[c].joint = 7 * c;
    }
    input.lighting.light_count = f;
    for (uint32_t l = 0; l < f; ++l) input.lighting.light[l] = {{float(l)}, 0.5f, {1, 2, 3}, 9.0f};
    input.lighting.sample_count = 3 * f;
    for (uint32_t s = 0; s < 3 * f; ++s)
      input.lighting.sample[s] = {{float(s)}, 4.0f, {1, 2, 3}, {4, 5, 6}, {0, 1, 0}};
    input.lighting.sun_rgb[1] = 0.5f * float(f);
    input.brush_count = 2 * f;
    for (uint32_t b = 0; b < 2 * f; ++b)
      input.brush[b] = {{0, float(b), 0}, 0.25f, 0.5f, b % kPaintChannels, b % 2 ? 1.0f : -0.5f};
    input.wind.kind = f % 2;
    input.force_count = f;
    for (uint32_t v = 0; v < f; ++v)
      input.force[v] = {{0, float(v), 0},
                        {1, 1, 0.25f},
                        v % 2,
                        f % 2,
                        {0, 1, 0},
                        -3.0f,
                        0.5f,
                        0,
                        v > 0 ? 5 * v : ForceVolume::kFree};
    input.skip.light = f != 1;
    input.skip.lod = f == 2;
    input.lod.strand_budget = 100 * f;
    input.lod.budget_us = 250 * f;
    input.lod.worst_px = 1.5f;
    input.lod.costs = {0.5f, 1.0f, 2.0f, {3.0f, 4.0f, 5.0f, 6.0f, 7.0f + float(f)}};
    all.inputs.push_back(input);
    all.weather.push_back(f == 0 ? std::vector<Weather>()
                                 : std::vector<Weather>(3, Weather{0.5f, 0.1f * float(f)}));
    all.poses.push_back(
        {MakePose(3, 1000.0f * float(f)), MakePose(17, 5.0f), MakePose(256, 10.0f * float(f))});
    all.digests.push_back(0x1122334455667700u + f);
  }
  all.poses[3][0].teleported = 1;
  return all;
}

// What is wrong with an input log, or "".
inline std::string InputLogError(std::span<const std::byte> bytes) {
  return ReadInputLog(bytes, "x").error();
}

// A forged file: its size and hash are right.
inline std::vector<std::byte> Reseal(std::vector<std::byte> bytes) {
  input_log::PutNumberAt(bytes, input_log::kFileBytesAt, uint64_t(bytes.size()));
  input_log::PutNumberAt(bytes, input_log::kHashAt, input_log::HashOf(bytes));
  return bytes;
}

inline DigestLog MakeDigestLog() {
  DigestLog log;
  log.scene = "tiny";
  log.chunk_strands = 128;
  log.vertex_order = "sorted";
  log.columns = {{"skin", "skinned"}, {"roots", "roots"}, {"whole_frame", "all"}};
  for (uint64_t d = 0; d < 12; ++d) log.digests.push_back(d << 60 | d);
  return log;
}

}  // namespace pelt
