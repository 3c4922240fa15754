// The first difference is found, named by its place, with both values.
#include "traces/diff.hpp"

#include <gtest/gtest.h>

#include "tests/traces/recorded_frames.hpp"

namespace pelt {
namespace {

std::string Describe(const auto& left, const auto& right) {
  const auto found = FindDifference(left, right);
  return found ? DescribeDifference(*found) : "same";
}

InputLog Read(const RecordedFrames& recorded) {
  return ReadInputLog(recorded.Write(), "x").OrThrow();
}

TEST(Diff, EqualLogsAreTheSame) {
  EXPECT_EQ(Describe(MakeDigestLog(), MakeDigestLog()), "same");
  EXPECT_EQ(Describe(Read(MakeRecordedFrames()), Read(MakeRecordedFrames())), "same");
}

TEST(Diff, OneChangedDigestIsFoundAtItsFrameAndStage) {
  for (size_t d = 0; d < 12; ++d) {
    DigestLog other = MakeDigestLog();
    other.digests[d] ^= 0x10;
    const auto found = FindDifference(MakeDigestLog(), other);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->place[0].second, std::to_string(d / 3));
    EXPECT_EQ(found->place[1].second, MakeDigestLog().columns[d % 3].stage);
    EXPECT_EQ(found->place[2].second, MakeDigestLog().columns[d % 3].stream);
  }
  DigestLog other = MakeDigestLog();
  other.digests[4] ^= 0x10;
  EXPECT_EQ(Describe(MakeDigestLog(), other),
            "frame 1, stage roots, stream roots: 4000000000000004 and 4000000000000014");
}

TEST(Diff, OfSeveralDifferencesTheFirstInTimeIsNamed) {
  DigestLog other = MakeDigestLog();
  for (const size_t d : {3u, 5u, 8u}) other.digests[d] ^= 1;
  EXPECT_TRUE(Describe(MakeDigestLog(), other).starts_with("frame 1, stage skin"));
}

TEST(Diff, ShorterLogsAreSameAsFarAsTheyGo) {
  DigestLog shorter = MakeDigestLog();
  shorter.digests.resize(6);
  const auto found = FindDifference(MakeDigestLog(), shorter);
  ASSERT_TRUE(found);
  EXPECT_EQ(DescribeDifference(*found), "head frames: 4 and 2");
  EXPECT_EQ(found->remark, "the first 2 are the same");
}

TEST(Diff, HeadsOfDigestLogsAreComparedFirst) {
  DigestLog other = MakeDigestLog();
  other.digests[0] = 5;
  other.vertex_order = "index-buffer";
  EXPECT_EQ(Describe(MakeDigestLog(), other), "head vertex_order: sorted and index-buffer");
  other.chunk_strands = 64;
  EXPECT_EQ(Describe(MakeDigestLog(), other), "head chunk_strands: 128 and 64");
  other.scene = "monster";
  EXPECT_EQ(Describe(MakeDigestLog(), other), "head scene: 'tiny' and 'monster'");
}

TEST(Diff, OtherSettingsAreNamedWithTheDifference) {
  DigestLog other = MakeDigestLog();
  other.settings = "lod";
  EXPECT_EQ(Describe(MakeDigestLog(), other), "same");
  other.digests[7] = 0;
  EXPECT_EQ(FindDifference(MakeDigestLog(), other)->remark, "settings differ: none and lod");
}

// One sorts a layer whole, the other in pieces: the stages have other names, the bits are the same.
TEST(Diff, LinesThatOnlyOneHasAreLeftOutAndTold) {
  DigestLog whole = MakeDigestLog(), pieces = MakeDigestLog();
  whole.columns[1] = {"sort_layer", "order"};
  pieces.columns[1] = {"sort_scatter3", "order"};
  EXPECT_EQ(Describe(whole, pieces), "same");
  pieces.digests[5] ^= 1;  // of the whole frame 1
  const auto found = FindDifference(whole, pieces);
  ASSERT_TRUE(found);
  EXPECT_TRUE(DescribeDifference(*found).starts_with("frame 1, stage whole_frame, stream all"));
  EXPECT_NE(found->remark.find("2 lines of a frame are in one log only"), std::string::npos);
}

// Small layers sort whole in both: the same stage, of other layers.
TEST(Diff, AStageThatStandsForOtherLayersIsLeftOut) {
  DigestLog whole = MakeDigestLog(), pieces = MakeDigestLog();
  whole.columns[0] = pieces.columns[0] = {"sort_layer", "order"};
  pieces.columns[1] = {"sort_scatter3", "order"};
  pieces.digests[0] ^= 1;
  EXPECT_EQ(Describe(whole, pieces), "same");
}

TEST(Diff, FieldsOfAFramesInputAreNamed) {
  const RecordedFrames base = MakeRecordedFrames();
  RecordedFrames other = base;
  other.inputs[2].wind.velocity[1] = 1.5f;
  EXPECT_EQ(Describe(Read(base), Read(other)),
            "frame 2, input wind.velocity[1]: 0x00000000 (0) and 0x3fc00000 (1.5)");
  other.inputs[1].dt_s = 0.5;
  EXPECT_EQ(Describe(Read(base), Read(other)),
            "frame 1, input dt_s: 0x3f91111111111111 (0.016666666666666666) and "
            "0x3fe0000000000000 (0.5)");
  other.inputs[0].skip.cull = false;
  EXPECT_EQ(Describe(Read(base), Read(other)), "frame 0, input skip.cull: 0x01 (1) and 0x00 (0)");
}

TEST(Diff, MinusZeroIsNotZero) {
  const RecordedFrames base = MakeRecordedFrames();
  RecordedFrames other = base;
  other.inputs[0].gravity[0] = -0.0f;
  EXPECT_EQ(Describe(Read(base), Read(other)),
            "frame 0, input gravity[0]: 0x00000000 (0) and 0x80000000 (-0)");
}

TEST(Diff, SpheresAndWeatherAreNamed) {
  const RecordedFrames base = MakeRecordedFrames();
  RecordedFrames other = base;
  other.weather[1][2].wetness = 1.0f;
  EXPECT_EQ(Describe(Read(base), Read(other)),
            "frame 1, input weather[2].wetness: 0x3f000000 (0.5) and 0x3f800000 (1)");
  other.inputs[1].sphere[0][3] = 2.0f;
  EXPECT_EQ(Describe(Read(base), Read(other)),
            "frame 1, input sphere[0][3]: 0x3f000000 (0.5) and 0x40000000 (2)");
  other.inputs[1].sphere_count = 2;
  EXPECT_EQ(Describe(Read(base), Read(other)),
            "frame 1, input sphere_count: 0x00000001 (1) and 0x00000002 (2)");
}

TEST(Diff, ListsOfLayersAndStrandsAreNamed) {
  RecordedFrames base = MakeRecordedFrames();
  const std::vector<float> ones = {1.0f, 1.0f}, off = {1.0f, 0.0f};
  const std::vector<StrandWrite> thin = {{0, 3, 0, 0, 0.5f, 0}}, wide = {{0, 3, 0, 0, 2.0f, 0}};
  base.inputs[2].importance = ones;
  base.inputs[2].strands = thin;
  RecordedFrames other = base;
  other.inputs[2].strands = wide;
  EXPECT_EQ(Describe(Read(base), Read(other)),
            "frame 2, input strands[0].width: 0x3f000000 (0.5) and 0x40000000 (2)");
  other.inputs[2].importance = off;
  EXPECT_EQ(Describe(Read(base), Read(other)),
            "frame 2, input importance[1]: 0x3f800000 (1) and 0x00000000 (0)");
  other.inputs[2].importance = {};
  EXPECT_EQ(Describe(Read(base), Read(other)),
            "frame 2, input importance.count: 0x00000002 (2) and 0x00000000 (0)");
}

TEST(Diff, RowsAndJointsOfAPoseAreNamed) {
  const RecordedFrames base = MakeRecordedFrames();
  RecordedFrames other = base;
  other.poses[3][1].rotation_key[2][3][16] = 1.0f;
  const auto found = FindDifference(Read(base), Read(other));
  ASSERT_TRUE(found);
  EXPECT_TRUE(DescribeDifference(*found).starts_with(
      "frame 3, character 1, pose rotation_key, row 11, joint 16: "))
      << DescribeDifference(*found);
  EXPECT_NE(found->right.find("0x3f800000 (1)"), std::string::npos);
  other.poses[2][0].teleported = 7;
  EXPECT_EQ(Describe(Read(base), Read(other)),
            "frame 2, character 0, pose teleported, element 0: 0x00000000 (0) and 0x00000007 (7)");
  other.poses[1][2].joint_count = 255;
  EXPECT_EQ(Describe(Read(base), Read(other)),
            "frame 1, character 2, pose joint_count: 0x00000100 (256) and 0x000000ff (255)");
}

TEST(Diff, JointsNotInUseDoNotCount) {
  const RecordedFrames base = MakeRecordedFrames();
  RecordedFrames other = base;
  other.poses[0][0].scale_key[0][0][3] = 42.0f;  // of 3 joints
  EXPECT_EQ(Describe(Read(base), Read(other)), "same");
}

TEST(Diff, SameInputAndAnotherDigestSaysSo) {
  const RecordedFrames base = MakeRecordedFrames();
  RecordedFrames other = base;
  other.digests[2] = 1;
  const auto found = FindDifference(Read(base), Read(other));
  ASSERT_TRUE(found);
  EXPECT_EQ(DescribeDifference(*found),
            "frame 2, recorded digest: 1122334455667702 and 0000000000000001");
  EXPECT_NE(found->remark.find("all input up to here is the same"), std::string::npos);
}

TEST(Diff, ScenesOfInputLogsAreComparedFirst) {
  const RecordedFrames base = MakeRecordedFrames();
  RecordedFrames other = base;
  other.digests[0] = 1;
  other.grooms[1][9] = std::byte{7};
  EXPECT_EQ(Describe(Read(base), Read(other)), "character 1, groom byte 9: 0xd0 and 0x07");
  other.grooms[1].resize(9);
  EXPECT_EQ(Describe(Read(base), Read(other)), "character 1, groom byte 9: 0xd0 and the end");
  other.about.index_buffer = true;
  EXPECT_EQ(Describe(Read(base), Read(other)), "head vertex_order: sorted and index-buffer");
  other = base;
  other.grooms.pop_back();
  for (auto& poses : other.poses) poses.pop_back();
  for (auto& weather : other.weather)
    if (!weather.empty()) weather.pop_back();
  EXPECT_EQ(Describe(Read(base), Read(other)), "head characters: 3 and 2");
}

}  // namespace
}  // namespace pelt
