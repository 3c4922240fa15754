// What is written reads back; everything else is refused with the number of its line.
#include "traces/digest_log.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/traces/recorded_frames.hpp"

namespace pelt {
namespace {

std::string ReadError(const std::string& text) { return ReadDigestLog(text, "x").error(); }

std::string Replaced(std::string text, const std::string& from, const std::string& to) {
  const size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(DigestLog, WhatIsWrittenReadsBack) {
  DigestLog log = MakeDigestLog();
  log.settings = "lod, strand budget 400";
  const DigestLog read = ReadDigestLog(WriteDigestLog(log), "x").OrThrow();
  EXPECT_EQ(read.scene, "tiny");
  EXPECT_EQ(read.settings, log.settings);
  EXPECT_EQ(read.chunk_strands, 128u);
  EXPECT_EQ(read.vertex_order, "sorted");
  EXPECT_EQ(read.columns, log.columns);
  EXPECT_EQ(read.digests, log.digests);
  EXPECT_EQ(read.FrameCount(), 4u);
  EXPECT_EQ(WriteDigestLog(read), WriteDigestLog(log));
}

TEST(DigestLog, OneLineAFrameAndStage) {
  const std::string text = WriteDigestLog(MakeDigestLog());
  EXPECT_NE(text.find("\n1 roots roots 4000000000000004\n"), std::string::npos) << text;
  EXPECT_TRUE(text.ends_with("\n3 whole_frame all b00000000000000b\nend 12\n")) << text;
  EXPECT_TRUE(text.starts_with("pelt digest log 1\nscene tiny\nsettings none\n")) << text;
}

TEST(DigestLog, ALogWithoutFramesIsOne) {
  DigestLog log = MakeDigestLog();
  log.columns.clear();
  log.digests.clear();
  EXPECT_EQ(ReadDigestLog(WriteDigestLog(log), "x").OrThrow().FrameCount(), 0u);
}

TEST(DigestLog, ControlCharactersCannotBreakALine) {
  DigestLog log = MakeDigestLog();
  log.scene = "a\nend 0\rb";
  EXPECT_EQ(ReadDigestLog(WriteDigestLog(log), "x").OrThrow().scene, "a\\x0aend 0\\x0db");
}

TEST(DigestLog, EveryTruncationIsAnError) {
  const std::string text = WriteDigestLog(MakeDigestLog());
  for (size_t size = 0; size < text.size(); ++size) {
    const std::string error = ReadError(text.substr(0, size));
    ASSERT_TRUE(error.starts_with("digest log 'x', line ")) << size << ": " << error;
  }
}

TEST(DigestLog, FaultsAreNamedByLine) {
  const std::string text = WriteDigestLog(MakeDigestLog());
  const struct {
    const char *from, *to, *expected;
  } faults[] = {
      {"pelt digest log 1", "pelt digest log 2", "line 1: version 2"},
      {"pelt digest log 1", "palt digest log 1", "line 1: not a digest log"},
      {"scene tiny", "seen tiny", "line 2: should be 'scene ...'"},
      {"scene tiny", "scene ti\tny", "line 2: scene holds a control character"},
      {"strands 128", "strands 128x", "line 4: chunk_strands is not a whole number"},
      {"strands 128", "strands 0128", "line 4"},
      {"sorted", "backwards", "line 5"},
      {"frames 4", "frames 5", "should be 'frame stage stream digest'"},
      {"frames 4", "frames 3", "should be 'end 9'"},
      {"frames 4", "frames 4294967296", "line 6"},
      {"columns frame", "columns", "line 7"},
      {"0 skin skinned 0", "0 skin skinned g", "line 8: the digest"},
      {"0 skin skinned 0", "0 skin skinned ", "line 8: the digest"},
      {"0 skin skinned 0", "0 skin skinned 00", "line 8: the digest"},
      {"0 skin skinned 0", "0 skin skinned A", "line 8: the digest"},
      {"0 skin skinned", "0 s+in skinned", "line 8: the stage"},
      {"0 skin skinned", "0  skinned", "line 8: the stage"},
      {"0 skin skinned", "-0 skin skinned", "line 8: the frame"},
      {"0 roots roots", "1 roots roots", "line 9: should be of frame 0"},
      {"1 roots roots", "1 root roots", "line 12: should be of stage roots, stream roots"},
      {"1 roots roots 4000000000000004\n", "", "line 12: should be of stage roots"},
      {"end 12\n", "end 13\n", "line 20: should be 'end 12'"},
      {"end 12\n", "end 12\nmore\n", "behind the 'end' line"},
  };
  for (const auto& fault : faults) {
    const std::string error = ReadError(Replaced(text, fault.from, fault.to));
    EXPECT_NE(error.find(fault.expected), std::string::npos)
        << fault.from << " -> " << fault.to << ": " << error;
  }
}

TEST(DigestLog, ThousandsOfColumnsAreRefused) {
  DigestLog log = MakeDigestLog();
  log.columns.assign(3000, {"a", "b"});
  log.columns.push_back({"whole_frame", "all"});
  log.digests.assign(3001, 1);
  EXPECT_NE(ReadError(WriteDigestLog(log)).find("more than 1024 lines"), std::string::npos);
}

TEST(DigestLog, RandomDamageNeverCrashes) {
  const std::string text = WriteDigestLog(MakeDigestLog());
  std::mt19937 random(1);
  for (int i = 0; i < 5000; ++i) {
    std::string damaged = text;
    for (int n = 0; n < 2; ++n) damaged[random() % damaged.size()] = char(random() & 255);
    const auto log = ReadDigestLog(damaged, "x");
    EXPECT_EQ(bool(log), log.error().empty());
  }
}

TEST(DigestLog, FilesAreReadAndWritten) {
  const std::string path = ::testing::TempDir() + "pelt_digest_log_test.digests";
  WriteDigestLogFile(MakeDigestLog(), path).OrThrow();
  EXPECT_EQ(ReadDigestLogFile(path).OrThrow().digests, MakeDigestLog().digests);
  std::remove(path.c_str());
  EXPECT_THROW(ReadDigestLogFile(path).OrThrow(), Error);
  EXPECT_THROW(WriteDigestLogFile(MakeDigestLog(), "/no/such/folder/x").OrThrow(), Error);
}

}  // namespace
}  // namespace pelt
