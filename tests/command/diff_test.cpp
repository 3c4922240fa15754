// `pelt diff` on files of each kind: exit codes, words, JSON; grooms are compared field by field.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "bench/command/commands.hpp"
#include "core/file_bytes.hpp"
#include "core/groom/groom_file.hpp"
#include "tests/command/command_fixture.hpp"
#include "tests/traces/recorded_frames.hpp"

namespace pelt {
namespace {

class DiffCommand : public test::CommandFixture {
 protected:
  std::string Write(const std::string& name, std::span<const std::byte> bytes) const {
    return folder_.Save(name, bytes);
  }
  int Run(const std::string& left, const std::string& right, bool json = false) {
    return Catch([&] { return Diff({left, right, json}); });
  }
};

DigestLog MakeLog() {
  DigestLog log;
  log.scene = "tiny";
  log.chunk_strands = 128;
  log.vertex_order = "sorted";
  log.columns = {{"skin", "skinned"}, {"whole_frame", "all"}};
  log.digests = {1, 2, 3, 4, 5, 6};
  return log;
}

TEST_F(DiffCommand, DigestLogs) {
  std::string text = WriteDigestLog(MakeLog());
  const std::string a = Write("a", AsBytes(text));
  EXPECT_EQ(Run(a, Write("b", AsBytes(text))), 0);
  EXPECT_TRUE(Said("same digest log"));
  text[text.find("1 skin skinned 0") + 20] = '7';
  const std::string c = Write("c", AsBytes(text));
  EXPECT_EQ(Run(a, c), 1);
  EXPECT_TRUE(
      Said("digest logs differ: frame 1, stage skin, stream skinned: 0000000000000003 and "))
      << out_;
  EXPECT_TRUE(Said("pelt verify"));
  EXPECT_EQ(Run(a, c, true), 1);
  const auto json = nlohmann::json::parse(out_);
  EXPECT_EQ(json["same"], false);
  EXPECT_EQ(json["place"]["frame"], "1");
  EXPECT_EQ(json["place"]["stage"], "skin");
  EXPECT_EQ(json["left"], "0000000000000003");
  DigestLog other = MakeLog();
  other.scene = "monster";
  EXPECT_EQ(Run(a, Write("d", AsBytes(WriteDigestLog(other)))), 1);
  EXPECT_TRUE(Said("'tiny' and 'monster'"));
  EXPECT_TRUE(Said("different scenes"));
}

TEST_F(DiffCommand, InputLogs) {
  RecordedFrames recorded = MakeRecordedFrames();
  const std::string a = Write("a", recorded.Write());
  EXPECT_EQ(Run(a, Write("b", recorded.Write())), 0);
  EXPECT_TRUE(Said("same input log"));
  recorded.inputs[1].time_s = 1.0;
  EXPECT_EQ(Run(a, Write("c", recorded.Write())), 1);
  EXPECT_TRUE(Said("input logs differ: frame 1, input time_s: 0x"));
  EXPECT_TRUE(Said("0x3ff0000000000000 (1)"));
}

TEST_F(DiffCommand, FilesOfDifferentKindsAreNamed) {
  const std::string log = Write("log", AsBytes(WriteDigestLog(MakeLog())));
  const std::string input = Write("input", MakeRecordedFrames().Write());
  EXPECT_EQ(Run(log, input), -1);
  EXPECT_TRUE(Said("of kind digest log")) << out_;
  EXPECT_TRUE(Said("of kind input log")) << out_;
  EXPECT_EQ(Run(log, Write("noise", AsBytes("what is this"))), -1);
  EXPECT_TRUE(Said("neither a digest log")) << out_;
  EXPECT_EQ(Run(log, "no/such/file"), -1);
  EXPECT_TRUE(Said("no such file"));
}

const Groom& TinyGroom() {
  static const Groom groom = LoadScenario("tiny").grooms[0];
  return groom;
}

std::string DescribeGrooms(const Groom& left, const Groom& right) {
  const auto found = FindDifference(left, right);
  return found ? DescribeDifference(*found) : "same";
}

TEST_F(DiffCommand, Grooms) {
  const std::string a = Write("a", WriteGroom(TinyGroom()).OrThrow());
  EXPECT_EQ(Run(a, Write("b", WriteGroom(TinyGroom()).OrThrow())), 0);
  EXPECT_TRUE(Said("same groom"));
  Groom other = TinyGroom();
  other.strands[2].width[7] *= 1.5f;
  EXPECT_EQ(Run(a, Write("c", WriteGroom(other).OrThrow())), 1);
  EXPECT_TRUE(Said("grooms differ: section strands, item 2, field width, lane 7: 0x")) << out_;
}

TEST(GroomDiff, NamesFieldAndLane) {
  EXPECT_EQ(DescribeGrooms(TinyGroom(), TinyGroom()), "same");
  Groom other = TinyGroom();
  other.strand_rest4[0].offset[2][1][37] = -0.0f;
  EXPECT_TRUE(DescribeGrooms(TinyGroom(), other)
                  .starts_with("section strand_rest4, item 0, field offset[2][1], lane 37: 0x"))
      << DescribeGrooms(TinyGroom(), other);
  other.mesh[3].row_joint[1] ^= 1;
  EXPECT_TRUE(DescribeGrooms(TinyGroom(), other)
                  .starts_with("section mesh, item 3, field row_joint, lane 1: 0x"));
  other.layers[1].params.iterations += 1;
  EXPECT_TRUE(DescribeGrooms(TinyGroom(), other)
                  .starts_with("section layers, item 1, field iterations: 0x"));
  other.joint_names[2] += "x";
  EXPECT_TRUE(
      DescribeGrooms(TinyGroom(), other).starts_with("section joint_names, item 2, field text: "));
  other.unit_scale = 2.0f;
  EXPECT_TRUE(DescribeGrooms(TinyGroom(), other)
                  .starts_with("section general, item 0, field unit_scale: 0x"));
  other.strands.pop_back();
  EXPECT_TRUE(DescribeGrooms(TinyGroom(), other).starts_with("section strands: "));
}

// The grooms inside two recordings differ: the field is named, not just the byte.
TEST_F(DiffCommand, GroomsInsideInputLogs) {
  Groom other = TinyGroom();
  other.strands[1].length[3] *= 0.5f;
  RecordedFrames recorded = MakeRecordedFrames();
  recorded.grooms.assign(3, WriteGroom(TinyGroom()).OrThrow());
  const std::string a = Write("a", recorded.Write());
  recorded.grooms[1] = WriteGroom(other).OrThrow();
  EXPECT_EQ(Run(a, Write("b", recorded.Write())), 1);
  EXPECT_TRUE(Said("character 1, section strands, item 1, field length, lane 3: 0x")) << out_;
}

}  // namespace
}  // namespace pelt
