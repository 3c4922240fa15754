// What is recorded comes back bit for bit, of older versions too.
#include "traces/input_log.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "core/file_bytes.hpp"
#include "tests/source_folder.hpp"
#include "tests/traces/recorded_frames.hpp"
#include "traces/diff.hpp"
#include "traces/digest.hpp"
#include "traces/input_log_format.hpp"

namespace pelt {
namespace {

// All lanes in use; what lies behind them was not recorded and is 0.
void ExpectSamePose(const PoseBlock& expected, const PoseBlock& found) {
  EXPECT_EQ(expected.joint_count, found.joint_count);
  EXPECT_EQ(expected.teleported, found.teleported);
  EXPECT_EQ(std::memcmp(expected.root, found.root, sizeof expected.root), 0);
  for (const RowDesc& row : DescribeStream(StreamOf<&Streams::pose>).rows) {
    if (row.lane_count != kJointsPerCharacter) continue;
    for (uint32_t e = 0; e < row.element_count; ++e) {
      const bool used = e % row.lane_count < expected.joint_count;
      ASSERT_EQ(RowElement(&found, row, e), used ? RowElement(&expected, row, e) : 0u)
          << row.name << " " << e;
    }
  }
}

// Cuts that are covered up, at every 101st byte.
void ExpectCutsRefused(const std::vector<std::byte>& bytes) {
  for (size_t size = input_log::kHeaderBytes; size < bytes.size(); size += 101)
    ASSERT_NE(InputLogError(Reseal({bytes.begin(), bytes.begin() + ptrdiff_t(size)})), "") << size;
}

TEST(InputLog, WhatIsRecordedComesBack) {
  const RecordedFrames recorded = MakeRecordedFrames();
  const InputLog log = ReadInputLog(recorded.Write(), "x").OrThrow();
  EXPECT_EQ(log.about.scene, "by hand");
  EXPECT_EQ(log.about.note, "two animals");
  EXPECT_FALSE(log.about.index_buffer);
  EXPECT_EQ(log.chunk_strands, kStrandsPerChunk);
  ASSERT_EQ(log.FrameCount(), 4u);
  ASSERT_EQ(log.CharacterCount(), 3u);
  for (uint32_t c = 0; c < 3; ++c)
    EXPECT_EQ(log.grooms[log.character_groom[c]], recorded.grooms[c]);
  PoseBlock pose;
  for (uint32_t f = 0; f < 4; ++f) {
    const FrameInput input = log.Input(f);
    EXPECT_EQ(input.time_s, recorded.inputs[f].time_s);
    EXPECT_EQ(input.camera.eye[1], recorded.inputs[f].camera.eye[1]);
    EXPECT_EQ(input.use_ground, recorded.inputs[f].use_ground);
    EXPECT_EQ(input.skip.lod, recorded.inputs[f].skip.lod);
    EXPECT_EQ(input.lod.strand_budget, 100 * f);
    EXPECT_EQ(input.lod.budget_us, 250 * f);
    EXPECT_EQ(input.lod.worst_px, 1.5f);
    EXPECT_EQ(std::memcmp(&input.lod.costs, &recorded.inputs[f].lod.costs, sizeof(FurCosts)), 0);
    ASSERT_EQ(input.sphere_count, f);
    for (uint32_t s = 0; s < f; ++s) EXPECT_EQ(input.sphere[s][3], 0.5f + float(s));
    ASSERT_EQ(input.capsule_count, f);
    for (uint32_t c = 0; c < f; ++c) {
      EXPECT_EQ(input.capsule[c].to[1], 2.0f * float(c));
      EXPECT_EQ(input.capsule[c].radius, 0.25f);
      EXPECT_EQ(input.capsule[c].joint, c > 0 ? 7 * c : CapsuleCollider::kFree);
    }
    EXPECT_EQ(input.skip.light, f != 1);
    EXPECT_EQ(std::memcmp(&input.lighting, &recorded.inputs[f].lighting, sizeof(Lighting)), 0);
    EXPECT_EQ(input.brush_count, 2 * f);
    EXPECT_EQ(std::memcmp(&input.brush, &recorded.inputs[f].brush, sizeof input.brush), 0);
    EXPECT_EQ(input.wind.kind, f % 2);
    EXPECT_EQ(input.force_count, f);
    EXPECT_EQ(std::memcmp(&input.force, &recorded.inputs[f].force, sizeof input.force), 0);
    ASSERT_EQ(input.weather.size(), recorded.weather[f].size());
    for (const Weather& weather : input.weather) EXPECT_EQ(weather.dirt, 0.1f * float(f));
    EXPECT_EQ(log.frames[f].digest, recorded.digests[f]);
    for (uint32_t c = 0; c < 3; ++c) {
      log.FillPose(f, c, &pose);
      ExpectSamePose(recorded.poses[f][c], pose);
    }
  }
}

TEST(InputLog, GroomsAndPosesAreNotWrittenTwice) {
  const RecordedFrames recorded = MakeRecordedFrames();
  const InputLog log = ReadInputLog(recorded.Write(), "x").OrThrow();
  EXPECT_EQ(log.grooms.size(), 2u);
  EXPECT_EQ(log.character_groom, (std::vector<uint32_t>{0, 1, 0}));
  EXPECT_EQ(log.poses.size(), 4u + 1u + 4u);  // the second character stands still
}

// They stand behind all else, of those frames alone in which they change.
TEST(InputLog, ListsOfLayersAndStrandsComeBack) {
  RecordedFrames recorded = MakeRecordedFrames();
  const std::vector<std::byte> without = recorded.Write();
  const std::vector<float> importance = {0.0f, 2.5f, -0.0f};
  const std::vector<uint8_t> cut = {0, 1, 0, 255, 7};
  const std::vector<StrandWrite> strands = {{1, 2, 3, 4, 0.5f, 6}, {7, 8, 9, 10, 0.25f, 12}};
  recorded.inputs[1].importance = recorded.inputs[2].importance = importance;
  recorded.inputs[2].cut = cut;
  recorded.inputs[2].strands = strands;
  const std::vector<std::byte> bytes = recorded.Write();
  // Frames 1, 2 and 3 with their numbers and three lengths each; and how many frames.
  EXPECT_EQ(bytes.size(), without.size() + 4 + 3 * 16 + 2 * 3 * 4 + 5 + 2 * 24);
  const InputLog log = ReadInputLog(bytes, "x").OrThrow();
  EXPECT_EQ(log.MostStrandWrites(), 2u);
  for (uint32_t f = 0; f < 4; ++f) {
    const FrameInput found = log.Input(f), expected = recorded.Input(f);
    const auto same = [](const auto& a, const auto& b) {
      return a.size() == b.size() &&
             (a.empty() || std::memcmp(a.data(), b.data(), a.size_bytes()) == 0);
    };
    EXPECT_TRUE(same(found.importance, expected.importance)) << f;
    EXPECT_TRUE(same(found.cut, expected.cut)) << f;
    EXPECT_TRUE(same(found.strands, expected.strands)) << f;
  }
  ExpectCutsRefused(bytes);
  // Of another frame, of one before the last, and longer than the file.
  const auto forged = [&](size_t at, uint32_t value) {
    std::vector<std::byte> file = bytes;
    input_log::PutNumberAt(file, without.size() + at, value);
    return InputLogError(Reseal(file));
  };
  EXPECT_EQ(forged(4, 0u), "");
  EXPECT_NE(forged(4, 4u).find("lists, byte"), std::string::npos);
  EXPECT_NE(forged(4, 2u).find("lists, byte"), std::string::npos);
  EXPECT_NE(forged(8, 0x10000000u).find("do not fit"), std::string::npos);
  EXPECT_NE(forged(0, 4u), "");
  // Earlier versions know nothing of them.
  std::vector<std::byte> older = bytes;
  input_log::PutNumberAt(older, 8, 9u);
  EXPECT_NE(InputLogError(Reseal(older)).find("options are"), std::string::npos);
}

// They stand behind the frames, of those alone that have some.
TEST(InputLog, CollidersVelocitiesComeBack) {
  RecordedFrames recorded = MakeRecordedFrames();
  const std::vector<std::byte> without = recorded.Write();
  recorded.inputs[2].sphere_velocity[1][2] = 4.0f;
  recorded.inputs[2].sphere_velocity[7][2] = 1.0f;  // there are two
  recorded.inputs[3].capsule[2].from_velocity[0] = -0.0f;
  recorded.inputs[3].capsule[0].to_velocity[1] = 3.0f;
  recorded.inputs[3].ground_velocity[1] = 2.0f;
  const std::vector<std::byte> bytes = recorded.Write();
  // Two frames with their numbers, the ground's, two and three spheres and capsules.
  EXPECT_EQ(bytes.size(), without.size() + 2 * (4 + 12) + 12 * (2 + 3) + 24 * (2 + 3));
  const InputLog log = ReadInputLog(bytes, "x").OrThrow();
  for (uint32_t f = 0; f < 4; ++f) {
    FrameInput expected = recorded.inputs[f];
    expected.sphere_velocity[7][2] = 0.0f;
    const FrameInput input = log.Input(f);
    EXPECT_EQ(
        std::memcmp(input.sphere_velocity, expected.sphere_velocity, sizeof input.sphere_velocity),
        0);
    EXPECT_EQ(std::memcmp(input.capsule, expected.capsule, sizeof input.capsule), 0) << f;
    EXPECT_EQ(std::memcmp(input.ground_velocity, expected.ground_velocity, 12), 0) << f;
  }
}

// Floats travel as bits: no value is lost, and -0 is not 0.
TEST(InputLog, OddFloatsKeepTheirBits) {
  RecordedFrames recorded = MakeRecordedFrames();
  const float odd[] = {-0.0f, std::numeric_limits<float>::denorm_min(),
                       std::bit_cast<float>(0x7fa12345u)};
  std::copy_n(odd, 3, recorded.inputs[1].gravity);
  std::copy_n(odd, 3, recorded.poses[2][0].root);
  const InputLog log = ReadInputLog(recorded.Write(), "x").OrThrow();
  EXPECT_EQ(std::memcmp(log.Input(1).gravity, odd, sizeof odd), 0);
  PoseBlock pose;
  log.FillPose(2, 0, &pose);
  EXPECT_EQ(std::memcmp(pose.root, odd, sizeof odd), 0);
}

// The format, byte by byte: must hold on every machine and for every later program that says it
// reads version 10.
TEST(InputLog, BytesAreThoseOfVersionTen) {
  const std::vector<std::byte> bytes = MakeRecordedFrames().Write();
  EXPECT_EQ(std::memcmp(bytes.data(), "PELTINP\n", 8), 0);
  const uint32_t head[] = {10, kStrandsPerChunk, 0, 2, 3, 4};
  for (size_t b = 0; b < sizeof head; ++b)
    EXPECT_EQ(bytes[8 + b], std::byte(head[b / 4] >> 8 * (b % 4) & 255)) << b;
  ASSERT_EQ(bytes.size(), 223127u);
  Digest digest;
  for (size_t b = input_log::kHeaderBytes; b < bytes.size(); ++b) digest.Add(uint32_t(bytes[b]));
  EXPECT_EQ(digest.Value(), 0x96301a113b78cddfu);
}

TEST(InputLog, BeginsWithASnapshotWhereThereIsOne) {
  const std::vector<std::byte> groom(37, std::byte{0xc1}), snapshot(1001, std::byte{0x5e});
  const std::span<const std::byte> grooms[] = {groom};
  const PoseBlock pose = MakePose(3, 1.0f);
  InputLogWriter writer;
  const auto write = [&](std::span<const std::byte> head) {
    EXPECT_EQ(writer.Begin({"x", "", false}, grooms, head), nullptr);
    EXPECT_EQ(writer.AddFrame({}, {&pose, 1}, 7), nullptr);
    return writer.Finish();
  };
  const std::vector<std::byte> with = write(snapshot), without = write({});
  EXPECT_EQ(with.size(), without.size() + 8 + snapshot.size());
  const InputLog log = ReadInputLog(with, "x").OrThrow(),
                 plain = ReadInputLog(without, "x").OrThrow();
  EXPECT_EQ(log.snapshot, snapshot);
  EXPECT_EQ(log.version, kInputLogVersion);
  EXPECT_EQ(plain.version, kInputLogVersion);
  std::vector<std::byte> forged = without;
  input_log::PutNumberAt(forged, 16, 8u);
  EXPECT_NE(InputLogError(Reseal(forged)).find("snapshot, byte"), std::string::npos);
  EXPECT_EQ(log.FrameCount(), 1u);
  EXPECT_TRUE(plain.snapshot.empty());
  const auto difference = FindDifference(log, plain);
  ASSERT_TRUE(difference);
  EXPECT_NE(DescribeDifference(*difference).find("snapshot"), std::string::npos);
}

// A recording from before there were capsules.
TEST(InputLog, VersionOneIsStillRead) {
  const InputLog log =
      ReadInputLogFile(test::SourceFolder() + "/tests/fuzz/corpus/input_log/version_1.peltinput")
          .OrThrow();
  EXPECT_EQ(log.version, 1u);
  ASSERT_EQ(log.FrameCount(), 3u);
  for (uint32_t f = 0; f < 3; ++f) {
    const FrameInput input = log.Input(f);
    EXPECT_EQ(input.sphere_count, 1u);
    EXPECT_EQ(input.sphere[0][3], 0.1f);
    EXPECT_EQ(input.capsule_count, 0u);
    ASSERT_EQ(input.weather.size(), 1u);
    EXPECT_EQ(input.weather[0].dirt, 0.25f);
  }
}

// Velocities of some characters in some frames come back as they were.
TEST(InputLog, VelocitiesComeBackAndAreNotWrittenTwice) {
  const RecordedFrames recorded = MakeRecordedFrames();
  const auto rates_of = [](uint32_t frame, uint32_t character) {
    PoseRateBlock rates{};
    rates.given = character != 1 && frame != 2;
    if (!rates.given) return rates;
    const uint32_t said = character == 0 ? frame : 9;  // the third's never change
    for (int c = 0; c < 3; ++c) {
      rates.translation[c][2] = 1.0f + float(said + 10 * uint32_t(c));
      rates.spin[c][0] = -2.0f * float(said);
      rates.scale[c][1] = 0.5f;
    }
    rates.root[11] = float(said);
    return rates;
  };
  InputLogWriter writer;
  InputLogScene about = recorded.about;
  about.velocities = true;
  ASSERT_EQ(writer.Begin(about, recorded.Grooms()), nullptr);
  for (uint32_t f = 0; f < 4; ++f) {
    const FrameInput input = recorded.Input(f);
    const std::vector<PoseRateBlock> rates = {rates_of(f, 0), rates_of(f, 1), rates_of(f, 2)};
    EXPECT_NE(writer.AddFrame(input, recorded.poses[f], 0), nullptr);
    EXPECT_NE(writer.AddFrame(input, recorded.poses[f], 0, std::span(rates).first(2)), nullptr);
    ASSERT_EQ(writer.AddFrame(input, recorded.poses[f], recorded.digests[f], rates), nullptr);
  }
  const std::vector<std::byte> bytes = writer.Finish();
  const InputLog log = ReadInputLog(bytes, "x").OrThrow();
  EXPECT_EQ(log.version, kInputLogVersion);
  EXPECT_TRUE(log.about.velocities);
  EXPECT_EQ(log.rates.size(), 3u + 2u);  // the third's again after a frame without
  PoseRateBlock found;
  for (uint32_t f = 0; f < 4; ++f)
    for (uint32_t c = 0; c < 3; ++c) {
      const PoseRateBlock expected = rates_of(f, c);
      log.FillPoseRates(f, c, &found);
      EXPECT_EQ(std::memcmp(&found, &expected, sizeof found), 0) << f << ", character " << c;
    }
  ExpectCutsRefused(bytes);

  const InputLog without = ReadInputLog(recorded.Write(), "x").OrThrow();
  without.FillPoseRates(0, 0, &found);
  EXPECT_EQ(found.given, 0u);
  ASSERT_EQ(writer.Begin(recorded.about, recorded.Grooms()), nullptr);
  const std::vector<PoseRateBlock> rates(3);
  EXPECT_NE(writer.AddFrame({}, recorded.poses[0], 0, rates), nullptr);
}

// Origins of the frame and of each character; with velocities and without.
TEST(InputLog, OriginsComeBack) {
  const RecordedFrames recorded = MakeRecordedFrames();
  for (const bool velocities : {false, true}) {
    InputLogWriter writer;
    InputLogScene about = recorded.about;
    about.origins = true;
    about.velocities = velocities;
    ASSERT_EQ(writer.Begin(about, recorded.Grooms()), nullptr);
    const std::vector<PoseRateBlock> rates(velocities ? 3 : 0);
    const auto origin_of = [](uint32_t frame, size_t i) { return 1.0e6 / 3.0 * double(i) + frame; };
    for (uint32_t f = 0; f < 4; ++f) {
      FrameInput input = recorded.Input(f);
      input.origin[1] = -7.125 * f;
      std::vector<double> origins(9);
      for (size_t i = 0; i < 9; ++i) origins[i] = origin_of(f, i);
      EXPECT_NE(writer.AddFrame(input, recorded.poses[f], 0, rates), nullptr);
      ASSERT_EQ(writer.AddFrame(input, recorded.poses[f], recorded.digests[f], rates, origins),
                nullptr);
    }
    const std::vector<std::byte> bytes = writer.Finish();
    const InputLog log = ReadInputLog(bytes, "x").OrThrow();
    EXPECT_EQ(log.version, kInputLogVersion);
    EXPECT_TRUE(log.about.origins);
    EXPECT_EQ(log.about.velocities, velocities);
    for (uint32_t f = 0; f < 4; ++f) {
      EXPECT_EQ(log.Input(f).origin[1], -7.125 * f);
      for (uint32_t c = 0; c < 3; ++c) {
        double origin[3];
        log.FillOrigin(f, c, origin);
        for (size_t k = 0; k < 3; ++k) EXPECT_EQ(origin[k], origin_of(f, 3 * c + k));
      }
      EXPECT_EQ(log.frames[f].digest, recorded.digests[f]);
    }
    ExpectCutsRefused(bytes);
  }
  InputLogWriter without;
  ASSERT_EQ(without.Begin(recorded.about, recorded.Grooms()), nullptr);
  const std::vector<double> origins(9);
  EXPECT_NE(without.AddFrame({}, recorded.poses[0], 0, {}, origins), nullptr);
}

// From before there were lights: the same recording, with the count of capsules behind each frame's
// count of spheres.
TEST(InputLog, VersionTwoIsStillRead) {
  std::vector<std::byte> bytes =
      ReadFileBytes("", test::SourceFolder() + "/tests/fuzz/corpus/input_log/version_1.peltinput")
          .OrThrow();
  const InputLog first = ReadInputLog(bytes, "x").OrThrow();
  // Behind the counts: one sphere, one weather, what pose it is; then the pose, or the digest.
  constexpr size_t kToPose = 16 + 4 + 8 + 1;
  ASSERT_EQ(first.poses.size(), 2u);
  for (const size_t end : {bytes.size() - 8, first.poses[1].byte, first.poses[0].byte})
    bytes.insert(bytes.begin() + ptrdiff_t(end - kToPose), 4, std::byte{0});
  input_log::PutNumberAt(bytes, 8, 2u);
  const InputLog log = ReadInputLog(Reseal(bytes), "x").OrThrow();
  EXPECT_EQ(log.version, 2u);
  ASSERT_EQ(log.FrameCount(), 3u);
  for (uint32_t f = 0; f < 3; ++f) {
    const FrameInput input = log.Input(f);
    EXPECT_EQ(input.sphere[0][3], 0.1f);
    EXPECT_EQ(input.capsule_count + input.lighting.light_count + input.lighting.sample_count, 0u);
    EXPECT_TRUE(input.skip.light);
    EXPECT_EQ(input.weather[0].dirt, 0.25f);
    EXPECT_EQ(log.frames[f].digest, first.frames[f].digest);
  }
}

// From before there were brushes: a lit walk, kept as it was written.
TEST(InputLog, VersionThreeIsStillRead) {
  const InputLog log =
      ReadInputLogFile(test::SourceFolder() + "/tests/fuzz/corpus/input_log/version_3.peltinput")
          .OrThrow();
  EXPECT_EQ(log.version, 3u);
  ASSERT_EQ(log.FrameCount(), 3u);
  for (uint32_t f = 0; f < 3; ++f) {
    const FrameInput input = log.Input(f);
    EXPECT_EQ(input.lighting.light[0].range, 5.0f);
    EXPECT_EQ(input.lighting.sample[0].falloff, 4.0f);
    EXPECT_EQ(input.brush_count, 0u);
    EXPECT_EQ(input.lod.fast_quality_px, 0.0f);
    EXPECT_EQ(input.weather[0].dirt, 0.25f);
  }
}

// A log of one frame, without what versions below 10, 9, 8 and 6 lack.
std::vector<std::byte> WriteAsVersion(uint32_t version) {
  const RecordedFrames recorded = MakeRecordedFrames();
  InputLogWriter writer;
  const std::span<const std::byte> groom = recorded.grooms[0];
  EXPECT_EQ(writer.Begin(recorded.about, {&groom, 1}), nullptr);
  FrameInput input;
  input.skip.light = false;
  input.lod.budget_us = 100;
  EXPECT_EQ(writer.AddFrame(input, std::span(recorded.poses[0]).first(1), 0), nullptr);
  std::vector<std::byte> bytes = writer.Finish();
  const InputLog now = ReadInputLog(bytes, "x").OrThrow();
  EXPECT_EQ(now.Input(0).lod.fast_quality_px, 0.5f);
  EXPECT_EQ(now.Input(0).lod.least_chains, 0.0f);
  // Before the pose: six counts, the weather's, and what pose it is. The last count is of force volumes.
  const auto end = bytes.begin() + ptrdiff_t(now.poses[0].byte - 1 - 7 * 4);
  bytes.erase(end + 5 * 4, end + 6 * 4);
  constexpr ptrdiff_t kKind = 4, kBudget = 4 + 4 + sizeof(FurCosts);
  const ptrdiff_t before = version < 6 ? 8 : version < 8 ? 4 : 0;
  bytes.erase(end - kKind - (version < 9 ? before + kBudget : 0), end);
  if (version < 6) bytes.resize(bytes.size() - 4);  // how many frames have velocities of colliders
  input_log::PutNumberAt(bytes, 8, version);
  return Reseal(bytes);
}

// From before there were kinds of wind, and force volumes.
TEST(InputLog, VersionNineIsStillRead) {
  const InputLog then = ReadInputLog(WriteAsVersion(9), "x").OrThrow();
  EXPECT_EQ(then.version, 9u);
  EXPECT_EQ(then.Input(0).lod.budget_us, 100u);
  EXPECT_EQ(then.Input(0).wind.kind + then.Input(0).force_count, 0u);
}

// From before there were budgets of time.
TEST(InputLog, VersionEightIsStillRead) {
  const InputLog then = ReadInputLog(WriteAsVersion(8), "x").OrThrow();
  EXPECT_EQ(then.version, 8u);
  EXPECT_EQ(then.Input(0).lod.budget_us, 0u);
  EXPECT_EQ(then.Input(0).lod.least_chains, 0.0f);
}

// From before chains thinned: all were simulated.
TEST(InputLog, VersionSevenIsStillRead) {
  const InputLog then = ReadInputLog(WriteAsVersion(7), "x").OrThrow();
  EXPECT_EQ(then.version, 7u);
  EXPECT_EQ(then.Input(0).lod.least_chains, 1.0f);
  EXPECT_EQ(then.Input(0).lod.fast_quality_px, 0.5f);
}

// From before the quality went by the size on the screen: it did not.
TEST(InputLog, VersionFiveIsStillRead) {
  const InputLog then = ReadInputLog(WriteAsVersion(5), "x").OrThrow();
  EXPECT_EQ(then.version, 5u);
  EXPECT_EQ(then.Input(0).lod.fast_quality_px, 0.0f);
  EXPECT_EQ(then.Input(0).lod.least_chains, 1.0f);
  EXPECT_FALSE(then.Input(0).skip.light);
  EXPECT_EQ(then.poses.size(), 1u);
}

TEST(InputLog, RecordingGoesOnAfterFinish) {
  const RecordedFrames recorded = MakeRecordedFrames();
  InputLogWriter writer;
  EXPECT_TRUE(writer.Finish().empty());
  EXPECT_EQ(writer.Begin(recorded.about, recorded.Grooms()), nullptr);
  EXPECT_EQ(ReadInputLog(writer.Finish(), "x").OrThrow().FrameCount(), 0u);
  for (uint32_t f = 0; f < 4; ++f) {
    EXPECT_EQ(writer.AddFrame(recorded.Input(f), recorded.poses[f], recorded.digests[f]), nullptr);
    EXPECT_EQ(ReadInputLog(writer.Finish(), "x").OrThrow().FrameCount(), f + 1);
  }
  EXPECT_EQ(writer.Finish(), recorded.Write());
}

TEST(InputLog, TheWriterRefusesWhatCouldNotBeRead) {
  RecordedFrames recorded = MakeRecordedFrames();
  InputLogWriter writer;
  EXPECT_NE(writer.AddFrame(recorded.inputs[0], recorded.poses[0], 0), nullptr);
  EXPECT_NE(writer.Begin(recorded.about, {}), nullptr);
  // A recording's texts are printed by whoever opens it.
  for (const std::string text : {"\x1b[2J", "two\nlines", "\xc2\x9b", "\xff"}) {
    EXPECT_NE(writer.Begin({text, "", false}, recorded.Grooms()), nullptr);
    EXPECT_NE(writer.Begin({"scene", text, false}, recorded.Grooms()), nullptr);
  }
  ASSERT_EQ(writer.Begin(recorded.about, recorded.Grooms()), nullptr);
  const std::vector<std::byte> before = writer.Finish();
  EXPECT_NE(writer.AddFrame(recorded.inputs[0], std::span(recorded.poses[0]).first(2), 0), nullptr);
  const auto expect_refused = [&](auto change) {
    FrameInput input = recorded.inputs[0];
    change(input);
    EXPECT_NE(writer.AddFrame(input, recorded.poses[0], 0), nullptr);
  };
  expect_refused([](FrameInput& in) { in.sphere_count = kSpheresPerScene + 1; });
  expect_refused([](FrameInput& in) { in.capsule_count = kCapsulesPerScene + 1; });
  expect_refused([](FrameInput& in) { in.lighting.light_count = kLightsPerScene + 1; });
  expect_refused([](FrameInput& in) { in.lighting.sample_count = kIrradianceSamplesPerScene + 1; });
  expect_refused([](FrameInput& in) { in.brush_count = kBrushesPerScene + 1; });
  expect_refused([](FrameInput& in) { in.force_count = kForceVolumesPerScene + 1; });
  const Weather weather[2];
  expect_refused([&](FrameInput& in) { in.weather = weather; });
  const std::vector<float> importance(kLayersPerScene + 1, 1.0f);
  expect_refused([&](FrameInput& in) { in.importance = importance; });
  recorded.poses[0][1].joint_count = kJointsPerCharacter + 1;
  EXPECT_NE(writer.AddFrame(recorded.inputs[0], recorded.poses[0], 0), nullptr);
  EXPECT_EQ(writer.Finish(), before);
}

}  // namespace
}  // namespace pelt
