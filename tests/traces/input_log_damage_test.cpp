// What was damaged, cut or forged is refused with its place, and takes no more memory than its file
// warrants.
#include <gtest/gtest.h>

#include <random>

#include "core/error.hpp"
#include "tests/traces/recorded_frames.hpp"
#include "traces/input_log.hpp"

namespace pelt {
namespace {

// A file small enough to be tried at every byte.
std::vector<std::byte> WriteSmallFrames() {
  RecordedFrames recorded = MakeRecordedFrames();
  for (auto& poses : recorded.poses) poses[2] = MakePose(2, 1.0f);
  return recorded.Write();
}

size_t HeldBytes(const InputLog& log) {
  return log.frames.capacity() * sizeof(InputLogFrame) + log.frame_pose.capacity() * 4 +
         log.poses.capacity() * sizeof(PackedPose) + log.pose_words.capacity() * 4 +
         log.weather.capacity() * sizeof(Weather);
}

TEST(InputLogDamage, CollidersVelocitiesOfOtherFramesAreRefused) {
  RecordedFrames recorded = MakeRecordedFrames();
  const size_t behind_frames = recorded.Write().size() - 4;  // their number
  recorded.inputs[1].ground_velocity[1] = 2.0f;
  recorded.inputs[3].ground_velocity[1] = 2.0f;
  const std::vector<std::byte> bytes = recorded.Write();
  const auto forged = [&](size_t at, uint32_t value) {
    std::vector<std::byte> file = bytes;
    input_log::PutNumberAt(file, behind_frames + at, value);
    return InputLogError(Reseal(file));
  };
  EXPECT_EQ(forged(4, 1u), "");
  EXPECT_NE(forged(4, 3u), "") << "the next is 3 as well";
  EXPECT_NE(forged(4, 4u), "") << "there are 4";
  EXPECT_NE(forged(0, 1u), "") << "bytes are left";
  EXPECT_NE(forged(0, 3u), "") << "cut";
  EXPECT_NE(forged(0, 0x20000000u), "");
}

TEST(InputLogDamage, AFlippedBitAnywhereIsCaught) {
  std::vector<std::byte> bytes = WriteSmallFrames();
  ASSERT_TRUE(InputLogError(bytes).empty());
  for (size_t b = 0; b < bytes.size(); ++b)
    for (const int bit : {0, 7}) {
      bytes[b] ^= std::byte(1 << bit);
      ASSERT_FALSE(InputLogError(bytes).empty()) << "byte " << b << " bit " << bit;
      bytes[b] ^= std::byte(1 << bit);
    }
}

TEST(InputLogDamage, EveryTruncationIsAnError) {
  const std::vector<std::byte> bytes = WriteSmallFrames();
  for (size_t size = 0; size < bytes.size(); ++size) {
    const std::span<const std::byte> cut = std::span(bytes).first(size);
    const std::string error = InputLogError(cut);
    ASSERT_NE(error.find("input log 'x': "), std::string::npos) << size;
    ASSERT_NE(error.find("byte "), std::string::npos) << size << ": " << error;
    if (size < input_log::kHeaderBytes) continue;
    // And when the cut is covered up.
    ASSERT_FALSE(InputLogError(Reseal({cut.begin(), cut.end()})).empty()) << size;
  }
  std::vector<std::byte> longer = bytes;
  longer.push_back(std::byte{0});
  EXPECT_NE(InputLogError(longer).find("extended"), std::string::npos);
  EXPECT_NE(InputLogError(Reseal(longer)).find("behind the last frame"), std::string::npos);
}

struct Forgery {
  const char* what;
  size_t at;
  uint32_t value;
  const char* expected;
};

TEST(InputLogDamage, ForgedCountsAreRefusedByPlace) {
  const std::vector<std::byte> bytes = MakeRecordedFrames().Write();
  const Forgery forgeries[] = {
      {"version", 8, 11, "byte 8: version 11, this program reads 1 to 10"},
      {"no version", 8, 0, "byte 8: version 0"},
      {"unknown options", 16, 32, "byte 16: options are 32, version 10 has none above 31"},
      {"no groom", 20, 0, "byte 20"},
      {"more grooms than characters", 20, 4, "byte 20"},
      {"no character", 24, 0, "byte 24"},
      {"characters", 24, 0xffffffffu, "byte 24"},
      {"characters that are not there", 24, 1000, "input log"},
      {"frames", 28, 0xffffffffu, "byte 28: 4294967295 frames do not fit"},
      {"one frame too few", 28, 3, "colliders' velocities, byte"},
      {"scene text", 48, 0xffffffffu, "byte 48: a text of 4294967295 bytes"},
  };
  for (const Forgery& forgery : forgeries) {
    std::vector<std::byte> forged = bytes;
    input_log::PutNumberAt(forged, forgery.at, forgery.value);
    const std::string error = InputLogError(Reseal(forged));
    EXPECT_NE(error.find(forgery.expected), std::string::npos) << forgery.what << ": " << error;
  }
}

TEST(InputLogDamage, ForeignFilesAreNamedSo) {
  EXPECT_NE(InputLogError({}).find("not an input log"), std::string::npos);
  const std::vector<std::byte> noise(500, std::byte{0xa5});
  EXPECT_NE(InputLogError(noise).find("not an input log"), std::string::npos);
  EXPECT_THROW(ReadInputLog(noise, "x").OrThrow(), Error);
  EXPECT_THROW(ReadInputLogFile("no/such.peltinput").OrThrow(), Error);
}

// Seeded damage behind a hash that is right: never a crash (run under the sanitizers), never more
// memory than the file warrants.
TEST(InputLogDamage, RandomDamageNeverCrashes) {
  const std::vector<std::byte> bytes = WriteSmallFrames();
  std::mt19937 random(1);
  uint32_t accepted = 0;
  for (int i = 0; i < 3000; ++i) {
    std::vector<std::byte> damaged = bytes;
    for (int n = 0; n < 3; ++n)
      damaged[8 + random() % (i % 2 ? 200 : damaged.size() - 8)] = std::byte(random() & 255);
    const auto log = ReadInputLog(Reseal(damaged), "x");
    if (!log) {
      EXPECT_FALSE(log.error().empty());
      continue;
    }
    ++accepted;
    PoseBlock pose;
    for (uint32_t f = 0; f < log->FrameCount(); ++f)
      for (uint32_t c = 0; c < log->CharacterCount(); ++c) log->FillPose(f, c, &pose);
    EXPECT_LE(HeldBytes(*log), 10 * damaged.size() + 65536);
  }
  EXPECT_GT(accepted, 0u);  // values are not judged here
}

// The worst case of the stated bound: frames in which nothing but the digest is new.
TEST(InputLogDamage, ManyStillCharactersStayWithinTheStatedMemory) {
  const std::vector<std::byte> groom(8);
  const std::vector<std::span<const std::byte>> grooms(1024, groom);
  const std::vector<PoseBlock> poses(1024, MakePose(0, 0.0f));
  InputLogWriter writer;
  ASSERT_EQ(writer.Begin({}, grooms), nullptr);
  for (uint64_t f = 0; f < 50; ++f) ASSERT_EQ(writer.AddFrame({}, poses, f), nullptr);
  const std::vector<std::byte> bytes = writer.Finish();
  EXPECT_LE(HeldBytes(ReadInputLog(bytes, "x").OrThrow()), 10 * bytes.size());
}

}  // namespace
}  // namespace pelt
