// Golden digests: what is kept is what is computed, and a change is found and reported.
#include <gtest/gtest.h>

#include <filesystem>

#include "bench/command/commands.hpp"
#include "tests/command/command_fixture.hpp"
#include "tests/source_folder.hpp"
#include "traces/digest_log.hpp"

namespace pelt {
namespace {

namespace fs = std::filesystem;

const std::string kKept = test::SourceFolder() + "/traces/golden";

class GoldenCommand : public test::CommandFixture {
 protected:
  void SetUp() override {
    if (kStrandsPerChunk != 128)
      GTEST_SKIP() << "golden digests are kept for 128 strands per chunk";
    for (const char* name : {"tiny.digests", "tiny.lod.digests"})
      fs::copy_file(fs::path(kKept) / name, Path(name));
  }
  int Check(const std::string& folder) { return Run({folder, {}, "tiny"}); }
  int Renew() { return Run({"", OutputPath::Of(folder_.path().string()), "tiny"}); }
  int Run(const GoldenArgs& args) {
    return Catch([&] { return CheckOrRenewGolden(args); });
  }

  // Changes the last digit of the digest of frame 3's roots.
  std::string SpoilOneLine() {
    std::string text = test::ReadText(Path("tiny.digests"));
    const size_t at = text.find("\n3 roots roots ") + 15;
    const std::string before = text.substr(at, 16);
    text[at + 15] = text[at + 15] == '0' ? '1' : '0';
    folder_.Save("tiny.digests", text);
    return text.substr(at, 16) + " -> " + before;
  }
};

TEST_F(GoldenCommand, KeptIsComputed) {
  EXPECT_EQ(Check(kKept), 0);
  EXPECT_TRUE(Said("tiny: same, 20 frames")) << out_;
  EXPECT_TRUE(Said("tiny.lod: same, 20 frames")) << out_;
}

TEST_F(GoldenCommand, AChangedLineFailsAtItsFrameAndStage) {
  SpoilOneLine();
  EXPECT_EQ(Check(folder_.path().string()), 1);
  EXPECT_TRUE(Said("frame 3, stage roots, stream roots")) << out_;
  EXPECT_TRUE(Said("tiny.lod: same")) << out_;
}

TEST_F(GoldenCommand, RenewTellsExactlyWhatChanged) {
  EXPECT_EQ(Renew(), 0);
  EXPECT_EQ(out_, "tiny: nothing changed\ntiny.lod: nothing changed\n");
  const std::string change = SpoilOneLine();
  EXPECT_EQ(Renew(), 0);
  EXPECT_EQ(out_, "tiny frame 3 stage roots stream roots: " + change +
                      "\ntiny: 1 lines changed\ntiny.lod: nothing changed\n");
  EXPECT_EQ(Check(folder_.path().string()), 0);
}

TEST_F(GoldenCommand, OtherSettingsLinesOrFramesFail) {
  DigestLog log = ReadDigestLogFile(Path("tiny.digests")).OrThrow();
  log.settings = "lod";
  WriteDigestLogFile(log, Path("tiny.digests")).OrThrow();
  EXPECT_EQ(Check(folder_.path().string()), 1);
  EXPECT_TRUE(Said("settings: 'lod' and ''")) << out_;

  log = ReadDigestLogFile(kKept + "/tiny.digests").OrThrow();
  log.columns[3].stage = "elsewhere";
  WriteDigestLogFile(log, Path("tiny.digests")).OrThrow();
  EXPECT_EQ(Check(folder_.path().string()), 1);
  EXPECT_TRUE(Said("the frames have other lines")) << out_;

  log = ReadDigestLogFile(kKept + "/tiny.digests").OrThrow();
  log.digests.resize(log.columns.size() * 19);
  WriteDigestLogFile(log, Path("tiny.digests")).OrThrow();
  EXPECT_EQ(Check(folder_.path().string()), 1);
  EXPECT_TRUE(Said("head frames: 19 and 20")) << out_;
}

TEST_F(GoldenCommand, AnotherCapacityIsSaidToBeSkipped) {
  for (const char* name : {"tiny.digests", "tiny.lod.digests"}) {
    DigestLog log = ReadDigestLogFile(Path(name)).OrThrow();
    log.chunk_strands = 64;
    WriteDigestLogFile(log, Path(name)).OrThrow();
  }
  EXPECT_EQ(Check(folder_.path().string()), 0);
  EXPECT_TRUE(Said("tiny: skipped, it is of 64 strands per chunk and this build has 128")) << out_;
}

TEST_F(GoldenCommand, AMissingLogIsAnError) {
  fs::remove(Path("tiny.digests"));
  EXPECT_EQ(Check(folder_.path().string()), -1);
  EXPECT_TRUE(Said("no such file"));
}

}  // namespace
}  // namespace pelt
