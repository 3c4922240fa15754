// Grooms: read, written again, and run for a frame. What passes the reader's checks must be safe to
// simulate: kernels check nothing.
#include <algorithm>
#include <cstdlib>
#include <vector>

#include "core/error.hpp"
#include "core/groom/groom_file.hpp"
#include "jobs/scene.hpp"
#include "tests/fuzz/fuzz_target.hpp"

namespace pelt::fuzz {
namespace {

constexpr size_t kVersionAt = 8, kSizeAt = 32, kHashAt = 40,
                 kHeaderBytes = 48;  // core/groom/groom_file.hpp

void StoreU64(std::vector<std::byte>& bytes, size_t at, uint64_t value) {
  for (size_t i = 0; i < 8; ++i) bytes[at + i] = std::byte(value >> (8 * i));
}

void StandAtRest(uint32_t joint_count, PoseBlock& pose) {
  pose.joint_count = joint_count;
  for (int i = 0; i < 3; ++i) pose.root[5 * i] = 1.0f;
  for (uint32_t j = 0; j < joint_count; ++j) {
    pose.translation_weight[0][j] = pose.rotation_weight[0][j] = pose.scale_weight[0][j] = 1.0f;
    pose.rotation_key[0][3][j] = 1.0f;
    for (auto& row : pose.scale_key[0]) row[j] = 1.0f;
  }
}

void RunOneFrame(const Groom& groom) {
  const Groom* grooms[] = {&groom};
  const auto made = FurScene::Create(grooms).OrThrow();
  FurScene& scene = *made;
  PoseBlock& pose = scene.Pose(0);
  StandAtRest(groom.joint_count, pose);
  if (scene.BeginFrame({})) return;
  SerialExecutor().Run(scene.CurrentFrame());
}

void ReadOnce(std::span<const std::byte> bytes) {
  try {
    const Groom groom = ReadGroom(bytes, "fuzz").OrThrow();
    const std::vector<std::byte> again = WriteGroom(groom).OrThrow();
    // What an older file says is written as a new one.
    const bool older = bytes[kVersionAt] != std::byte{kGroomVersion};
    if (!older && !std::ranges::equal(again, bytes)) std::abort();
    RunOneFrame(groom);
  } catch (const Error&) {
  }
}

}  // namespace

// As it is; and again with size and hash put right, or nothing would get past them.
void ReadHostile(std::span<const std::byte> input) {
  ReadOnce(input);
  if (input.size() < kHeaderBytes) return;
  std::vector<std::byte> mended(input.begin(), input.end());
  StoreU64(mended, kSizeAt, mended.size());
  StoreU64(mended, kHashAt, HashGroomBytes(std::span(mended).subspan(kHeaderBytes)));
  ReadOnce(mended);
}

}  // namespace pelt::fuzz
